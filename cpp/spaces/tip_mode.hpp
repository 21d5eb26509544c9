#pragma once
// The gradient of the field of unit K_I or K_II at a tip, a coefficient function: the auxiliary field of the interaction integral (docs/method.md, section 9).

#include "curve/crack.hpp"
#include <coefficient.hpp>

namespace ngsxfem_contact
{
  /// ∂_j u_i of a field that is singular at a tip. The cut is the crack, whichever way it bends: behind the tip θ has the sign of the side.
  class TipModeGradient : public ngfem::CoefficientFunctionNoDerivative
  {
    Crack crack;
    Point tip, ahead;
    int plus_sign, side;                          // the sign of θ on the plus side; ±1: the limit from a side, 0: by the position of the point
    int mode;                                     // 0, 1: K_I, K_II
    double kappa, mu;

  public:
    TipModeGradient (Crack acrack, Point atip, Point aahead, int aplus_sign, int aside, int amode, double akappa, double amu);
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::BaseMappedIntegrationPoint & ip, ngbla::FlatVector<> result) const override;
    void Evaluate (const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> values) const override;

  private:
    template <typename T> ngbla::Mat<2,2,T> At (T x, T y, T side_of_point) const;
    double SideOf (double x, double y) const { return side ? side : int(crack.SideOf(Point(x, y))); }
  };
}
