#include "spaces/stress_power.hpp"

namespace ngsxfem_contact
{
  using namespace ngfem;

  template <int D>
  void StressPowerIntegrator<D> :: CalcElementMatrix (const FiniteElement & fel, const ElementTransformation & trafo, FlatMatrix<double> elmat, LocalHeap & lh) const
  {
    elmat = 0;
    bool symmetric = true;
    CalcElementMatrixAdd(fel, trafo, elmat, symmetric, lh);
  }

  template <int D>
  void StressPowerIntegrator<D> :: CalcElementMatrixAdd (const FiniteElement & bfel, const ElementTransformation & trafo, FlatMatrix<double> elmat,
                                                      bool &, LocalHeap & lh) const
  {
    constexpr size_t block = 64;                             // of points: rules near a tip have thousands
    auto & fel = static_cast<const CrackFiniteElement<D>&>(bfel);
    int order = std::max(0, 2*fel.Order()-2+bonus_intorder);
    auto rule = rules.Find(order, trafo.GetElementNr());
    auto & ir = rule ? rule->simd_ir : SIMD_SelectIntegrationRule(fel.ElementType(), order);
    for (size_t first = 0; first < ir.Size(); first += block)
      {
        HeapReset hr(lh);
        AddPoints(fel, trafo(ir.Range(first, std::min(first+block, ir.Size())), lh), elmat, lh);
      }
  }

  template <int D>
  void StressPowerIntegrator<D> :: AddPoints (const CrackFiniteElement<D> & fel, const SIMD_BaseMappedIntegrationRule & mir, FlatMatrix<double> elmat, LocalHeap & lh) const
  {
    size_t n = fel.NumScalar(), t = fel.NumSingular(), points = mir.Size();
    FlatMatrix<SIMD<double>> scalar(n, D*points, lh), singular(t, D*D*points, lh);         // [∂_1 | ∂_2 | ...]; [∂_1 u_1 | ∂_2 u_1 | ...]
    gradient.CalcScalar(fel, mir, FlatMatrix<SIMD<double>>(D*n, points, scalar.Data()));
    gradient.CalcSingular(fel, mir, FlatMatrix<SIMD<double>>(D*D*t, points, singular.Data()));
    FlatMatrix<SIMD<double>> moduli(2, points, lh);                                       // times weights
    lam->Evaluate(mir, moduli.Rows(0, 1));
    mu->Evaluate(mir, moduli.Rows(1, 2));
    for (size_t i = 0; i < points; i++) moduli.Col(i) *= mir[i].GetWeight();

    // rows k of the stresses of φ e_l, without the half that follows from the other
    FlatMatrix<SIMD<double>> stress(n, D*points, lh);
    FlatMatrix<double> mixed(n, n, lh);
    for (size_t k = 0; k < D; k++)
      for (size_t l = k; l < D; l++)
        {
          for (size_t i = 0; i < points; i++)
            for (size_t j = 0; j < n; j++)
              for (size_t a = 0; a < D; a++)
                {
                  auto & value = stress(j, a*points+i);
                  value = a == l ? moduli(1, i)*scalar(j, k*points+i) : SIMD<double>(0.);
                  if (a == k) value += moduli(0, i)*scalar(j, l*points+i);
                  if (k == l) value += moduli(1, i)*scalar(j, a*points+i);
                }
          if (k == l)
            {
              AddABt(scalar, stress, elmat.Rows(k*n, (k+1)*n).Cols(k*n, (k+1)*n));
              continue;
            }
          mixed = 0;
          AddABt(scalar, stress, mixed);
          elmat.Rows(k*n, (k+1)*n).Cols(l*n, (l+1)*n) += mixed;
          elmat.Rows(l*n, (l+1)*n).Cols(k*n, (k+1)*n) += Trans(mixed);
        }
    if (t == 0) return;

    FlatMatrix<SIMD<double>> of_singular(t, D*D*points, lh);
    for (size_t i = 0; i < points; i++)
      for (size_t j = 0; j < t; j++)
        {
          auto at = [&] (size_t k, size_t l) -> SIMD<double> & { return singular(j, (k*D+l)*points+i); };
          SIMD<double> pressure(0.);
          for (size_t k = 0; k < D; k++) pressure += moduli(0, i)*at(k, k);
          for (size_t k = 0; k < D; k++)
            for (size_t l = 0; l < D; l++)
              of_singular(j, (k*D+l)*points+i) = moduli(1, i)*(at(k, l)+at(l, k)) + (k == l ? pressure : SIMD<double>(0.));
        }
    FlatMatrix<double> with_singular(n, D*t, lh);
    with_singular = 0;
    AddABt(scalar, FlatMatrix<SIMD<double>>(D*t, D*points, of_singular.Data()), with_singular);
    for (size_t j = 0; j < t; j++)
      for (size_t k = 0; k < D; k++)
        {
          elmat.Col(D*n+j).Range(k*n, (k+1)*n) += with_singular.Col(D*j+k);
          elmat.Row(D*n+j).Range(k*n, (k+1)*n) += with_singular.Col(D*j+k);
        }
    AddABt(singular, of_singular, elmat.Rows(D*n, D*n+t).Cols(D*n, D*n+t));
  }

  template <int D>
  shared_ptr<BilinearFormIntegrator> MakeStressPower (const EnrichedSpace<D> & space, shared_ptr<CoefficientFunction> lam, shared_ptr<CoefficientFunction> mu,
                                                      const CutDifferentialSymbol & dx)
  {
    auto measure = dx.measure.With(space).With(*lam).With(*mu);
    return WithOptions<BilinearFormIntegrator>(make_shared<StressPowerIntegrator<D>>(lam, mu, measure), dx);
  }

  template shared_ptr<BilinearFormIntegrator> MakeStressPower (const EnrichedSpace<2> &, shared_ptr<CoefficientFunction>, shared_ptr<CoefficientFunction>, const CutDifferentialSymbol &);
  template shared_ptr<BilinearFormIntegrator> MakeStressPower (const EnrichedSpace<3> &, shared_ptr<CoefficientFunction>, shared_ptr<CoefficientFunction>, const CutDifferentialSymbol &);
}
