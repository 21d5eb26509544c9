#pragma once
// ∫ σ(u):ε(v) of an isotropic material on V_h. The vector functions of a scalar one share its gradient, so that products of gradients
// are taken once: in the plane a third of the work of a symbolic form, which knows a 4 × 4 tensor at each point only.

#include "forms/cut_integral.hpp"
#include "spaces/enriched_space.hpp"

namespace ngsxfem_contact
{
  /// ∫ λ div u div v + 2μ ε(u):ε(v), λ and μ functions of the place.
  template <int D>
  class StressPowerIntegrator : public ngfem::BilinearFormIntegrator
  {
    shared_ptr<CoefficientFunction> lam, mu;
    CachedRules rules;
    CrackDiffOp<D> gradient { 1, Trace::Position, VOL };

  public:
    StressPowerIntegrator (shared_ptr<CoefficientFunction> alam, shared_ptr<CoefficientFunction> amu, Measure measure)
      : lam(alam), mu(amu), rules(std::move(measure), VOL) { }

    string Name () const override { return "Stress power"; }
    VorB VB () const override { return VOL; }
    ngcore::xbool IsSymmetric () const override { return true; }
    void CalcElementMatrix (const FiniteElement & fel, const ngfem::ElementTransformation & trafo, ngbla::FlatMatrix<double> elmat, LocalHeap & lh) const override;
    void CalcElementMatrixAdd (const FiniteElement & fel, const ngfem::ElementTransformation & trafo, ngbla::FlatMatrix<double> elmat,
                               bool & symmetric_so_far, LocalHeap & lh) const override;

  private:
    void AddPoints (const CrackFiniteElement<D> & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::FlatMatrix<double> elmat, LocalHeap & lh) const;
  };

  /// For the element matrices of a form on the space.
  template <int D>
  shared_ptr<ngfem::BilinearFormIntegrator> MakeStressPower (const EnrichedSpace<D> & space, shared_ptr<CoefficientFunction> lam, shared_ptr<CoefficientFunction> mu,
                                                             const CutDifferentialSymbol & dx);
}
