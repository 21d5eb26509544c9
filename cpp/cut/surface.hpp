#pragma once
// Curved surfaces in space with coordinates in which they are flat: what a curved sheet is a part of (docs/method.md, section 21).

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

  /// The corners of a box in space of the points of a plane between lo and hi, and of heights.
  std::array<Point3,2> BoxOfPlane (const Plane & plane, Point lo, Point hi, double lowest, double highest);

  /// what: in messages. Throws for axes that are parallel, or zero.
  Plane PlaneOf (Point3 origin, std::array<Point3,2> axes, const std::string & what);

  /// x = X(p) + height d(p); n is the normal of X, from the minus to the plus side.
  class Surface
  {
  public:
    virtual ~Surface () = default;
    /// (p₁, p₂, height) of a point; the surface goes on beyond its ends.
    virtual Point3 Flat (Point3 x) const = 0;
    /// X, its derivatives by p₁ and p₂, n and d.
    struct Place { Point3 point; std::array<Point3,2> tangents; Point3 normal, up; };
    virtual Place At (Point p) const = 0;
    /// The corners of a box in space of the points with coordinates between lo and hi.
    virtual std::array<Point3,2> Bounds (Point lo, Point hi) const = 0;
    /// Of the coordinates that the surface is given in.
    virtual const Plane & GetPlane () const = 0;
    /// Whether the surface in a tetrahedron is what flat coordinates, affine between those of its corners, say: flat are these of the corners of t.
    virtual bool Represents (const Tet & t, const Tet & flat) const { return IsFaithful(flat, t); }
    /// The values of p₂ at which it has a kink, ascending.
    virtual std::vector<double> Kinks () const { return {}; }
  };

  /// X(p) = a curve of a plane at arc length p₂, moved by p₁ along the normal of the plane; n is that of the curve. Lengths and angles are those of the
  /// coordinates, which are those of the nearest point: d = n, and |height| is the distance. Smooth parts that meet at a kink go on straight to the plane that
  /// bisects its angle, so that heights are continuous; near it p₂ is constant along the bisector.
  class ExtrudedCurve final : public Surface
  {
    struct Kink
    {
      size_t point;                          // of the curve
      Point at, along;                       // along: between the two tangents, normal to the plane that bisects the angle
      double place, slope, reach;            // arc length, the tangent of half of the turn, how far coordinates are sheared
    };
    struct Foot { size_t part; double s, height; };

    Crack curve;
    Plane plane;
    std::vector<Kink> kinks;

  public:
    /// Throws for curves that are closed.
    ExtrudedCurve (Crack acurve, Point3 origin, std::array<Point3,2> axes);
    const Crack & Curve () const { return curve; }
    const Plane & GetPlane () const override { return plane; }
    Point3 Flat (Point3 x) const override;
    Place At (Point p) const override;
    std::array<Point3,2> Bounds (Point lo, Point hi) const override;
    bool Represents (const Tet & t, const Tet & flat) const override;
    std::vector<double> Kinks () const override;

  private:
    /// On the smooth part that a point of the plane is nearest to.
    Foot FootOf (Point q) const;
    /// What is added to the arc length of the foot.
    double Shear (Point q, const Foot & foot) const;
  };
}
