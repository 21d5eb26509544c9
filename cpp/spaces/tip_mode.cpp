#include "spaces/tip_mode.hpp"
#include "spaces/plane_modes.hpp"

namespace ngsxfem_contact
{
  using namespace ngfem;

  TipModeGradient :: TipModeGradient (Crack acrack, Point atip, Point aahead, int aplus_sign, int aside, int amode, double akappa, double amu)
    : CoefficientFunctionNoDerivative(4), crack(std::move(acrack)), tip(atip), ahead(aahead), plus_sign(aplus_sign), side(aside), mode(amode), kappa(akappa), mu(amu)
  { SetDimensions(Array<int>({ 2, 2 })); }

  template <typename T>
  Mat<2,2,T> TipModeGradient :: At (T x, T y, T side_of_point) const
  {
    Point left = Left(ahead);
    T dx = x-tip(0), dy = y-tip(1);
    AutoDiff<2,T> X(ahead(0)*dx + ahead(1)*dy, 0), Y(left(0)*dx + left(1)*dy, 1), R;
    R.Value() = sqrt(X.Value()*X.Value() + Y.Value()*Y.Value() + 1e-200);
    R.DValue(0) = X.Value()/R.Value();
    R.DValue(1) = Y.Value()/R.Value();
    T one(1.), above = IfPos(-Y.Value(), -one, one);
    auto [C, S] = HalfAngle(X, Y, R.Value(), above, double(plus_sign)*side_of_point);
    auto field = WilliamsModes(C, S, R).Fields(kappa)[mode];
    Mat<2,2,T> gradient;
    double scale = 1/(2*mu*sqrt(2*M_PI));
    for (int i = 0; i < 2; i++)
      for (int j = 0; j < 2; j++)
        {
          AutoDiff<2,T> u = ahead(i)*field[0] + left(i)*field[1];
          gradient(i, j) = scale*(ahead(j)*u.DValue(0) + left(j)*u.DValue(1));
        }
    return gradient;
  }

  double TipModeGradient :: Evaluate (const BaseMappedIntegrationPoint &) const
  { throw ngcore::Exception("TipModeGradient is a 2 x 2 matrix; take an entry"); }

  void TipModeGradient :: Evaluate (const BaseMappedIntegrationPoint & ip, FlatVector<> result) const
  {
    auto x = ip.GetPoint();
    auto gradient = At(x(0), x(1), SideOf(x(0), x(1)));
    for (int k = 0; k < 4; k++) result(k) = gradient(k/2, k%2);
  }

  void TipModeGradient :: Evaluate (const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> values) const
  {
    auto x = mir.GetPoints();
    for (size_t i = 0; i < mir.Size(); i++)
      {
        SIMD<double> of_points([&] (int lane) { return SideOf(x(i,0)[lane], x(i,1)[lane]); });
        auto gradient = At(SIMD<double>(x(i,0)), SIMD<double>(x(i,1)), of_points);
        for (int k = 0; k < 4; k++) values(k, i) = gradient(k/2, k%2);
      }
  }
}
