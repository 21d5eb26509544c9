#include "rules/cut_rule.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngfem::IntegrationRule, ngfem::SelectIntegrationRule;

  std::vector<double> Breakpoints (double a, double b, const std::set<double> & breaks)
  {
    std::vector<double> points { a };
    for (double x : breaks)
      if (x > a*(1+1e-12) && x < b*(1-1e-12)) points.push_back(x);
    points.push_back(b);
    return points;
  }

  namespace
  {
    /// A ray from the tip at angle θ meets a line at r = distance / cos(θ - direction).
    struct PolarLine
    {
      double distance, direction;
      PolarLine (Point a, Point b)
      {
        Point t = b-a;
        Point normal = Point(1/Norm(t) * Point(t(1), -t(0)));
        distance = Dot(a, normal);
        if (distance < 0) { distance = -distance; normal = Point(-1*normal); }
        direction = atan2(normal(1), normal(0));
      }
      /// At most reach: beside the angle of the pole the quotient is no better than round-off.
      double Radius (double theta, double reach) const
      {
        double c = cos(theta-direction);
        return distance >= c*reach ? reach : distance/c;
      }
      /// Distance in θ from [a, b] to the next angle at which the ray is parallel to the line.
      double ToParallel (double a, double b) const
      {
        double lo = std::remainder(a-direction, 2*M_PI), hi = lo + (b-a);
        return std::max(0.0, std::min(M_PI/2-hi, lo+M_PI/2));
      }
      void AppendCrossings (double radius, std::vector<double> & angles) const
      {
        if (radius <= distance) return;
        double w = acos(distance/radius);
        angles.push_back(direction-w);
        angles.push_back(direction+w);
      }
    };

    /// The part of a triangle that is seen from the tip under angles [a, b], between two of its edges' lines.
    class Sector
    {
      const TipQuadrature & tip;
      double reach;
      int n_radial, n_angular;
      std::optional<PolarLine> inner;
      PolarLine outer;
      PointRule & rule;

    public:
      Sector (const TipQuadrature & atip, double areach, int order, std::optional<PolarLine> ainner, PolarLine aouter, PointRule & arule)
        : tip(atip), reach(areach), n_radial(std::min(atip.RadialPoints(order), order + int(std::ceil(-1.2*log10(atip.tolerance))))),
          n_angular(8+order/2 + int(-0.5*log10(atip.tolerance))),
          inner(ainner), outer(aouter), rule(arule) { }

      void Append (double a, double b)
      {
        if (b-a <= 1e-14) return;
        std::vector<double> angles;
        for (double radius : tip.breaks)
          {
            outer.AppendCrossings(radius, angles);
            if (inner) inner->AppendCrossings(radius, angles);
          }
        std::vector<double> cuts { a, b };
        for (double angle : angles)
          {
            double x = a + std::remainder(angle-a, 2*M_PI);
            if (x > a+1e-12 && x < b-1e-12) cuts.push_back(x);
          }
        std::sort(cuts.begin(), cuts.end());
        for (size_t i = 0; i+1 < cuts.size(); i++)
          AppendSmooth(cuts[i], cuts[i+1], 60);
      }

    private:
      /// Halved until it is no longer than the distance to the angles at which r(θ) has a pole.
      void AppendSmooth (double a, double b, int depth)
      {
        double clear = outer.ToParallel(a, b);
        if (inner) clear = std::min(clear, inner->ToParallel(a, b));
        if (depth > 0 && b-a > clear+1e-13)
          {
            AppendSmooth(a, 0.5*(a+b), depth-1);
            AppendSmooth(0.5*(a+b), b, depth-1);
          }
        else
          Gauss(a, b, n_angular, [&] (double theta, double w) { AppendRay(theta, w); });
      }

      void AppendRay (double theta, double w)
      {
        double from = inner ? inner->Radius(theta, reach) : 0, to = outer.Radius(theta, reach);
        if (!(to > from)) return;
        Point direction(cos(theta), sin(theta));
        GaussInRoot(from, to, tip.breaks, n_radial, [&] (double r, double dr) { rule.push_back({ Point(tip.tip + r*direction), w*dr*r }); });
      }
    };

    /// The corners of t around the tip, sorted by the angle under which the tip sees them.
    struct Corner { double theta; Point p; };

    void AppendPolar (Triangle t, int order, const TipQuadrature & tip, PointRule & rule)
    {
      for (auto & p : t) p = Point(p-tip.tip);
      std::sort(t.begin(), t.end(), [] (Point a, Point b) { return Norm(a) < Norm(b); });
      bool at_corner = Norm(t[0]) == 0;
      double reach = Norm(t[2]);
      Point reference = at_corner ? Point(t[1]+t[2]) : Point(t[0]+t[1]+t[2]);
      auto angle = [&] (Point p) { return atan2(Cross(reference, p), Dot(reference, p)); };
      double base = atan2(reference(1), reference(0));
      if (at_corner)
        {
          double a = angle(t[1]), b = angle(t[2]);
          Sector(tip, reach, order, std::nullopt, PolarLine(t[1], t[2]), rule).Append(base+std::min(a,b), base+std::max(a,b));
          return;
        }
      std::array<Corner,3> c { { { angle(t[0]), t[0] }, { angle(t[1]), t[1] }, { angle(t[2]), t[2] } } };
      std::sort(c.begin(), c.end(), [] (auto & a, auto & b) { return a.theta < b.theta; });
      PolarLine through(c[0].p, c[2].p);
      bool middle_is_nearer = Norm(c[1].p) < through.Radius(base+c[1].theta, reach);
      for (int k = 0; k < 2; k++)
        {
          if (c[k+1].theta-c[k].theta <= 1e-14) continue;
          PolarLine edge(c[k].p, c[k+1].p);
          Sector(tip, reach, order, middle_is_nearer ? edge : through, middle_is_nearer ? through : edge, rule)
            .Append(base+c[k].theta, base+c[k+1].theta);
        }
    }

    /// Closer than this to a triangle, relative to its size, a tip is taken to lie in it: ∫|∇F|² over what is then missed
    /// is as small as that, where a rule around the tip itself would need points at all scales down to that distance.
    double SnapDistance (const Triangle & t, const TipQuadrature & tip) { return std::max(1e-9, 0.1*tip.tolerance)*LongestEdge(t); }

    /// The corner, the point on an edge, or the point itself: a corner of every part that t is divided into.
    Point Snapped (Point p, const Triangle & t, double distance)
    {
      for (auto & corner : t)
        if (Norm(Point(p-corner)) <= distance) return corner;
      for (int i = 0; i < 3; i++)
        {
          Point a = t[i], ab = t[(i+1)%3]-a;
          if (Distance(p, a, t[(i+1)%3]) <= distance) return Point(a + Dot(p-a, ab)/Dot(ab, ab) * ab);
        }
      return p;
    }

    /// Whether the circle of radius r around p passes through t.
    bool Crosses (const Triangle & t, Point p, double r)
    {
      double farthest = std::max({ Norm(Point(t[0]-p)), Norm(Point(t[1]-p)), Norm(Point(t[2]-p)) });
      return farthest > r && Distance(p, t) < r;
    }
  }

  int TipQuadrature :: RadialPoints (int order) const
  {
    // |∇(χF)|² r dr with quintic χ is a polynomial of degree 2·(2·5) + 2·1 + 1 in √r, beside order·2 of the rest
    return std::min(int(std::ceil(-1.2*log10(tolerance))) + order, 20);
  }

  double TipQuadrature :: AnnulusWidth (double r) const
  {
    auto above = breaks.upper_bound(r);
    if (above == breaks.begin()) return *above;
    return above == breaks.end() ? Radius() : *above - *std::prev(above);
  }

  double TipQuadrature :: KinkOrder (double r, double h) const
  {
    // beside |∇F| = 1/(2√r), χ' F grows like 12 r x/w² (60 r x²/w³, 280 r x³/w⁴) with the distance x from the kink;
    // of that at x = h, Gauss of order q misses about a tenth of (q+1)^-2 (-3, -4)
    constexpr double growth[] = { 12, 60, 280 };
    double w = r < Radius() ? AnnulusWidth(r) : AnnulusWidth(0.999*r);
    return pow(0.1*growth[smoothness-1] * r/w * pow(h/w, smoothness) / tolerance, 1./(smoothness+1)) - 1;
  }

  /// NGSolve's rule of order 2 has its points on the edges, hence on Γ_C, where a point has no side.
  static int OffEdges (int order) { return order == 2 ? 3 : order; }

  void AppendTriangle (const Triangle & t, int order, PointRule & rule)
  {
    double jacobian = 2*Area(t);
    for (auto & ip : SelectIntegrationRule(ngfem::ET_TRIG, OffEdges(order)))
      rule.push_back({ Point(ip(0)*t[0] + ip(1)*t[1] + (1-ip(0)-ip(1))*t[2]), ip.Weight()*jacobian });
  }

  std::optional<int> GaussOrder (const Triangle & t, int order, const TipQuadrature & tip)
  {
    double h = LongestEdge(t), r = Distance(tip.tip, t), kink = 0;
    if (r < 1.5*h) return std::nullopt;
    for (double radius : tip.breaks)
      if (Crosses(t, tip.tip, radius)) kink = std::max(kink, tip.KinkOrder(radius, h));
    if (kink > 14) return std::nullopt;            // a polar rule has fewer points
    // √r is analytic up to the tip: the error of Gauss falls by e = z + √(z²-1) for each degree, z = 1 + 2r/h;
    // χ² is a polynomial of degree 10 in r at the scale of its annulus
    double z = 1 + 2*r/h, e = z + sqrt(z*z-1), scale = 1 + tip.AnnulusWidth(r)/h;
    double digits = -log(tip.tolerance);
    int extra = int(std::ceil(std::max(0.7*digits/log(e), std::min(10.0, 0.7*digits/log(scale)))));
    return OffEdges(std::min(std::max(order+extra, int(std::ceil(kink))), 24));
  }

  void AppendTriangleNearTip (const Triangle & t, int order, const TipQuadrature & tip, PointRule & rule)
  {
    if (auto gauss = GaussOrder(t, order, tip))
      {
        AppendTriangle(t, *gauss, rule);
        return;
      }
    double h = LongestEdge(t), snap = SnapDistance(t, tip);
    if (Distance(tip.tip, t) > snap)
      {
        AppendPolar(t, order, tip, rule);
        return;
      }
    TipQuadrature centre = tip;
    centre.tip = Snapped(tip.tip, t, snap);
    for (int i = 0; i < 3; i++)
      {
        Triangle part { centre.tip, t[i], t[(i+1)%3] };
        if (Area(part) > 1e-13*h*h) AppendPolar(part, order, centre, rule);
      }
  }

  void AppendSegment (Point a, Point b, int order, const TipQuadrature * tip, double break_distance, PointRule & rule)
  {
    int n = order/2+1;
    Point d = b-a;
    double length = Norm(d);
    double ra = 0, rb = 0;
    if (tip)
      {
        if (Norm(Point(a-tip->tip)) > Norm(Point(b-tip->tip))) { std::swap(a, b); d = Point(-1*d); }
        ra = Norm(Point(a-tip->tip));
        rb = Norm(Point(b-tip->tip));
      }
    bool radial = tip && rb-ra >= 0.8*length;                       // not beyond a kink that the tip's functions do not follow
    if (!radial)
      {
        Gauss(0, 1, n, [&] (double t, double w) { rule.push_back({ Lerp(a, b, t), w*length }); });
        return;
      }
    auto breaks = tip->breaks;
    breaks.insert(break_distance);
    if (ra <= 1e-12*length) ra = 0;
    GaussInRoot(ra, rb, breaks, tip->RadialPoints(order), [&] (double r, double dr)
    { rule.push_back({ Point(a + (r-ra)/(rb-ra)*d), dr*length/(rb-ra) }); });
  }

  namespace
  {
    /// Halved until no part is longer than its distance from the tip: there √r is not smooth.
    void AppendGraded (Point a, Point b, int n, Point tip, int depth, PointRule & rule)
    {
      double length = Norm(Point(b-a));
      Point m = Lerp(a, b, 0.5);
      if (depth > 0 && Distance(tip, a, b) < length)
        {
          AppendGraded(a, m, n, tip, depth-1, rule);
          AppendGraded(m, b, n, tip, depth-1, rule);
        }
      else
        Gauss(0, 1, n, [&] (double t, double w) { rule.push_back({ Lerp(a, b, t), w*length }); });
    }
  }

  void AppendSegmentBesideTip (Point a, Point b, int order, const TipQuadrature & tip, PointRule & rule)
  {
    Point d = b-a, to_tip = tip.tip-a;
    double length = Norm(d), foot = Dot(to_tip, d)/(length*length), height = std::abs(Cross(d, to_tip))/length;
    std::set<double> cuts { foot };
    for (double radius : tip.breaks)
      if (radius > height)
        for (double half = sqrt(radius*radius-height*height)/length; double x : { foot-half, foot+half }) cuts.insert(x);
    std::vector<double> parts { 0 };
    for (double x : cuts)
      if (x > 1e-12 && x < 1-1e-12) parts.push_back(x);
    parts.push_back(1);
    for (size_t i = 0; i+1 < parts.size(); i++)
      {
        Point p = Lerp(a, b, parts[i]), q = Lerp(a, b, parts[i+1]);
        if (height <= 1e-10*length) AppendSegment(p, q, order, &tip, tip.Radius(), rule);
        else AppendGraded(p, q, 8+order/2+int(-0.5*log10(tip.tolerance)), tip.tip, 40, rule);
      }
  }
}
