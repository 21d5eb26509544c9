#pragma once
// The parts into which a crack divides an element.

#include "curve/crack.hpp"
#include <optional>

namespace ngsxfem_contact
{
  using Triangle = std::array<Point,3>;
  using Polygon = std::vector<Point>;

  double Area (const Triangle & t);
  double LongestEdge (const Triangle & t);
  Point Centre (const Polygon & polygon);
  /// A convex polygon as triangles.
  std::vector<Triangle> Fan (const Polygon & polygon);

  /// The two parts of a convex polygon on the positive and the negative side of a line, given the signed distances d of
  /// its corners; empty where there is none.
  std::array<Polygon,2> Split (const Polygon & polygon, const std::vector<double> & d);

  /// A part of T∩Γ_C on one piece of the crack, from arc length s0 to s1.
  struct Chord { size_t piece; double s0, s1; };

  /// A triangle inside T that lies on one side of Γ_C (and of its straight extension beyond a tip). With a curved side it
  /// is the cone over this part of Γ_C, seen from corner 0; the curve ends in corners 1 and 2.
  struct Part { Triangle triangle; Side side; std::optional<Chord> curved; };

  /// Exact areas. On a curved piece ½∫|(x-A)×dx| along the curve.
  double Area (const Part & part, const Crack & crack);

  /// Divides a convex polygon along the parts of a crack in it, given in the order of arc length. Straight parts divide
  /// along their lines, curved ones along the curve. Throws where the crack turns too much inside.
  std::vector<Part> Divide (const Polygon & polygon, const std::vector<Chord> & chords, const Crack & crack, double tolerance);
}
