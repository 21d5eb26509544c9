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

  /// 2μ √(2π) times the fields of unit K_I and K_II, ahead and to the left of the tip, for C and S of HalfAngle.
  template <int D, typename T>
  std::array<std::array<AutoDiff<D,T>,2>,2> PlaneModes (AutoDiff<D,T> C, AutoDiff<D,T> S, AutoDiff<D,T> r, double kappa)
  {
    AutoDiff<D,T> c2 = C*C/r, s2 = S*S/r;
    return { { { C*(kappa-1. + 2.*s2), S*(kappa+1. - 2.*c2) },
               { S*(kappa+1. + 2.*c2), -1.*C*(kappa-1. - 2.*s2) } } };
  }
}
