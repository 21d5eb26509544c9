#pragma once
// ∂Ω: the edges of a mesh that belong to one element only, straight or curved.
// Where a mesh is a part of another one, those of them on which a boundary element lies: the part ends at the others.

#include "cut/element_map.hpp"

namespace ngsxfem_contact
{
  class BodyBoundary
  {
    struct Edge
    {
      ElementMap map;
      Point a, b;                        // of the straight triangle; the body lies to the left
      std::vector<Point> outline;        // of the curve between them
      double h;                          // longest edge of the element
      Point Value (double along) const { return map.Value(Lerp(a, b, along)); }
      Point Derivative (double along) const;
      /// The size of the element across the edge: its longest edge, or less where it is flat.
      double SizeAcross () const { return std::min(h, 4*Area(map.Corners())/Norm(Point(b-a))); }
    };
    std::vector<Edge> edges;
    double smallest;                     // h of all elements

  public:
    BodyBoundary (const MeshAccess & mesh, bool is_part);

    /// Below this distance a point lies on ∂Ω.
    double Tolerance () const { return geometric_tolerance*smallest; }
    double SmallestElement () const { return smallest; }

    /// The nearest point of ∂Ω, the edge that it lies on, and the size of the element there.
    struct Place { double distance; Point point; size_t edge; double along, h; };
    Place Nearest (Point p) const;
    bool Contains (Point p) const;

    /// Where a crack meets ∂Ω.
    struct Meeting { size_t piece; double t; size_t edge; };
    std::vector<Meeting> Meetings (const Crack & crack) const;
    /// By Newton's method, from a guess of the parameter of the piece and of the place on the edge; nothing where it does not converge.
    std::optional<double> Meet (const CurvePiece & piece, double t, size_t edge, double along) const;
    /// Where the ray p + τ d, d a unit vector, meets ∂Ω first, for τ between two bounds: the edge and the place on it.
    struct Hit { double tau; size_t edge; double along; };
    std::optional<Hit> Shoot (Point p, Point d, double from, double to) const;
  };
}
