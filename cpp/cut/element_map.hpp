#pragma once
// The coordinates of points in an element: physical, those of the straight triangle of its corners, and those of NGSolve's reference element.

#include "cut/element_division.hpp"
#include <comp.hpp>
#include <optional>

namespace ngsxfem_contact
{
  using ngcomp::MeshAccess;

  Triangle VerticesOf (const MeshAccess & mesh, size_t element);
  /// Whether a boundary element of the mesh lies between two elements.
  bool IsInterface (const MeshAccess & mesh, size_t bnd_element);

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
    Point Value (Point p) const { return At(p).value; }
    /// How far edges are from those of the straight triangle, about.
    double Bulge () const;
    struct Image { Point value, d0, d1; };                 // with the derivatives by the coordinates of p
    Image At (Point p) const;
    /// The p of a point x in the element or beside it, by Newton's method; nothing where that does not converge.
    std::optional<Point> Inverse (Point x) const;

    /// In NGSolve's reference triangle, (1, 0), (0, 1), (0, 0), with a weight that NGSolve multiplies by the Jacobian: a point p of the straight
    /// triangle with its weight there, a point x of the element with its own.
    ngfem::IntegrationPoint InReference (Point p, double weight) const;
    ngfem::IntegrationPoint PhysicalInReference (Point x, double weight) const;

  private:
    Point Reference (Point p) const;
  };

  /// A boundary element as straight: a + x (b-a), x in NGSolve's reference segment, which runs from the second vertex (0) to the first (1).
  class EdgeMap
  {
    Point a, b;
  public:
    EdgeMap (const MeshAccess & mesh, size_t bnd_element);
    Point Value (double x) const { return Lerp(a, b, x); }
    double Length () const { return Norm(Point(b-a)); }
    double DistanceTo (Point p) const { return Distance(p, a, b); }
    /// Where the edge meets the line through m with a normal.
    double Crossing (Point m, Point normal) const { return Dot(Point(m-a), normal)/Dot(Point(b-a), normal); }
    ngfem::IntegrationPoint InReference (Point p, double weight) const;
  };
}
