#pragma once
// The flat coordinates of a curved sheet in one element: affine, from those of its corners (docs/method.md, section 21).

#include "curve/space.hpp"

namespace ngsxfem_contact
{
  /// The hats of the corners of a simplex as functions of x, hat(0) + hat(1..3)·x; of a triangle constant along its normal.
  template <size_t N>
  std::array<Vec<4>,N> Hats (const std::array<Point3,N> & corners)
  {
    std::array<Vec<4>,N> hats;
    for (size_t i = 0; i < N; i++)
      {
        Point3 a = corners[(i+1) % N], u = corners[(i+2) % N]-a, normal = N == 4 ? Cross(u, Point3(corners[(i+3) % N]-a)) : Cross(u, Cross(u, Point3(corners[i]-a)));
        Point3 gradient = 1/Dot(Point3(corners[i]-a), normal) * normal;
        hats[i] = Vec<4>(-Dot(gradient, a), gradient(0), gradient(1), gradient(2));
      }
    return hats;
  }

  /// x ↦ flat coordinates: y_k = rows[k](0) + rows[k](1..3)·x.
  struct FlatMap
  {
    std::array<Vec<4>,3> rows;

    /// With values at the corners of a tetrahedron, or of a triangle.
    template <size_t N>
    FlatMap (const std::array<Point3,N> & corners, const std::array<Point3,N> & flat)
    {
      auto hats = Hats(corners);
      for (int k = 0; k < 3; k++)
        {
          rows[k] = 0.;
          for (size_t i = 0; i < N; i++) rows[k] += flat[i](k) * hats[i];
        }
    }

    Point3 Value (Point3 x) const
    {
      Point3 y;
      for (int k = 0; k < 3; k++) y(k) = rows[k](0) + Dot(Gradient(k), x);
      return y;
    }
    Point3 Gradient (int k) const { return Point3(rows[k](1), rows[k](2), rows[k](3)); }
    /// ∇(y·d).
    Point3 Gradient (Point3 d) const { return Point3(d(0)*Gradient(0) + d(1)*Gradient(1) + d(2)*Gradient(2)); }
  };
}
