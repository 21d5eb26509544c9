#pragma once
// A convex polygon that one curve crosses once, from boundary to boundary.

#include "cut/part_triangle.hpp"
#include <memory>

namespace ngsxfem_contact
{
  class Crossing
  {
  public:
    /// A part of the curve between two points; straight without a curved side.
    struct Stretch { Point a, b; std::optional<PartTriangle::CurvedSide> curved; };

    /// The polygon counter-clockwise, the stretches in the direction of travel.
    Crossing (const Polygon & apolygon, std::vector<Stretch> astretches, double atolerance);

    /// Whether it starts and ends on the boundary of the polygon.
    bool IsWhole () const;
    /// The triangles of the plus and of the minus side; nothing if one of them has no point that sees the whole curve.
    std::optional<std::array<std::vector<PartTriangle>,2>> Triangles () const;
    /// The curve as a crack of its own, for the side of a point.
    std::shared_ptr<const Crack> Curve () const;

  private:
    const Polygon & polygon;
    double tolerance, size;
    std::vector<Stretch> stretches;
    struct Place { size_t edge; double along; };

    Point Corner (size_t i) const { return polygon[i % polygon.size()]; }
    Place PlaceOf (Point p) const;
    Polygon Loop (Point from, Point to) const;
    double Visibility (Point A, int sign) const;
    std::optional<Point> Apex (const Polygon & loop, int sign) const;
    double DistanceTo (Point p) const;
    double Thickness (const Polygon & loop) const;
    bool AppendSide (const Polygon & loop, int sign, std::vector<PartTriangle> & side) const;
  };
}
