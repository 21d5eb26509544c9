#include "rules/curved_rule.hpp"
#include <algorithm>
#include <optional>

namespace ngsxfem_contact
{
  namespace
  {
    /// A stretch of a crack's piece, in the piece's own parameter.
    struct Stretch
    {
      const CurvePiece & curve;
      double t0, t1;
      Stretch (const Crack & crack, const Chord & chord)
        : curve(crack.Piece(chord.piece)), t0(Parameter(crack, chord, chord.s0)), t1(Parameter(crack, chord, chord.s1)) { }

      template <typename F>
      void Visit (int order, F && visit) const
      { Gauss(t0, t1, curve.GaussPoints(order, t0, t1), [&] (double t, double w) { visit(curve.Value(t), Point(w*curve.Derivative(t))); }); }

    private:
      double Parameter (const Crack & crack, const Chord & chord, double s) const
      { return curve.Parameter(s-crack.ArcLength(chord.piece)); }
    };

    /// Whether the crack is on θ = ±π in the coordinates of a tip along this stretch.
    bool BelongsTo (const Crack & crack, const Chord & chord, const TipQuadrature & tip)
    {
      for (double t : { 0.0, 0.5, 1.0 })
        {
          Point p = crack.PointAt(chord.piece, chord.s0 + t*(chord.s1-chord.s0));
          double r = Norm(Point(p-tip.tip));
          if (r > tip.curve.Reach() || Norm(Point(p-tip.curve.Behind(r).first)) > 1e-9*(chord.s1-chord.s0)) return false;
        }
      return true;
    }

    /// A triangle with one side on the crack, swept by the crack turned around its tip by angles ψ from 0 on.
    class CrackSweep
    {
      const TipQuadrature & tip;
      int sign, n_radial, n_angular;
      double snap;
      PointRule & rule;

      /// Part of a straight side from x to y along which ψ is monotone.
      struct Arm
      {
        Point x, y;
        double from, to;
        bool from_tip;
        bool Spans (double a, double b) const { return std::min(from, to) <= a+1e-14 && std::max(from, to) >= b-1e-14; }
      };
      std::vector<Arm> arms;
      std::vector<double> cuts { 0 };

    public:
      CrackSweep (const PartTriangle & part, int order, const TipQuadrature & atip, PointRule & arule)
        : tip(atip), sign(0), n_radial(tip.RadialPoints(order)), n_angular(14+order/2+int(-0.5*log10(tip.tolerance))), rule(arule)
      {
        auto corners = part.triangle;
        for (auto & p : corners) p = Point(p-tip.tip);
        snap = 1e-9*LongestEdge(part.triangle);
        for (auto & p : corners) if (Norm(p) <= snap) p = Point(0., 0.);
        sign = SignedAngle(corners[0], corners[0]) >= 0 ? 1 : -1;
        for (int i : { 1, 2 }) AppendSide(corners[0], corners[i]);
      }

      void Append ()
      {
        std::sort(cuts.begin(), cuts.end());
        for (size_t i = 0; i+1 < cuts.size(); i++)
          if (cuts[i+1]-cuts[i] > 1e-14)
            {
              std::vector<Arm> active;
              for (auto & arm : arms)
                if (arm.Spans(cuts[i], cuts[i+1])) active.push_back(arm);
              AppendSmooth(active, cuts[i], cuts[i+1], 40);
            }
      }

    private:
      Point Behind (double r) const
      {
        auto turn = tip.curve.At(r).point;
        return Point(-turn.cos*tip.curve.Ahead() - turn.sin*Left(tip.curve.Ahead()));
      }

      /// From the crack at the same distance; direction: that in which d = 0 is left.
      double SignedAngle (Point d, Point direction) const
      {
        double r = Norm(d);
        Point b = Behind(r), e = r > 0 ? d : direction;
        return atan2(Cross(b, e), Dot(b, e));
      }
      double Angle (Point x, Point y, double t) const { return sign*SignedAngle(Point(x+t*(y-x)), Point(y-x)); }

      /// dψ/dt along a side, times a positive factor.
      double Rate (Point x, Point y, double t) const
      {
        Point d = x+t*(y-x), e = y-x;
        return sign*(Cross(d, e) - tip.curve.At(Norm(d)).point.slope*Norm(d)*Dot(d, e));
      }

      void AppendSide (Point x, Point y)
      {
        if (Norm(x) == 0) std::swap(x, y);
        if (Norm(y) == 0) { AppendArm(y, x, true); return; }
        std::vector<double> turns { 0 };
        constexpr int n = 16;
        for (int i = 0; i < n; i++)
          {
            double lo = i/double(n), hi = (i+1)/double(n), rate = Rate(x, y, lo);
            if (rate*Rate(x, y, hi) >= 0) continue;
            for (int it = 0; it < 60; it++)
              {
                double middle = 0.5*(lo+hi);
                (rate*Rate(x, y, middle) > 0 ? lo : hi) = middle;
              }
            turns.push_back(lo);
          }
        turns.push_back(1);
        for (size_t i = 0; i+1 < turns.size(); i++)
          AppendArm(Point(x+turns[i]*(y-x)), Point(x+turns[i+1]*(y-x)), false);
      }

      void AppendArm (Point x, Point y, bool from_tip)
      {
        double from = Angle(x, y, 0), to = Angle(x, y, 1);
        arms.push_back({ x, y, from, to, from_tip });
        for (double angle : { from, to }) if (angle > 0) cuts.push_back(angle);
        Point e = y-x;
        for (double radius : tip.breaks)
          {
            // |x + t e| = radius
            double a = Dot(e, e), b = Dot(x, e), c = Dot(x, x)-radius*radius, disc = b*b-a*c;
            if (disc <= 0) continue;
            for (double t : { (-b-sqrt(disc))/a, (-b+sqrt(disc))/a })
              if (t > 0 && t < 1)
                if (double angle = Angle(x, y, t); angle > 0) cuts.push_back(angle);
          }
      }

      /// The distance at which a turned crack meets an arm: regula falsi, halved where it is slow.
      double Radius (const Arm & arm, double angle) const
      {
        double lo = 0, hi = 1, flo = arm.from-angle, fhi = arm.to-angle, t = 0.5;
        if (flo*fhi >= 0) return Norm(std::abs(flo) < std::abs(fhi) ? arm.x : arm.y);
        for (int it = 0; it < 100 && hi-lo > 1e-15; it++)
          {
            t = it % 3 == 2 ? 0.5*(lo+hi) : (lo*fhi-hi*flo)/(fhi-flo);
            double f = Angle(arm.x, arm.y, t)-angle;
            if (std::abs(f) < 1e-16) break;
            if (f*flo > 0) { lo = t; flo = f; fhi *= 0.5; }
            else { hi = t; fhi = f; flo *= 0.5; }
          }
        return Norm(Point(arm.x+t*(arm.y-arm.x)));
      }

      /// Halved until the radii vary little: at angles at which a side is nearly parallel to the crack they have a pole.
      void AppendSmooth (const std::vector<Arm> & active, double a, double b, int depth)
      {
        bool steep = false;
        for (auto & arm : active)
          steep = steep || (!arm.from_tip && std::abs(log(Radius(arm, 0.75*a+0.25*b)/Radius(arm, 0.25*a+0.75*b))) > 0.35);
        if (depth > 0 && steep && b-a > 1e-12)
          {
            AppendSmooth(active, a, 0.5*(a+b), depth-1);
            AppendSmooth(active, 0.5*(a+b), b, depth-1);
            return;
          }
        // 3w² - 2w³ takes away square roots at both ends, where a turned crack touches a side
        Gauss(0, 1, n_angular, [&] (double w, double weight)
        { AppendRay(active, a + (b-a)*w*w*(3-2*w), (b-a)*6*w*(1-w)*weight); });
      }

      void AppendRay (const std::vector<Arm> & active, double angle, double weight)
      {
        std::vector<double> radii;
        for (auto & arm : active) radii.push_back(Radius(arm, angle));
        if (radii.size() % 2) radii.push_back(0);
        std::sort(radii.begin(), radii.end());
        double c = cos(angle), s = sign*sin(angle);
        for (size_t i = 0; i+1 < radii.size(); i += 2)
            GaussInRoot(radii[i], radii[i+1], tip.breaks, n_radial, [&] (double r, double dr)
            {
              Point b = Behind(r);
              rule.push_back({ Point(tip.tip + r*(c*b + s*Left(b))), weight*dr*r });
            });
      }
    };
  }

  void AppendCone (const PartTriangle & part, int order, PointRule & rule)
  {
    Point apex = part.triangle[0];
    Stretch(*part.curved->curve, part.curved->chord).Visit(order+1, [&] (Point p, Point dp)
    {
      double jacobian = std::abs(Cross(Point(p-apex), dp));
      Gauss(0, 1, order/2+2, [&] (double rho, double w) { rule.push_back({ Lerp(apex, p, rho), w*rho*jacobian }); });
    });
  }

  void AppendConeNearTip (const PartTriangle & part, int order, const TipQuadrature & tip, PointRule & rule)
  {
    if (auto gauss = GaussOrder(part.triangle, order, tip)) AppendCone(part, *gauss, rule);
    else if (BelongsTo(*part.curved->curve, part.curved->chord, tip)) CrackSweep(part, order, tip, rule).Append();
    else AppendCone(part, 24, rule);
  }

  void AppendCurve (const Crack & crack, const Chord & chord, int order, const TipQuadrature * tip, double break_distance, PointRule & rule)
  {
    if (!tip || !BelongsTo(crack, chord, *tip))
      {
        Stretch(crack, chord).Visit(order, [&] (Point p, Point dp) { rule.push_back({ p, Norm(dp) }); });
        return;
      }
    auto distance = [&] (double s) { return Norm(Point(crack.PointAt(chord.piece, s)-tip->tip)); };
    auto [from, to] = std::minmax({ distance(chord.s0), distance(chord.s1) });
    auto breaks = tip->breaks;
    breaks.insert(break_distance);
    GaussInRoot(from <= 1e-12*to ? 0 : from, to, breaks, tip->RadialPoints(order), [&] (double r, double dr)
    {
      auto [p, ds] = tip->curve.Behind(r);
      rule.push_back({ p, dr*ds });
    });
  }
}
