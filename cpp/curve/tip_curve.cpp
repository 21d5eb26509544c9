#include "curve/tip_curve.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  namespace
  {
    /// Between the pieces that meet at the i-th point.
    double TurnAt (const Crack & curve, size_t i)
    {
      double s = curve.ArcLength(i);
      Point a = curve.Tangent(i-1, s), b = curve.Tangent(i, s);
      return atan2(Cross(a, b), Dot(a, b));
    }

    constexpr double followed_turn = 5*M_PI/180;

    bool Ends (const Crack & curve, size_t i) { return curve.IsKink(i) && std::abs(TurnAt(curve, i)) > followed_turn; }
  }

  TipCurve :: TipCurve (const Crack & curve, bool aat_end) : at_end(aat_end)
  {
    size_t last = at_end ? curve.NumPieces()-1 : 0;
    double s = at_end ? curve.Length() : 0;
    tip = curve.PointAt(last, s);
    Point t = curve.Tangent(last, s);
    ahead = at_end ? t : Point(-1*t);
    auto & piece = curve.Piece(last);
    double k = piece.Curvature(s-curve.ArcLength(last));
    curvature = piece.IsStraight() ? 0 : at_end ? -k : k;
    bool alone = curve.NumPieces() == 1 || Ends(curve, at_end ? last : 1);
    if (!(alone ? piece.Description().first != "cubic" : SmoothPartIsStraight(curve))) crack = std::make_shared<Crack>(curve);
    FindReach(curve);
  }

  size_t TipCurve :: EndOfSmoothPart (const Crack & curve) const
  {
    size_t i = at_end ? curve.NumPieces()-1 : 0;
    while (at_end ? i > 0 && !Ends(curve, i) : i+1 < curve.NumPieces() && !Ends(curve, i+1))
      at_end ? i-- : i++;
    return i;
  }

  bool TipCurve :: SmoothPartIsStraight (const Crack & curve) const
  {
    auto [first, last] = std::minmax({ EndOfSmoothPart(curve), at_end ? curve.NumPieces()-1 : 0 });
    for (size_t i = first; i <= last; i++)
      if (!curve.IsStraight(i) || (i > first && curve.IsKink(i))) return false;
    return true;
  }

  void TipCurve :: FindReach (const Crack & curve)
  {
    size_t last = EndOfSmoothPart(curve);
    reach = s_reach = 0;
    for (size_t i = at_end ? curve.NumPieces()-1 : 0; ; at_end ? i-- : i++)
      {
        auto & piece = curve.Piece(i);
        auto samples = piece.IsStraight() ? std::vector<double> { 0, 0.5*piece.Length(), piece.Length() } : piece.Samples(0.02);
        if (at_end) std::reverse(samples.begin(), samples.end());
        double t_near = at_end ? piece.End() : 0;
        size_t joint = at_end ? i+1 : i;
        double turn = arms.empty() || !curve.IsKink(joint) ? 0 : TurnAt(curve, joint), lag = arms.empty() ? 0 : arms.back().lag;
        arms.push_back({ i, reach, reach, t_near, t_near, lag + (at_end ? -turn : turn)*reach });
        for (double s : samples)
          {
            Point d = piece.PointAt(s)-tip, t = piece.Tangent(s);
            double r = Norm(d), cosine = r > 0 ? Dot(d, t)/r * (at_end ? -1 : 1) : 1;
            double passed = at_end ? curve.Length()-curve.ArcLength(i)-s : curve.ArcLength(i)+s;
            if (passed <= s_reach + 1e-10*curve.Length()) continue;
            if (r <= reach || cosine < 0.5) return;
            reach = r;
            s_reach = passed;
            arms.back().far = r;
            arms.back().t_far = piece.Parameter(s);
          }
        if (i == last) return;
      }
  }

  double TipCurve :: CurvatureLimit () const
  {
    if (!crack) return curvature ? 0.5/std::abs(curvature) : std::numeric_limits<double>::infinity();
    double largest = 0, turn = 0;
    for (size_t i = 1; i < arms.size(); i++)
      if ((turn += std::abs(arms[i].lag-arms[i-1].lag)/arms[i].near) > 0.5) return arms[i].near;
    constexpr int n = 200;
    for (int i = 0; i <= n; i++)
      {
        double s = FromEnd(s_reach*i/n);
        size_t piece = crack->PieceAt(s);
        largest = std::max(largest, std::abs(crack->Piece(piece).Curvature(s-crack->ArcLength(piece))));
        if (largest*s_reach*i/n > 0.5) return s_reach*i/n;
      }
    return std::numeric_limits<double>::infinity();
  }

  TipCurve::Turns<double> TipCurve :: General (double r) const
  {
    r = std::clamp(r, 1e-12*reach, reach);
    auto & arm = *std::lower_bound(arms.begin(), arms.end()-1, r, [] (auto & arm, double r) { return arm.far < r; });
    auto & piece = crack->Piece(arm.piece);
    // Newton's method for the point at distance r, which grows with the parameter
    double range = arm.t_far-arm.t_near, share = (r-arm.near)/(arm.far-arm.near);
    Point d, dx;
    for (int it = 0; it < 30; it++)
      {
        double t = arm.t_near + share*range;
        d = piece.Value(t)-tip;
        dx = piece.Derivative(t);
        double now = Norm(d), step = now > 0 ? (r-now)*now/(Dot(d, dx)*range) : r/reach;
        if (std::abs(step) < 1e-14) break;
        share = std::clamp(share+step, arm.near > 0 ? 0 : 1e-14, 1.0);
      }
    double sign = at_end ? -1 : 1, speed = Norm(dx);
    double k = sign*Cross(dx, piece.SecondDerivative(arm.t_near + share*range))/(speed*speed*speed);
    Point t = sign/speed * dx;
    double now = Norm(d);
    Point e = 1/now * d;
    double along = Dot(e, t), across = Cross(e, t);
    double slope = now < 1e-6*reach ? 0.5*curvature : across/(now*along);
    Point b = arm.lag ? Point(cos(arm.lag/now)*t - sin(arm.lag/now)*Left(t)) : t;
    return { { -Dot(e, ahead), -Dot(e, Left(ahead)), slope }, { -Dot(b, ahead), -Dot(b, Left(ahead)), k/along + arm.lag/(now*now) } };
  }
}
