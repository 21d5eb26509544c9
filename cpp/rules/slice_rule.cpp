#include "rules/slice_rule.hpp"
#include "cut/tet_division.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  FrontPiece::Place FrontPiece :: At (double s) const
  {
    double within = std::clamp(s, 0.0, piece.Length());
    Point tangent = piece.Tangent(within), point = piece.PointAt(within);
    if (s != within) return { Point(point + (s-within)*tangent), tangent, 0 };
    return { point, tangent, IsStraight() ? 0 : piece.Curvature(s) };
  }

  double FrontPiece :: Foot (Point p) const
  {
    if (IsStraight()) return Dot(Point(p-piece.Value(0)), piece.Derivative(0));
    double t = piece.Nearest(p);
    if (t > 0 && t < piece.End()) return piece.ArcLength(t);
    double s = t > 0 ? piece.Length() : 0, beyond = Dot(Point(p-piece.Value(t)), piece.Tangent(s));
    return t > 0 ? s + std::max(0.0, beyond) : std::min(0.0, beyond);
  }

  double FrontPiece :: LargestCurvature (double s0, double s1) const
  {
    double largest = 0;
    if (!IsStraight())
      for (int i = 0; i <= 4; i++) largest = std::max(largest, std::abs(piece.Curvature(std::clamp(s0 + 0.25*i*(s1-s0), 0.0, piece.Length()))));
    return largest;
  }

  std::vector<double> FrontPiece :: Meetings (const Polygon & polygon) const
  {
    std::vector<double> meetings;
    for (size_t i = 0; i < polygon.size(); i++)
      {
        Point a = polygon[i], d = polygon[(i+1) % polygon.size()]-a;
        double length = Norm(d);
        if (length == 0) continue;
        auto add = [&] (Point p, double s) { if (double along = Dot(Point(p-a), d)/length; along >= -1e-9*length && along <= (1+1e-9)*length) meetings.push_back(s); };
        std::vector<double> parameters;
        piece.AppendCrossings(a, Left(Point(1/length*d)), parameters);
        for (double t : parameters) add(piece.Value(t), piece.ArcLength(t));
        for (double end : { 0.0, piece.Length() })
          {
            Point tangent = piece.Tangent(end), from = piece.PointAt(end);
            double rate = Cross(tangent, d), s = rate ? Cross(Point(a-from), d)/rate : 0;
            if (end > 0 ? s > 0 : s < 0) add(Point(from + s*tangent), end+s);
          }
      }
    return meetings;
  }

  namespace
  {
    /// A convex polygon seen from 0, divided into sectors between its corners; θ = ±π is the crack.
    class PolarSlice
    {
      struct Side { double distance, direction; };               // of its line, and of the normal that points out
      std::vector<Side> sides;
      std::vector<double> angles;
      const FrontDemand & demand;

    public:
      PolarSlice (const Polygon & polygon, const FrontDemand & ademand) : demand(ademand)
      {
        double size = 0, nearest = std::numeric_limits<double>::infinity();
        for (auto & p : polygon) size = std::max(size, Norm(p));
        for (size_t i = 0; i < polygon.size(); i++)
          {
            Point a = polygon[i], d = polygon[(i+1) % polygon.size()]-a;
            double length = Norm(d);
            if (length <= 1e-14*size) continue;
            Point out(d(1)/length, -d(0)/length);
            sides.push_back({ Dot(out, a), atan2(out(1), out(0)) });
            nearest = std::min(nearest, sides.back().distance);
          }
        bool inside = nearest > -1e-13*size;
        Point centre = Centre(polygon);
        double base = inside ? 0 : atan2(centre(1), centre(0));
        for (auto & p : polygon)
          if (Norm(p) > 1e-13*size) angles.push_back(base + std::remainder(atan2(p(1), p(0))-base, 2*M_PI));
        if (inside) angles.insert(angles.end(), { -M_PI, M_PI });
        else
          {
            auto [lo, hi] = std::ranges::minmax(angles);
            for (double crack : { -M_PI, M_PI })
              if (crack > lo && crack < hi) angles.push_back(crack);
          }
        std::ranges::sort(angles);
      }

      template <typename F>
      void Visit (F && visit) const
      {
        for (size_t i = 0; i+1 < angles.size(); i++)
          if (angles[i+1]-angles[i] > 1e-13) VisitSector(angles[i], angles[i+1], visit);
      }

    private:
      template <typename F>
      void VisitSector (double a, double b, F && visit) const
      {
        double middle = 0.5*(a+b), from = 0, to = std::numeric_limits<double>::infinity();
        const Side * inner = nullptr, * outer = nullptr;
        for (auto & side : sides)
          {
            double c = cos(middle-side.direction), r = side.distance/c;
            if (c > 0 && r < to) { to = r; outer = &side; }
            if (c < 0 && r > from) { from = r; inner = &side; }
          }
        if (!outer || !(to > from)) return;
        // graded to the direction in which the nearer of the two lines is nearest: there r(θ) varies at the scale of its distance
        bool by_inner = inner && -inner->distance < outer->distance;
        double foot = by_inner ? inner->direction+M_PI : outer->direction;
        double from_foot = std::remainder(a-foot, 2*M_PI), limit = M_PI/2-1e-13;
        double ua = asinh(tan(std::max(from_foot, -limit))), ub = asinh(tan(std::min(from_foot+b-a, limit)));
        int n = std::min(60, demand.angular + int(std::ceil((ub-ua)*demand.angular/3)));
        Gauss(ua, ub, n, [&] (double u, double du)
        {
          double theta = foot + atan(sinh(u)), dtheta = du/cosh(u);
          double r0 = inner ? std::max(0.0, inner->distance/cos(theta-inner->direction)) : 0, r1 = outer->distance/cos(theta-outer->direction);
          if (!(r1 > r0)) return;
          Gauss(sqrt(r0), sqrt(r1), demand.radial, [&] (double root, double weight)
          { visit(root*root*cos(theta), root*root*sin(theta), dtheta*weight*2*root*root*root); });
        });
      }
    };

    /// Gauss in s between the breaks.
    template <typename F>
    void VisitSlices (std::vector<double> breaks, double size, const FrontPiece & piece, int n, F && visit)
    {
      auto [least, most] = std::ranges::minmax(breaks);
      if (!piece.IsStraight())
        for (double end : { 0.0, piece.Length() })
          if (end > least && end < most) breaks.push_back(end);
      std::ranges::sort(breaks);
      for (size_t i = 0; i+1 < breaks.size(); i++)
        if (breaks[i+1]-breaks[i] > 1e-11*size)
          Gauss(breaks[i], breaks[i+1], n, [&] (double s, double ds) { visit(piece.At(s), ds); });
    }
  }

  void AppendSlices (const Tet & t, const std::array<double,4> & heights, const FrontPiece & piece, const FrontDemand & demand, PointRule3 & rule)
  {
    auto & plane = piece.GetPlane();
    std::array<Point,4> p;
    std::vector<double> breaks;
    for (int i = 0; i < 4; i++)
      {
        p[i] = plane.Project(t[i]);
        breaks.push_back(piece.Foot(p[i]));
      }
    Polygon cut;
    for (auto & corner : CutPolygon(t, heights)) cut.push_back(plane.Project(corner.point));
    auto [least, most] = std::ranges::minmax(breaks);
    for (double s : piece.Meetings(cut))
      if (s > least && s < most) breaks.push_back(s);
    for (auto & corner : cut) breaks.push_back(std::clamp(piece.Foot(corner), least, most));
    VisitSlices(breaks, LongestEdge(t), piece, demand.along, [&] (const FrontPiece::Place & at, double ds)
    {
      Point ahead = Left(at.tangent);
      std::array<double,4> d, x1;
      for (int i = 0; i < 4; i++)
        {
          Point off = p[i]-at.point;
          d[i] = Dot(off, at.tangent);
          x1[i] = Dot(off, ahead);
        }
      Polygon slice;
      for (auto & [i, j] : tet_edges)
        if (d[i]*d[j] < 0) slice.push_back(Lerp(Point(x1[i], heights[i]), Point(x1[j], heights[j]), d[i]/(d[i]-d[j])));
      if (slice.size() < 3) return;
      slice = HullOf(slice);
      if (slice.size() < 3) return;
      PolarSlice(slice, demand).Visit([&] (double y1, double y2, double weight)
      { rule.push_back({ plane.Value(Point(at.point + y1*ahead), y2), weight*ds*(1-at.curvature*y1) }); });
    });
  }

  void AppendPlaneSlices (const Polygon & polygon, const FrontPiece & piece, const FrontDemand & demand, PointRule & rule)
  {
    std::vector<double> breaks;
    double size = 0;
    for (auto & p : polygon)
      {
        breaks.push_back(piece.Foot(p));
        size = std::max(size, Norm(Point(p-polygon[0])));
      }
    auto [least, most] = std::ranges::minmax(breaks);
    for (double s : piece.Meetings(polygon))
      if (s > least && s < most) breaks.push_back(s);
    VisitSlices(breaks, size, piece, demand.along, [&] (const FrontPiece::Place & at, double ds)
    {
      Point behind = -1*Left(at.tangent);
      std::vector<double> r;
      for (size_t i = 0; i < polygon.size(); i++)
        {
          Point a = polygon[i]-at.point, b = polygon[(i+1) % polygon.size()]-at.point;
          double da = Dot(a, at.tangent), db = Dot(b, at.tangent);
          if (da*db < 0) r.push_back(Dot(Lerp(a, b, da/(da-db)), behind));
        }
      if (r.size() < 2) return;
      auto [r0, r1] = std::ranges::minmax(r);
      if (!(r1 > 0)) return;
      Gauss(sqrt(std::max(r0, 0.0)), sqrt(r1), demand.radial, [&] (double root, double weight)
      {
        double distance = root*root;
        rule.push_back({ Point(at.point + distance*behind), 2*root*weight*ds*(1+at.curvature*distance) });
      });
    });
  }
}
