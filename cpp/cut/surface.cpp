#include "cut/surface.hpp"

namespace ngsxfem_contact
{
  using ngcore::Exception;

  Plane PlaneOf (Point3 origin, std::array<Point3,2> axes, const std::string & what)
  {
    for (Point3 p : { origin, axes[0], axes[1] })
      if (!std::isfinite(Dot(p, p))) throw Exception(what + ": the vector " + ToString(p) + " is not finite");
    double first = Norm(axes[0]), second = Norm(axes[1]);
    Point3 normal = Cross(axes[0], axes[1]);
    if (!(Norm(normal) > 1e-8*first*second)) throw Exception(what + ": the axes " + ToString(axes[0]) + " and " + ToString(axes[1]) + " are parallel, or zero; they span no plane");
    Point3 a = 1/first * axes[0], n = 1/Norm(normal) * normal;
    return { origin, { a, Cross(n, a) }, n };
  }

  std::array<Point3,2> BoxOfPlane (const Plane & plane, Point lo, Point hi, double lowest, double highest)
  {
    double large = std::numeric_limits<double>::infinity();
    std::array<Point3,2> bounds { Point3(large, large, large), Point3(-large, -large, -large) };
    for (Point q : { lo, hi, Point(lo(0), hi(1)), Point(hi(0), lo(1)) })
      for (double height : { lowest, highest })
        {
          Point3 x = plane.Value(q, height);
          for (int k = 0; k < 3; k++)
            {
              bounds[0](k) = std::min(bounds[0](k), x(k));
              bounds[1](k) = std::max(bounds[1](k), x(k));
            }
        }
    return bounds;
  }

  ExtrudedCurve :: ExtrudedCurve (Crack acurve, Point3 origin, std::array<Point3,2> axes) : curve(std::move(acurve)), plane(PlaneOf(origin, axes, "Sheet.Extrude"))
  {
    if (curve.IsClosed())
      throw Exception("Sheet.Extrude: the crack is closed; a sheet that closes around a part of the body is not there yet: extrude two halves in bodies of their own, or an open crack");
    for (size_t i = 1; i < curve.NumPieces(); i++)
      if (curve.IsKink(i))
        throw Exception("Sheet.Extrude: the crack has a kink at " + ToString(curve.Points()[i]) + "; a curved sheet is smooth: round the kink by an arc (Crack.Arc, Crack.Join) of a radius of some elements, or take Crack.Spline");
  }

  Point3 ExtrudedCurve :: Flat (Point3 x) const
  {
    Point q = plane.Project(x);
    auto at = curve.Nearest(q);
    Point tangent = curve.Tangent(at), d = q-curve.Piece(at.piece).Value(at.t);
    return Point3(plane.Height(x), curve.ArcLength(at) + (at.beyond_end ? Dot(d, tangent) : 0), Cross(tangent, d));
  }

  Surface::Place ExtrudedCurve :: At (Point p) const
  {
    double s = std::clamp(p(1), 0.0, curve.Length());
    size_t piece = curve.PieceAt(s);
    Point tangent = curve.Tangent(piece, s), point = curve.PointAt(piece, s) + (p(1)-s)*tangent;
    return { plane.Value(point, p(0)), { plane.normal, plane.Direction(tangent) }, plane.Direction(Left(tangent)), plane.Direction(Left(tangent)) };
  }

  std::array<Point3,2> ExtrudedCurve :: Bounds (Point lo, Point hi) const
  {
    Box box;
    double beyond = std::max({ 0.0, -lo(1), hi(1)-curve.Length() });
    for (auto & arc : curve.Arcs(0.25))
      {
        auto [low, high] = BoxOf(std::array { arc.a, arc.b }).Grown(2*arc.sagitta + beyond);
        box.Add(low);
        box.Add(high);
      }
    return BoxOfPlane(plane, box.lo, box.hi, lo(0), hi(0));
  }
}
