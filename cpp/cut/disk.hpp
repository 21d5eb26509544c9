#pragma once
// The disks around tips, open sets, and what they meet.

#include "cut/element_map.hpp"

namespace ngsxfem_contact
{
  /// 0 inside.
  double Distance (Point p, const Triangle & t);

  struct Disk
  {
    Point centre;
    double radius;

    bool Meets (const Triangle & t) const;
    /// By more than round-off: ∂Ω is outside of all disks, but may touch them.
    bool Meets (const EdgeMap & edge) const { return edge.DistanceTo(centre) < (1-1e-9)*radius; }
    /// A triangle (VOL), or a boundary element (BND), which a disk meets only where it is an inner interface.
    bool Meets (const MeshAccess & mesh, ngfem::ElementId element) const;
  };
}
