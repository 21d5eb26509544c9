#include "cut/crossing.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  Crossing :: Crossing (const Polygon & apolygon, std::vector<Stretch> astretches, double atolerance)
    : polygon(apolygon), tolerance(atolerance), size(0), stretches(std::move(astretches))
  { for (auto & p : polygon) size = std::max(size, Norm(Point(p-polygon[0]))); }

  std::optional<std::array<std::vector<PartTriangle>,2>> Crossing :: Triangles () const
  {
    Point start = stretches.front().a, end = stretches.back().b;
    std::array<std::vector<PartTriangle>,2> sides;
    if (AppendSide(Loop(end, start), 1, sides[0]) && AppendSide(Loop(start, end), -1, sides[1])) return sides;
    return std::nullopt;
  }

  std::shared_ptr<const Crack> Crossing :: Curve () const
  {
    std::vector<PiecePtr> pieces;
    for (auto & [a, b, curved] : stretches)
      {
        if (!curved)
          {
            if (Norm(Point(b-a)) > tolerance) pieces.push_back(MakeSegment(a, b));
            continue;
          }
        auto [piece, s0, s1] = curved->chord;
        auto & curve = curved->curve->Piece(piece);
        double first = curved->curve->ArcLength(piece);
        pieces.push_back(curve.Between(curve.Parameter(s0-first), curve.Parameter(s1-first)));
      }
    return std::make_shared<const Crack>(Crack::Unchecked(std::move(pieces)));
  }

  Crossing::Place Crossing :: PlaceOf (Point p) const
  {
    size_t best = 0;
    for (size_t i = 1; i < polygon.size(); i++)
      if (Distance(p, Corner(i), Corner(i+1)) < Distance(p, Corner(best), Corner(best+1))) best = i;
    return { best, Dot(Point(p-Corner(best)), Point(Corner(best+1)-Corner(best))) };
  }

  bool Crossing :: IsWhole () const
  {
    auto on_boundary = [&] (Point p)
    {
      auto [edge, along] = PlaceOf(p);
      return Distance(p, Corner(edge), Corner(edge+1)) <= 4*tolerance;
    };
    return on_boundary(stretches.front().a) && on_boundary(stretches.back().b);
  }

  /// The boundary of the polygon, counter-clockwise between two points of it.
  Polygon Crossing :: Loop (Point from, Point to) const
  {
    auto a = PlaceOf(from), b = PlaceOf(to);
    size_t n = polygon.size(), corners = (b.edge+n-a.edge) % n;
    if (corners == 0 && b.along < a.along) corners = n;
    Polygon loop { from };
    for (size_t i = 1; i <= corners; i++) loop.push_back(Corner(a.edge+i));
    loop.push_back(to);
    return loop;
  }

  /// The least sine of the angle between the curve and the rays from A, positive if A is on the given side of all of it.
  double Crossing :: Visibility (Point A, int sign) const
  {
    double least = 1;
    auto see = [&] (Point p, Point tangent, bool end)
    {
      Point ray = p-A;
      if (Norm(ray) <= tolerance) return;
      double sine = sign*Cross(ray, tangent)/(Norm(ray)*Norm(tangent));
      if (!end || sine < -1e-7) least = std::min(least, sine);       // it may touch an edge of the polygon where it ends
    };
    for (auto & stretch : stretches)
      {
        Point d = stretch.b-stretch.a;
        if (Norm(d) <= tolerance) continue;
        if (!stretch.curved)
          {
            if (Norm(Point(A-stretch.a)) > tolerance && Norm(Point(A-stretch.b)) > tolerance) { see(stretch.a, d, false); see(stretch.b, d, false); }
            continue;
          }
        auto & curve = *stretch.curved->curve;
        auto [piece, s0, s1] = stretch.curved->chord;
        for (double t : { 0.0, 0.02, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 0.98, 1.0 })
          {
            double s = s0 + t*(s1-s0);
            see(curve.PointAt(piece, s), curve.Tangent(piece, s), t == 0 || t == 1);
          }
      }
    return least;
  }

  std::optional<Point> Crossing :: Apex (const Polygon & loop, int sign) const
  {
    Polygon candidates = loop;
    for (size_t i = 0; i+1 < loop.size(); i++) candidates.push_back(Lerp(loop[i], loop[i+1], 0.5));
    Point best = candidates[0];
    double most = -1;
    for (auto & p : candidates)
      if (double v = Visibility(p, sign); v > most) { most = v; best = p; }
    return most > 1e-9 ? std::optional(best) : std::nullopt;
  }

  double Crossing :: DistanceTo (Point p) const
  {
    double least = std::numeric_limits<double>::infinity();
    for (auto & [a, b, curved] : stretches)
      if (!curved)
        least = std::min(least, Norm(Point(b-a)) > 0 ? Distance(p, a, b) : Norm(Point(p-a)));
      else
        {
          auto & piece = curved->curve->Piece(curved->chord.piece);
          least = std::min(least, Norm(Point(piece.Value(piece.Nearest(p))-p)));
        }
    return least;
  }

  double Crossing :: Thickness (const Polygon & loop) const
  {
    double thickness = 0;
    for (auto & p : loop) thickness = std::max(thickness, DistanceTo(p));
    return thickness;
  }

  bool Crossing :: AppendSide (const Polygon & loop, int sign, std::vector<PartTriangle> & side) const
  {
    auto apex = Apex(loop, sign);
    if (!apex) return Thickness(loop) <= 10*tolerance && loop.size() <= 3;     // nothing but round-off
    auto append = [&] (PartTriangle t)
    { if (Area(t) > 1e-18*size*size) side.push_back(t); };
    for (size_t i = 0; i+1 < loop.size(); i++)
      append({ { *apex, loop[i], loop[i+1] }, 0, std::nullopt });
    for (auto & stretch : stretches)
      append({ { *apex, stretch.a, stretch.b }, 0, stretch.curved });
    return true;
  }
}
