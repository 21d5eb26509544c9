#pragma once
// Points and weights in slices along a front: the cuts of a convex body with the planes normal to the front, in polar coordinates around it.
// All weights are positive, all points inside.

#include "cut/front.hpp"
#include "cut/polygon.hpp"
#include "rules/cut_rule.hpp"

namespace ngsxfem_contact
{
  struct WeightedPoint3 { Point3 p; double weight; };
  using PointRule3 = std::vector<WeightedPoint3>;

  /// What functions that are singular at the fronts ask of rules: as x ↦ √r times smooth functions of (√r, θ, s), their gradients squared.
  struct FrontDemand
  {
    double radius = 0;             // elements that come nearer to a front get rules of their own, beside those at vertices of elements that a front is in
    int along = 3, angular = 4, radial = 4;           // Gauss points in s, in the angle, in √r, for each interval on which the slices are smooth
    int order = 5;                 // of Gauss beside the front, in parts of an element
    double beta = 0.35;            // that keep this multiple of their size from the front
    auto operator<=> (const FrontDemand &) const = default;
  };

  /// One smooth piece of a front, which goes on straight beyond its ends; s = 0 where it starts.
  class FrontPiece
  {
    const Front & front;
    const CurvePiece & piece;

  public:
    FrontPiece (const Front & afront, size_t i) : front(afront), piece(afront.Curve().Piece(i)) { }
    struct Place { Point point, tangent; double curvature; };              // > 0: turns left
    Place At (double s) const;
    /// Where the nearest point lies.
    double Foot (Point p) const;
    bool IsStraight () const { return piece.IsStraight(); }
    double Length () const { return piece.Length(); }
    double LargestCurvature (double s0, double s1) const;
    /// Where it meets the sides of a polygon.
    std::vector<double> Meetings (const Polygon & polygon) const;
    const Plane & GetPlane () const { return front.GetPlane(); }
  };

  /// The rule for a tetrahedron, in slices normal to a piece. heights: of its corners over the plane of the sheet.
  void AppendSlices (const Tet & t, const std::array<double,4> & heights, const FrontPiece & piece, const FrontDemand & demand, PointRule3 & rule);

  /// The rule for the part of a convex polygon of the plane that lies behind a piece, on S; weights for areas.
  void AppendPlaneSlices (const Polygon & polygon, const FrontPiece & piece, const FrontDemand & demand, PointRule & rule);
}
