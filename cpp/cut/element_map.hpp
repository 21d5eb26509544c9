#pragma once
// The map of a curved element from the straight triangle of its corners.

#include "cut/element_division.hpp"
#include <comp.hpp>
#include <optional>

namespace ngsxfem_contact
{
  using ngcomp::MeshAccess;

  Triangle VerticesOf (const MeshAccess & mesh, size_t element);

  /// x = Φ(p), p in the straight triangle of the corners; the identity for a straight element. Edges that are straight stay where they are.
  class ElementMap
  {
    const MeshAccess & mesh;
    size_t element;
    Triangle t;
    bool curved;

  public:
    ElementMap (const MeshAccess & amesh, size_t aelement);
    bool IsCurved () const { return curved; }
    const Triangle & Corners () const { return t; }
    /// In NGSolve's reference triangle, (1, 0), (0, 1), (0, 0): the coordinates of a point p of the straight triangle.
    Point Reference (Point p) const;
    Point Value (Point p) const { return At(p).value; }
    /// How far edges are from those of the straight triangle, about.
    double Bulge () const;
    struct Image { Point value, d0, d1; };                 // with the derivatives by the coordinates of p
    Image At (Point p) const;
    /// The p of a point x in the element or beside it, by Newton's method; nothing where that does not converge.
    std::optional<Point> Inverse (Point x) const;
  };
}
