#pragma once
// A front: where a sheet ends inside the body, and the coordinates around it (docs/method.md, section 13).

#include "cut/sheet.hpp"

namespace ngsxfem_contact
{
  class Front
  {
    size_t sheet, loop;
    Plane plane;
    std::shared_ptr<const Surface> surface;  // nullptr: of a planar sheet
    Crack curve;                             // in the plane, S to its right
    std::vector<double> corners;

  public:
    /// A closed curve, or a stretch of it with both ends on ∂Ω, that bounds a sheet with a number.
    Front (size_t anumber, size_t aloop, const Sheet & asheet, Crack acurve);

    size_t SheetNumber () const { return sheet; }
    /// The number of the curve of the sheet that it is a part of.
    size_t Loop () const { return loop; }
    const Crack & Curve () const { return curve; }
    bool IsPlanar () const { return !surface; }
    /// That of the curve, see Sheet::GetPlane.
    const Plane & GetPlane () const { return plane; }
    double Length () const { return curve.Length(); }
    bool IsClosed () const { return curve.IsClosed(); }
    /// Arc lengths at which the direction jumps.
    const std::vector<double> & Corners () const { return corners; }

    Point3 PointAt (double s) const;
    /// e₁ ahead, out of S; e₂ = n; e₃ = e₁ × e₂, the direction in which s grows.
    std::array<Point3,3> FrameAt (double s) const;
    /// Directions of x₁ and s in the plane of the curve.
    std::array<Point3,2> FlatFrameAt (double s) const;
    /// Of a curved sheet: FrameAt, and how x₁ and x₂ in flat coordinates are components along e₁ and e₂, stretch[0] x₁ + stretch[1] x₂ and stretch[2] x₂.
    struct Local { std::array<Point3,3> frame; std::array<double,3> stretch; };
    Local LocalAt (double s) const;
    /// The derivatives of LocalAt by s.
    Local TurnAt (double s) const;
    /// The number of the stretch between two corners that has s, 0 if there are none; nullopt at a corner.
    std::optional<size_t> StretchAt (double s) const;
    /// 1/R_f, positive where S is convex: along a curved sheet the geodesic curvature.
    double CurvatureAt (double s) const;

    /// x = C(s) + x₁ e₁ + x₂ e₂; x₂ = 0 on S, also for points that are there but for round-off. Nearest to a corner x₁ is the distance from it.
    struct TubePoint { double x1, x2, s; };
    TubePoint Tube (Point3 x) const { return FlatTube(surface ? surface->Flat(x) : x); }
    double Distance (Point3 x) const { return FlatDistance(surface ? surface->Flat(x) : x); }
    /// The same of a point in the coordinates of Sheet::Flat.
    TubePoint FlatTube (Point3 flat) const;
    double FlatDistance (Point3 flat) const { return std::hypot(curve.Nearest(plane.Project(flat)).distance, plane.Height(flat)); }
  };
}
