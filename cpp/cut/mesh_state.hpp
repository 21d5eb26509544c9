#pragma once
// What a mesh was when cracks were located in it.

#include <comp.hpp>

namespace ngsxfem_contact
{
  struct MeshState
  {
    size_t num_elements, num_vertices;
    int curve_order;
    /// Throws for a mesh with a deformation.
    explicit MeshState (ngcomp::MeshAccess & mesh);
    /// Throws if the mesh was changed since.
    void Check (ngcomp::MeshAccess & mesh) const;
  };
}
