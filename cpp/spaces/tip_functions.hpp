#pragma once
// The singular functions at one tip, times the cut-off χ: (8) of [AHLMR12], or the modes of docs/method.md, section 3.

#include "cut/disk.hpp"
#include "curve/tip_curve.hpp"
#include "spaces/plane_modes.hpp"

namespace ngsxfem_contact
{
  enum class CutOff { Cubic = 1, Quintic, Septic };   // the continuous derivatives of χ
  enum class TipBasis { Branch, Modes };          // the 4 functions (8) for each component; vector fields of Williams' expansion

  struct TipSpec
  {
    TipBasis basis = TipBasis::Branch;
    CutOff cutoff = CutOff::Quintic;
    double r0 = 0, r1 = 0;                        // χ = 1 for r ≤ r0, 0 for r ≥ r1
    double kappa = 0, mu = 1;                     // of the material at the tip; modes only
    int order = 1;                                // r^{½}, ..., r^{order-½}; modes only
  };

  class TipFunctions
  {
    size_t crack;
    TipCurve curve;                               // the crack lies on θ = ±π
    Point tip, ahead, left;                       // the tip's frame
    int plus_sign;                                // the sign of θ on the crack's plus side
    TipSpec spec;

  public:
    static constexpr int max_functions = 8, max_order = max_functions/2;

    TipFunctions (size_t acrack, TipCurve acurve, int aplus_sign, TipSpec aspec)
      : crack(acrack), curve(std::move(acurve)), tip(curve.Tip()), ahead(curve.Ahead()), left(Left(ahead)), plus_sign(aplus_sign), spec(aspec) { }

    size_t Crack() const { return crack; }
    const TipSpec & Spec() const { return spec; }
    /// Outside of it they vanish.
    ngsxfem_contact::Disk Disk() const { return { tip, spec.r1 }; }
    int Size() const { return spec.basis == TipBasis::Modes ? 2*spec.order : 8; }

    /// χ F_j as vector fields with their gradients at p; T is double or SIMD<double>.
    /// side = 0: by the position of p; ±1: the limit on Γ_C from the plus or the minus side, p on Γ_C.
    /// The modes come in pairs I, II, r^{½} first. They are scaled so that the first coefficients are K_I and K_II, and those of (r/r1)^{m-1} √r have their unit.
    template <typename T>
    void Evaluate (Vec<2,T> p, int side, Vec<2,AutoDiff<2,T>> * values) const
    {
      auto [chi, C, S, R, y] = At(p, side);
      if (spec.basis == TipBasis::Modes)
        EvaluateModes(chi, C, S, R, values);
      else
        EvaluateBranch(chi, C, S, y/R, R, values);
    }

    /// The same without gradients: inlined, so that they are not computed.
    template <typename T>
    [[gnu::flatten]] void Evaluate (Vec<2,T> p, int side, Vec<2,T> * values) const
    {
      Vec<2,AutoDiff<2,T>> fields[max_functions];
      Evaluate(p, side, fields);
      for (int m = 0; m < Size(); m++) values[m] = Vec<2,T> { fields[m](0).Value(), fields[m](1).Value() };
    }

    /// χ div of the modes as if the crack were straight, of the order of 1/λ_L. 0 for the functions (8).
    std::array<double,max_functions> SingularDivergence (Point p, int side) const
    {
      std::array<double,max_functions> values { };
      if (spec.basis == TipBasis::Branch) return values;
      auto [chi, C, S, R, y] = At<double>(p, side);
      double scale = (spec.kappa-1) / (2*spec.mu*sqrt(2*M_PI)) * chi.Value();
      WilliamsModes modes(C, S, R);
      for (int m = 0; m < Size(); m += 2)
        {
          if (m) modes.Next(spec.r1);
          auto divergence = modes.Divergence();
          for (int k = 0; k < 2; k++) values[m+k] = scale*divergence[k].Value();
        }
      return values;
    }

  private:
    template <typename T>
    struct Local { AutoDiff<2,T> chi, C, S, R, y; };       // χ, √r cos(θ/2), √r sin(θ/2), r, r sin θ

    template <typename T>
    Local<T> At (Vec<2,T> p, int side) const
    {
      Vec<2,T> d { p(0)-tip(0), p(1)-tip(1) };
      AutoDiff<2,T> x = Coordinate(d, ahead), y = Coordinate(d, left);
      // finite at the tip itself, and harmless if a point of a rule is rounded onto it
      double smallest_r2 = 1e-32*spec.r1*spec.r1;
      T r = sqrt(x.Value()*x.Value() + y.Value()*y.Value() + smallest_r2);
      AutoDiff<2,T> R(r);
      for (int i = 0; i < 2; i++)
        R.DValue(i) = (x.Value()*x.DValue(i) + y.Value()*y.DValue(i)) / r;
      if (!curve.IsStraight()) Straighten(R, x, y);
      if (side) y.Value() = T(0.);                // Γ_C is straight in these coordinates
      auto [C, S] = HalfAngle(x, y, r, side*plus_sign);
      return { Chi(R), C, S, R, y };
    }

    template <typename T>
    AutoDiff<2,T> Chi (AutoDiff<2,T> r) const
    {
      auto rho = (1./(spec.r1-spec.r0)) * (r - AutoDiff<2,T>(T(spec.r0)));
      auto poly = spec.cutoff == CutOff::Cubic ? 1. - rho*rho*(3. - 2.*rho)
        : spec.cutoff == CutOff::Quintic ? 1. - rho*rho*rho*(10. - 15.*rho + 6.*rho*rho)
        : 1. - rho*rho*rho*rho*(35. - 84.*rho + 70.*rho*rho - 20.*rho*rho*rho);
      AutoDiff<2,T> chi;
      auto select = [&] (T value, T inside) { return IfPos(r.Value()-spec.r1, T(0.), IfPos(T(spec.r0)-r.Value(), inside, value)); };
      chi.Value() = select(poly.Value(), T(1.));
      for (int i = 0; i < 2; i++)
        chi.DValue(i) = select(poly.DValue(i), T(0.));
      return chi;
    }

    template <typename T>
    static AutoDiff<2,T> Coordinate (Vec<2,T> d, Point axis)
    {
      AutoDiff<2,T> c(d(0)*axis(0) + d(1)*axis(1));
      c.DValue(0) = T(axis(0));
      c.DValue(1) = T(axis(1));
      return c;
    }

    /// The coordinates turned by -α(r): those of TipCurve, in which the crack is straight.
    template <typename T>
    void Straighten (AutoDiff<2,T> r, AutoDiff<2,T> & x, AutoDiff<2,T> & y) const
    {
      auto turn = curve.At(r.Value()).point;
      AutoDiff<2,T> u, v;
      u.Value() = turn.cos*x.Value() + turn.sin*y.Value();
      v.Value() = turn.cos*y.Value() - turn.sin*x.Value();
      for (int i = 0; i < 2; i++)
        {
          u.DValue(i) = turn.cos*x.DValue(i) + turn.sin*y.DValue(i) + turn.slope*v.Value()*r.DValue(i);
          v.DValue(i) = turn.cos*y.DValue(i) - turn.sin*x.DValue(i) - turn.slope*u.Value()*r.DValue(i);
        }
      x = u;
      y = v;
    }

    /// Turned by the angle β of the crack's direction at distance r: normal and tangential jumps stay so all along.
    template <typename T>
    void TurnFrame (AutoDiff<2,T> r, std::array<AutoDiff<2,T>,2> & field) const
    {
      auto turn = curve.At(r.Value()).direction;
      AutoDiff<2,T> c(turn.cos), s(turn.sin);
      for (int i = 0; i < 2; i++)
        {
          c.DValue(i) = -turn.sin*turn.slope*r.DValue(i);
          s.DValue(i) = turn.cos*turn.slope*r.DValue(i);
        }
      field = { c*field[0] - s*field[1], s*field[0] + c*field[1] };
    }

    /// The 4 functions of (8), each in the x and in the y component: 8 vector fields, turned with the crack.
    template <typename T>
    void EvaluateBranch (AutoDiff<2,T> chi, AutoDiff<2,T> C, AutoDiff<2,T> S, AutoDiff<2,T> sine, AutoDiff<2,T> r, Vec<2,AutoDiff<2,T>> * values) const
    {
      std::array<AutoDiff<2,T>,4> F { chi*S, chi*C, chi*S*sine, chi*C*sine };
      for (int j = 0; j < 4; j++)
        for (int k = 0; k < 2; k++)
          {
            std::array<AutoDiff<2,T>,2> field { AutoDiff<2,T>(T(0.)), AutoDiff<2,T>(T(0.)) };
            field[k] = F[j];
            if (!curve.IsStraight()) TurnFrame(r, field);
            for (int i = 0; i < 2; i++) values[2*j+k](i) = field[i];
          }
    }

    template <typename T>
    void EvaluateModes (AutoDiff<2,T> chi, AutoDiff<2,T> C, AutoDiff<2,T> S, AutoDiff<2,T> r, Vec<2,AutoDiff<2,T>> * values) const
    {
      auto factor = 1. / (2*spec.mu*sqrt(2*M_PI)) * chi;
      WilliamsModes modes(C, S, r);
      for (int m = 0; m < spec.order; m++)
        {
          if (m) modes.Next(spec.r1);
          for (auto & field : modes.Fields(spec.kappa))
            {
              if (!curve.IsStraight()) TurnFrame(r, field);
              for (int k = 0; k < 2; k++) (*values)(k) = factor * (ahead(k)*field[0] + left(k)*field[1]);
              values++;
            }
        }
    }
  };
}
