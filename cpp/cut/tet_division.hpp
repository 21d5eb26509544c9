#pragma once
// A tetrahedron divided by a plane: the tetrahedra on both sides, and the polygon between them.

#include "curve/space.hpp"
#include <vector>

namespace ngsxfem_contact
{
  /// A corner of the polygon in which a plane cuts a tetrahedron: the corner i = j of the tetrahedron on the plane, or a point between i < j.
  struct CutCorner { int i, j; Point3 point; };

  /// Around the polygon; empty unless there are corners on both sides. d: distances of the corners of t from the plane, 0 if they count as on it.
  /// Between two corners the point depends on their order, so give corners in the order of the mesh's vertices: then neighbours agree to the last bit.
  std::vector<CutCorner> CutPolygon (const Tet & t, const std::array<double,4> & d);

  /// On the positive and the negative side: volumes add up to that of t to round-off.
  std::array<std::vector<Tet>,2> Split (const Tet & t, const std::array<double,4> & d);

  /// Into eight, by the middles of the edges.
  std::array<Tet,8> Refined (const Tet & t);
}
