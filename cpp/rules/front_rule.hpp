#pragma once
// Rules around fronts: slices where a front is in an element, or touches it, and Gauss in ever smaller parts beside it.

#include "rules/slice_rule.hpp"

namespace ngsxfem_contact
{
  using Triangle3 = std::array<Point3,3>;

  /// Points, elements and rules are in flat coordinates, those of one curved sheet, or in space, for fronts of planar sheets (Sheet::Flat).
  class FrontRule
  {
    std::vector<const Front*> fronts;
    FrontDemand demand;

  public:
    FrontRule (std::vector<const Front*> afronts, const FrontDemand & ademand) : fronts(std::move(afronts)), demand(ademand) { }

    /// The nearest front.
    const Front & Nearest (Point3 x) const;
    /// Whether a front is in a tetrahedron, or nearly touches it.
    bool IsClose (const Tet & t, const Front & front) const;

    /// sides: whether the tetrahedron is divided by the plane of the front first, where it keeps from it.
    void AppendTet (const Tet & t, PointRule3 & rule, bool divide) const { AppendTet(t, divide, 8, rule); }
    /// The part of a convex polygon in the plane of a sheet that lies on it; all fronts are those of this sheet.
    void AppendPolygon (const Polygon & polygon, const Sheet & sheet, PointRule & rule) const { AppendPolygon(polygon, sheet, 8, rule); }
    /// Of a triangle on ∂Ω.
    void AppendBoundary (const Triangle3 & t, PointRule3 & rule, int depth = 6) const;

  private:
    double SampledDistance (const std::vector<Point3> & points) const;
    void AppendTet (const Tet & t, bool divide, int depth, PointRule3 & rule) const;
    void AppendNear (const Tet & t, const Front & front, int depth, PointRule3 & rule) const;
    void AppendBeside (const Tet & t, int depth, PointRule3 & rule) const;
    bool IsClose (const Polygon & polygon, const Front & front) const;
    void AppendPolygon (const Polygon & polygon, const Sheet & sheet, int depth, PointRule & rule) const;
    void AppendNear (const Polygon & polygon, const Sheet & sheet, const Front & front, int depth, PointRule & rule) const;
    void AppendBeside (const Triangle & t, int depth, PointRule & rule) const;
  };

  /// Gauss of an order.
  void AppendTet (const Tet & t, int order, PointRule3 & rule);
  void AppendTriangle (const Triangle3 & t, int order, PointRule3 & rule);
}
