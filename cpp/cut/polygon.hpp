#pragma once
// Triangles and convex polygons in the plane.

#include "curve/curve_piece.hpp"

namespace ngsxfem_contact
{
  using Triangle = std::array<Point,3>;
  using Polygon = std::vector<Point>;

  double Area (const Triangle & t);
  double LongestEdge (const Triangle & t);
  Point Centre (const Polygon & polygon);
  /// A convex polygon as triangles.
  std::vector<Triangle> Fan (const Polygon & polygon);

  struct Line
  {
    Point origin, normal;                    // of unit length
    double Distance (Point p) const { return Dot(Point(p-origin), normal); }
    /// 0 on the line, which is as thick as twice the tolerance.
    double Snapped (Point p, double tolerance) const
    {
      double d = Distance(p);
      return std::abs(d) <= tolerance ? 0 : d;
    }
  };

  /// The two parts of a convex polygon on the positive and the negative side of a line, given the signed distances d of
  /// its corners; empty where there is none.
  std::array<Polygon,2> Split (const Polygon & polygon, const std::vector<double> & d);

  /// The corners of the convex hull of points, around it.
  Polygon HullOf (std::vector<Point> points);
  /// The shortest way from one convex polygon to another.
  std::array<Point,2> ShortestWay (const Polygon & a, const Polygon & b);
}
