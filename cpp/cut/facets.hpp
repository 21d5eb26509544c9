#pragma once
// Sizes, facets and nodes of a mesh's elements, by the same names in the plane and in space.

#include "cut/element_map.hpp"
#include "curve/space.hpp"

namespace ngsxfem_contact
{
  template <int D>
  struct MeshParts;

  template <>
  struct MeshParts<2>
  {
    static constexpr std::array<ngcomp::NODE_TYPE,1> between { ngcomp::NT_EDGE };        // nodes that are neither vertices nor elements
    /// The area of the straight triangle.
    static double ElementSize (const MeshAccess & mesh, size_t element) { return Area(VerticesOf(mesh, element)); }
    static double BoundarySize (const MeshAccess & mesh, size_t bnd_element) { return EdgeMap(mesh, bnd_element).Length(); }
    static size_t FacetOf (const MeshAccess & mesh, size_t bnd_element) { return mesh.GetElement(ngcomp::ElementId(ngfem::BND, bnd_element)).Edges()[0]; }
  };

  template <>
  struct MeshParts<3>
  {
    static constexpr std::array<ngcomp::NODE_TYPE,2> between { ngcomp::NT_EDGE, ngcomp::NT_FACE };
    static Tet TetOf (const MeshAccess & mesh, size_t element)
    {
      auto v = mesh.GetElement(ngcomp::ElementId(ngfem::VOL, element)).Vertices();
      return { mesh.GetPoint<3>(v[0]), mesh.GetPoint<3>(v[1]), mesh.GetPoint<3>(v[2]), mesh.GetPoint<3>(v[3]) };
    }
    static std::array<Point3,3> TriangleOf (const MeshAccess & mesh, size_t bnd_element)
    {
      auto v = mesh.GetElement(ngcomp::ElementId(ngfem::BND, bnd_element)).Vertices();
      return { mesh.GetPoint<3>(v[0]), mesh.GetPoint<3>(v[1]), mesh.GetPoint<3>(v[2]) };
    }
    /// The volume.
    static double ElementSize (const MeshAccess & mesh, size_t element) { return Volume(TetOf(mesh, element)); }
    static double BoundarySize (const MeshAccess & mesh, size_t bnd_element)
    {
      auto t = TriangleOf(mesh, bnd_element);
      return 0.5*Norm(Cross(Point3(t[1]-t[0]), Point3(t[2]-t[0])));
    }
    static size_t FacetOf (const MeshAccess & mesh, size_t bnd_element) { return mesh.GetElement(ngcomp::ElementId(ngfem::BND, bnd_element)).Faces()[0]; }
  };
}
