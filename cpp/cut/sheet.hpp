#pragma once
// S: a planar crack in space, the part of a plane that closed curves bound.

#include "curve/crack.hpp"
#include "curve/space.hpp"

namespace ngsxfem_contact
{
  /// A plane with coordinates: x = origin + p₁ a₁ + p₂ a₂ + x₂ n, n = a₁ × a₂ from the minus to the plus side.
  struct Plane
  {
    Point3 origin;
    std::array<Point3,2> axes;               // of unit length, perpendicular
    Point3 normal;

    Point Project (Point3 x) const { Point3 d = x-origin; return Point(Dot(d, axes[0]), Dot(d, axes[1])); }
    double Height (Point3 x) const { return Dot(Point3(x-origin), normal); }
    Point3 Value (Point p, double height = 0) const { return Point3(origin + p(0)*axes[0] + p(1)*axes[1] + height*normal); }
    Point3 Direction (Point d) const { return Point3(d(0)*axes[0] + d(1)*axes[1]); }
  };

  class Sheet
  {
    Plane plane;
    std::vector<Crack> loops;                // the outer one first, then those of the holes
    double size;                             // the largest distance of a point of the outer curve from its first one

  public:
    /// axes: directions of the plane's coordinates, made perpendicular and of unit length. loops: closed curves in these coordinates, the outer one
    /// first, in any direction of travel: they are turned so that S lies to the right.
    /// Throws for axes that are parallel, for curves that are not closed, that meet each other, and for holes that are not inside.
    Sheet (Point3 origin, std::array<Point3,2> axes, std::vector<Crack> aloops);

    const Plane & GetPlane () const { return plane; }
    const std::vector<Crack> & Loops () const { return loops; }
    double Size () const { return size; }
    /// Whether a point of the plane lies in S.
    bool Contains (Point p) const { return loops[NearestLoop(p)].SideOf(p) == Side::Minus; }
    size_t NearestLoop (Point p) const;
    double Area () const;
    /// The corners of a box of its points in space.
    std::array<Point3,2> Bounds () const;
  };
}
