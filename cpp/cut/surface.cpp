#include "cut/surface.hpp"
#include "cut/flat_map.hpp"
#include <algorithm>
#include <set>

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

  constexpr double least_angle = 1e-6;       // in radians, between a facet and the direction of heights in it

  ExtrudedCurve :: ExtrudedCurve (Crack acurve, Point3 origin, std::array<Point3,2> axes) : curve(std::move(acurve)), plane(PlaneOf(origin, axes, "Sheet.Extrude"))
  {
    if (curve.IsClosed())
      throw Exception("Sheet.Extrude: the crack is closed; a sheet that closes around a part of the body is not there: extrude an open crack, or two halves in bodies of their own");
    std::vector<size_t> ends { 0 };
    for (size_t i = 1; i < curve.NumPieces(); i++)
      if (curve.IsKink(i)) ends.push_back(i);
    ends.push_back(curve.NumPieces());
    for (size_t k = 1; k+1 < ends.size(); k++)
      {
        size_t i = ends[k];
        double s = curve.ArcLength(i), shorter = std::min(s-curve.ArcLength(ends[k-1]), curve.ArcLength(ends[k+1])-s);
        Point before = curve.Tangent(i-1, s), after = curve.Tangent(i, s);
        Point along = before+after;
        kinks.push_back({ i, curve.Points()[i], Point(1/Norm(along) * along), s, Cross(before, after)/(1+Dot(before, after)), shorter/3 });
      }
  }

  ExtrudedCurve::Foot ExtrudedCurve :: FootOf (Point q) const
  {
    auto at = curve.Nearest(q);
    size_t piece = at.piece;
    double t = at.t;
    bool at_end = at.beyond_end;
    // nearest to a kink: the plane that bisects its angle decides, whichever piece was found first
    if (!at.beyond_end)
      if (size_t i = t <= 0 ? piece : t >= curve.Piece(piece).End() ? piece+1 : 0; i > 0 && i < curve.NumPieces() && curve.IsKink(i))
        {
          double s = curve.ArcLength(i);
          bool after = Dot(Point(q-curve.Points()[i]), Point(curve.Tangent(i-1, s) + curve.Tangent(i, s))) >= 0;
          at_end = true;
          piece = after ? i : i-1;
          t = after ? 0 : curve.Piece(piece).End();
        }
    Crack::Projection foot { piece, t, 0, false };
    Point tangent = curve.Tangent(foot), d = q-curve.Piece(piece).Value(t);
    size_t part = std::ranges::count_if(kinks, [piece] (auto & kink) { return kink.point <= piece; });
    return { part, curve.ArcLength(foot) + (at_end ? Dot(d, tangent) : 0), Cross(tangent, d) };
  }

  double ExtrudedCurve :: Shear (Point q, const Foot & foot) const
  {
    double shear = 0, nearest = std::numeric_limits<double>::infinity();
    for (size_t k : { foot.part, foot.part+1 })
      if (k > 0 && k <= kinks.size())
        if (auto & kink = kinks[k-1]; Norm(Point(q-kink.at)) < nearest)
          {
            nearest = Norm(Point(q-kink.at));
            shear = std::clamp(2*(1-nearest/kink.reach), 0.0, 1.0) * foot.height * (k == foot.part ? -kink.slope : kink.slope);
          }
    return shear;
  }

  Point3 ExtrudedCurve :: Flat (Point3 x) const
  {
    Point q = plane.Project(x);
    auto foot = FootOf(q);
    return Point3(plane.Height(x), foot.s + Shear(q, foot), foot.height);
  }

  bool ExtrudedCurve :: Represents (const Tet & t, const Tet & flat) const
  {
    if (kinks.empty()) return IsFaithful(flat, t);
    double h = LongestEdge(t);
    std::array<Foot,4> feet;
    std::set<size_t> parts;
    std::array<bool,4> on_bisector;
    for (int i = 0; i < 4; i++)
      {
        Point q = plane.Project(t[i]);
        feet[i] = FootOf(q);
        on_bisector[i] = std::ranges::any_of(kinks, [&] (auto & kink) { return std::abs(Dot(Point(q-kink.at), kink.along)) <= 1e-9*h && std::abs(feet[i].s-kink.place) <= 2*Norm(Point(q-kink.at)); });
        if (!on_bisector[i]) parts.insert(feet[i].part);
      }
    FlatMap map(t, flat);
    Point3 normal = map.Gradient(2), across = Cross(map.Gradient(0), map.Gradient(1));
    if (!(std::abs(Dot(normal, across)) > least_angle*Norm(normal)*Norm(across))) return false;
    if (parts.size() > 2 || (parts.size() == 2 && *parts.rbegin() != *parts.begin()+1)) return false;
    if (parts.size() == 2)
      {
        // where an edge crosses the sheet and the plane that bisects the angle of a kink, it comes as near to the kink as this
        auto & kink = kinks[*parts.begin()];
        return Norm(Point(plane.Project(Centre(t))-kink.at)) < h * (1 + std::hypot(1., kink.slope));
      }
    if (parts.empty()) return true;
    Tet straight;                            // without shear; the feet of points on a bisector on both parts are each other's mirror images
    for (int i = 0; i < 4; i++)
      {
        size_t part = *parts.begin(), here = feet[i].part;
        double s = here == part ? feet[i].s : 2*kinks[std::min(here, part)].place-feet[i].s;
        straight[i] = Point3(plane.Height(t[i]), s, feet[i].height);
      }
    return IsFaithful(straight, t);
  }

  std::vector<double> ExtrudedCurve :: Kinks () const
  {
    std::vector<double> places;
    for (auto & kink : kinks) places.push_back(kink.place);
    return places;
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
