#pragma once
// The modes I and II at a tip, or in the plane normal to a front, and the functions of θ/2 that all modes are made of (docs/method.md, section 3).

#include <fem.hpp>

namespace ngsxfem_contact
{
  using ngfem::AutoDiff;
  using ngcore::SIMD, ngcore::IfPos;

  /// √r cos(θ/2), √r sin(θ/2) and their gradients: √r cos(θ/2) = √((r+x)/2), no digits lost where x < 0.
  /// ahead, behind: the sign of θ where x > 0 and where x < 0; where they differ from that of y and from each other the cut bends, and θ goes beyond ±π.
  template <int D, typename T>
  std::pair<AutoDiff<D,T>, AutoDiff<D,T>> HalfAngle (AutoDiff<D,T> x, AutoDiff<D,T> y, T r, T ahead, T behind)
  {
    T absx = IfPos(x.Value(), x.Value(), -x.Value()), absy = IfPos(y.Value(), y.Value(), -y.Value());
    T large = sqrt(0.5*(r+absx)), small = 0.5*absy/large;
    AutoDiff<D,T> C, S;
    C.Value() = IfPos(x.Value(), large, ahead*behind*small);
    S.Value() = IfPos(x.Value(), ahead*small, behind*large);
    T half_r = 0.5/r;
    for (int i = 0; i < D; i++)
      {
        C.DValue(i) = half_r * (C.Value()*x.DValue(i) + S.Value()*y.DValue(i));
        S.DValue(i) = half_r * (C.Value()*y.DValue(i) - S.Value()*x.DValue(i));
      }
    return { C, S };
  }

  /// The same along a cut on θ = ±π. forced: the sign of θ, 0: that of y.
  template <int D, typename T>
  std::pair<AutoDiff<D,T>, AutoDiff<D,T>> HalfAngle (AutoDiff<D,T> x, AutoDiff<D,T> y, T r, int forced)
  {
    T one(1.), sign = forced ? T(double(forced)) : IfPos(y.Value(), one, IfPos(-y.Value(), -one, one));
    return HalfAngle(x, y, r, sign, sign);
  }

  /// Williams' expansion at a tip whose lips are free of traction, its terms r^{m-½}, m = 1, 2, ..., one after the other. Of C and S of HalfAngle.
  template <int D, typename T>
  class WilliamsModes
  {
    using Field = AutoDiff<D,T>;
    struct Complex { Field re, im; };
    double exponent = 0.5;                        // λ = m-½
    Complex z, power, before;                     // x+iy, z^λ and z^{λ-1}

    static Complex Times (const Complex & a, const Complex & b) { return { a.re*b.re - a.im*b.im, a.re*b.im + a.im*b.re }; }

  public:
    WilliamsModes (Field C, Field S, Field r) : z { C*C - S*S, 2.*C*S }, power { C, S }, before { C/r, -1.*S/r } { }

    /// The next term, divided by a length: units stay the same.
    void Next (double length)
    {
      exponent += 1;
      before = { 1/length*power.re, 1/length*power.im };
      power = Times(z, before);
    }

    /// 2μ √(2π) times the fields I and II, ahead and to the left of the tip: κ φ - z φ'* - ψ* with φ = z^λ and -i z^λ. For m = 1 those of unit K_I and K_II.
    std::array<std::array<Field,2>,2> Fields (double kappa) const
    {
      Complex other = Times(z, { exponent*before.re, -exponent*before.im });
      return { { { (kappa-1.+exponent)*power.re - other.re, (kappa+1.-exponent)*power.im - other.im },
                 { (kappa+1.+exponent)*power.im + other.im, (1.+exponent-kappa)*power.re - other.re } } };
    }

    /// 2μ √(2π) / (κ-1) times their divergence.
    std::array<Field,2> Divergence () const { return { 2*exponent*before.re, 2*exponent*before.im }; }
  };
}
