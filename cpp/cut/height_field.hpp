#pragma once
// A smooth surface as heights over a plane: what triangulated surfaces become (docs/method.md, section 21).

#include "cut/surface.hpp"

namespace ngsxfem_contact
{
  /// f(u, v) = Σ c_ij B(u/h₁ - i) B(v/h₂ - j) of cubic B-splines on a regular grid; it goes on linearly beyond the grid.
  struct HeightField
  {
    Point lower, spacing;                    // the first inner knot, and the distances of knots
    std::array<size_t,2> size;               // numbers of coefficients, 3 more than intervals
    std::vector<double> coefficients;        // of the same i one after the other

    /// Throws for numbers that do not fit together, or are not finite.
    void Check () const;
    /// f, ∂_u f, ∂_v f.
    std::array<double,3> At (Point p) const;
  };

  /// X(p) = p₁ a₁ + p₂ a₂ + f(p) a₃ over a plane with normal a₃, which is the direction of heights, too: |height| is the distance along a₃.
  class GraphSurface final : public Surface
  {
    Plane plane;
    HeightField field;

  public:
    GraphSurface (Point3 origin, std::array<Point3,2> axes, HeightField afield);
    const HeightField & Field () const { return field; }
    const Plane & GetPlane () const override { return plane; }
    Point3 Flat (Point3 x) const override;
    Place At (Point p) const override;
    std::array<Point3,2> Bounds (Point lo, Point hi) const override;
  };
}
