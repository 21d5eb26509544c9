#pragma once
// The crack as seen from a tip: polar coordinates in which the curved crack lies on θ = ±π.
//
// At distance r behind the tip the crack lies at tip + r R(α(r)) (-ahead), R a rotation. Turning each circle around the tip
// by -α(r) makes the crack straight; this keeps r and areas, and is the identity where the crack is straight.
// Kinks of less than 5° are followed like curves: a short last piece that hardly turns leaves the functions their room.

#include "curve/crack.hpp"
#include <bla.hpp>

namespace ngsxfem_contact
{
  using ngcore::SIMD, ngcore::IfPos;

  class TipCurve
  {
    std::shared_ptr<const Crack> crack;      // nullptr: straight, or an arc
    bool at_end = true;
    Point tip, ahead;
    double curvature = 0;                    // α = curvature r/2 + ..., of an arc asin(curvature r/2)
    double reach;                            // where r stops to grow along the crack, or a kink comes
    double s_reach;                          // arc length from the tip to there
    /// Part of a piece along which the distance from the tip grows: distances and parameters of its ends.
    /// lag: Σ δ d over the kinks before it, of the turns δ at distances d.
    struct Arm { size_t piece; double near, far, t_near, t_far, lag; };
    std::vector<Arm> arms;

  public:
    /// A rotation: cos, sin and the derivative of its angle by r.
    template <typename T> struct Turn { T cos, sin, slope; };
    /// By α to the crack's point at distance r, and by β to its direction there: its tangent is R(β) (-ahead). At a kink β does not
    /// jump with the tangent, but follows it by δ (1 - d/r), as α does.
    template <typename T> struct Turns { Turn<T> point, direction; };

    /// The end of a crack: at_end = false: the first.
    TipCurve (const Crack & acrack, bool aat_end);

    Point Tip () const { return tip; }
    Point Ahead () const { return ahead; }
    double Reach () const { return reach; }
    /// Arc length between which and the tip the crack is on θ = ±π.
    double ReachLength () const { return s_reach; }
    bool IsStraight () const { return !crack && curvature == 0; }

    template <typename T>
    Turns<T> At (T r) const
    {
      if (!crack)
        {
          using std::sqrt;
          T largest(curvature ? 1.9/std::abs(curvature) : std::numeric_limits<double>::max());
          T sin = 0.5*curvature*IfPos(largest-r, r, largest), cos = sqrt(1.-sin*sin), slope = 0.5*curvature/cos;
          return { { cos, sin, slope }, { 1.-2.*sin*sin, 2.*sin*cos, 2.*slope } };       // β = 2 α
        }
      if constexpr (std::is_same_v<T, double>) return General(r);
      else
        {
          Turns<double> lanes[T::Size()];
          for (size_t k = 0; k < T::Size(); k++) lanes[k] = General(r[k]);
          auto gather = [&] (Turn<double> Turns<double>::* turn) -> Turn<T>
          {
            return { T([&] (int k) { return (lanes[k].*turn).cos; }), T([&] (int k) { return (lanes[k].*turn).sin; }),
                     T([&] (int k) { return (lanes[k].*turn).slope; }) };
          };
          return { gather(&Turns<double>::point), gather(&Turns<double>::direction) };
        }
    }

    /// The point of the crack at distance r from the tip, and ds/dr there.
    std::pair<Point, double> Behind (double r) const
    {
      auto [c, s, slope] = At(r).point;
      return { Point(tip - r*(c*ahead + s*Left(ahead))), std::hypot(1.0, r*slope) };
    }

    /// Where the largest curvature between here and the tip is half of 1/r, or its kinks turn by half: disks should end there.
    double CurvatureLimit () const;

  private:
    Turns<double> General (double r) const;
    double FromEnd (double distance) const { return at_end ? crack->Length()-distance : distance; }
    /// The last piece before a kink, or before the other end.
    size_t EndOfSmoothPart (const Crack & curve) const;
    bool SmoothPartIsStraight (const Crack & curve) const;
    void FindReach (const Crack & curve);
  };
}
