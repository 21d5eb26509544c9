#pragma once
// Points and tetrahedra in space.

#include "curve/curve_piece.hpp"

namespace ngsxfem_contact
{
  using Point3 = Vec<3>;
  /// As NGSolve's reference element has them: λ_i belongs to the i-th corner.
  using Tet = std::array<Point3,4>;

  inline double Dot (Point3 a, Point3 b) { return a(0)*b(0) + a(1)*b(1) + a(2)*b(2); }
  inline Point3 Cross (Point3 a, Point3 b) { return Point3(a(1)*b(2)-a(2)*b(1), a(2)*b(0)-a(0)*b(2), a(0)*b(1)-a(1)*b(0)); }
  inline double Norm (Point3 a) { return sqrt(Dot(a, a)); }
  inline Point3 Lerp (Point3 a, Point3 b, double t) { return Point3(a + t*(b-a)); }
  std::string ToString (Point3 p);

  inline double Volume (const Tet & t) { return std::abs(Dot(Point3(t[1]-t[0]), Cross(Point3(t[2]-t[0]), Point3(t[3]-t[0]))))/6; }
  inline Point3 Centre (const Tet & t) { return Point3(0.25*(t[0]+t[1]+t[2]+t[3])); }

  constexpr int tet_edges[6][2] { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };
  double LongestEdge (const Tet & t);
  /// Whether a tetrahedron is one of the same orientation as another one in other coordinates, with edges of half to twice the length.
  bool IsFaithful (const Tet & t, const Tet & other);
}
