#include "cut/disk.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  double Distance (Point p, const Triangle & t)
  {
    auto side = [&] (int i) { return Cross(Point(t[(i+1)%3]-t[i]), Point(p-t[i])); };
    if ((side(0) >= 0) == (side(1) >= 0) && (side(1) >= 0) == (side(2) >= 0)) return 0;
    return std::min({ Distance(p, t[0], t[1]), Distance(p, t[1], t[2]), Distance(p, t[2], t[0]) });
  }

  bool Disk :: Meets (const Triangle & t) const
  {
    double nearest = std::min({ Norm(Point(t[0]-centre)), Norm(Point(t[1]-centre)), Norm(Point(t[2]-centre)) });
    if (nearest < radius) return true;
    return nearest < radius + LongestEdge(t) && Distance(centre, t) < radius;
  }

  bool Disk :: Meets (const MeshAccess & mesh, ngfem::ElementId element) const
  {
    if (element.VB() == ngfem::VOL) return Meets(VerticesOf(mesh, element.Nr()));
    return Meets(EdgeMap(mesh, element.Nr())) && IsInterface(mesh, element.Nr());
  }
}
