#include "spaces/stress_power.hpp"

namespace ngsxfem_contact
{
  using namespace ngfem;

  void StressPowerIntegrator :: CalcElementMatrix (const FiniteElement & fel, const ElementTransformation & trafo, FlatMatrix<double> elmat, LocalHeap & lh) const
  {
    elmat = 0;
    bool symmetric = true;
    CalcElementMatrixAdd(fel, trafo, elmat, symmetric, lh);
  }

  void StressPowerIntegrator :: CalcElementMatrixAdd (const FiniteElement & bfel, const ElementTransformation & trafo, FlatMatrix<double> elmat,
                                                      bool &, LocalHeap & lh) const
  {
    constexpr size_t block = 64;                             // of points: rules near a tip have thousands
    auto & fel = static_cast<const CrackFiniteElement&>(bfel);
    int order = std::max(0, 2*fel.Order()-2+bonus_intorder);
    auto rule = rules.Find(order, trafo.GetElementNr());
    auto & ir = rule ? rule->simd_ir : SIMD_SelectIntegrationRule(fel.ElementType(), order);
    for (size_t first = 0; first < ir.Size(); first += block)
      {
        HeapReset hr(lh);
        AddPoints(fel, trafo(ir.Range(first, std::min(first+block, ir.Size())), lh), elmat, lh);
      }
  }

  void StressPowerIntegrator :: AddPoints (const CrackFiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir, FlatMatrix<double> elmat, LocalHeap & lh) const
  {
    size_t n = fel.NumScalar(), t = fel.NumTip(), points = mir.Size();
    FlatMatrix<SIMD<double>> scalar(n, 2*points, lh), tip(t, 4*points, lh);              // [∂_x | ∂_y]; [∂_x u_x | ∂_y u_x | ∂_x u_y | ∂_y u_y]
    gradient.CalcScalar(fel, mir, FlatMatrix<SIMD<double>>(2*n, points, scalar.Data()));
    gradient.CalcTips(fel, mir, FlatMatrix<SIMD<double>>(4*t, points, tip.Data()));

    // stresses times weights: [σ_xx | σ_xy | σ_xy | σ_yy], of φ e_x and φ e_y without the half that follows from the other
    FlatMatrix<SIMD<double>> moduli(2, points, lh), of_x(n, 2*points, lh), of_y(n, 2*points, lh), across(n, 2*points, lh), of_tip(t, 4*points, lh);
    lam->Evaluate(mir, moduli.Rows(0, 1));
    mu->Evaluate(mir, moduli.Rows(1, 2));
    for (size_t i = 0; i < points; i++)
      {
        SIMD<double> l = mir[i].GetWeight()*moduli(0, i), m = mir[i].GetWeight()*moduli(1, i), both = l + 2.*m;
        for (size_t j = 0; j < n; j++)
          {
            auto dx = scalar(j, i), dy = scalar(j, points+i);
            of_x(j, i) = both*dx;
            of_x(j, points+i) = m*dy;
            of_y(j, i) = m*dx;
            of_y(j, points+i) = both*dy;
            across(j, i) = l*dy;
            across(j, points+i) = m*dx;
          }
        for (size_t j = 0; j < t; j++)
          {
            auto xx = tip(j, i), yy = tip(j, 3*points+i), shear = m*(tip(j, points+i)+tip(j, 2*points+i));
            of_tip(j, i) = both*xx + l*yy;
            of_tip(j, points+i) = of_tip(j, 2*points+i) = shear;
            of_tip(j, 3*points+i) = l*xx + both*yy;
          }
      }

    AddABt(scalar, of_x, elmat.Rows(0, n).Cols(0, n));
    AddABt(scalar, of_y, elmat.Rows(n, 2*n).Cols(n, 2*n));
    FlatMatrix<double> mixed(n, n, lh), with_tip(n, 2*t, lh);
    mixed = 0;
    AddABt(scalar, across, mixed);
    elmat.Rows(0, n).Cols(n, 2*n) += mixed;
    elmat.Rows(n, 2*n).Cols(0, n) += Trans(mixed);
    if (t == 0) return;
    with_tip = 0;
    AddABt(scalar, FlatMatrix<SIMD<double>>(2*t, 2*points, of_tip.Data()), with_tip);
    for (size_t j = 0; j < t; j++)
      for (size_t k = 0; k < 2; k++)
        {
          elmat.Col(2*n+j).Range(k*n, (k+1)*n) += with_tip.Col(2*j+k);
          elmat.Row(2*n+j).Range(k*n, (k+1)*n) += with_tip.Col(2*j+k);
        }
    AddABt(tip, of_tip, elmat.Rows(2*n, 2*n+t).Cols(2*n, 2*n+t));
  }

  shared_ptr<BilinearFormIntegrator> MakeStressPower (const CrackFESpace & space, shared_ptr<CoefficientFunction> lam, shared_ptr<CoefficientFunction> mu,
                                                      const CutDifferentialSymbol & dx)
  {
    auto measure = dx.measure.With(space).With(*lam).With(*mu);
    return WithOptions<BilinearFormIntegrator>(make_shared<StressPowerIntegrator>(lam, mu, measure), dx);
  }
}
