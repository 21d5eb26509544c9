#pragma once
// Integrals over the measures of a cracked mesh, and NGSolve's symbolic integrators with its rules on the elements that need them.

#include "forms/measure.hpp"

namespace ngsxfem_contact
{
  /// The rules of a measure for one integrator: looked up once for each order, then without a lock.
  class CachedRules
  {
    static constexpr int max_order = 40;

    Measure measure;
    VorB vb;
    mutable std::array<std::atomic<const RuleTable*>, max_order> tables {};
    mutable std::vector<shared_ptr<const RuleTable>> used;
    mutable std::mutex mutex;

  public:
    CachedRules (Measure ameasure, VorB avb) : measure(std::move(ameasure)), vb(avb) { }

    const ElementRule * Find (int order, size_t element) const;

  private:
    const RuleTable * LookUp (int order) const;
  };

  /// An integrator restricted as a measure is.
  template <typename INTEGRATOR>
  shared_ptr<INTEGRATOR> WithOptions (shared_ptr<INTEGRATOR> integrator, const ngfem::DifferentialSymbol & dx)
  {
    if (dx.definedon)
      if (auto regions = get_if<ngcore::BitArray>(&*dx.definedon)) integrator->SetDefinedOn(*regions);
    integrator->SetBonusIntegrationOrder(dx.bonus_intorder);
    if (dx.definedonelements) integrator->SetDefinedOnElements(dx.definedonelements);
    return integrator;
  }

  class CutIntegral : public ngfem::Integral
  {
  protected:
    Measure measure;
  public:
    CutIntegral (shared_ptr<CoefficientFunction> acf, const ngfem::DifferentialSymbol & adx, Measure ameasure)
      : Integral(acf, adx), measure(ameasure.With(*acf)) { }

    const Measure & GetMeasure () const { return measure; }
    double Integrate (const ngcomp::MeshAccess & ma, ngbla::FlatVector<double> element_wise) override;
    ngcore::Complex Integrate (const ngcomp::MeshAccess & ma, ngbla::FlatVector<ngcore::Complex> element_wise) override;
    shared_ptr<ngfem::BilinearFormIntegrator> MakeBilinearFormIntegrator () const override;
    shared_ptr<ngfem::LinearFormIntegrator> MakeLinearFormIntegrator () const override;
    shared_ptr<Integral> CreateSameIntegralType (shared_ptr<CoefficientFunction> acf) override
    { return make_shared<CutIntegral>(acf, dx, measure); }

  private:
    std::optional<ngcore::BitArray> DefinedOn (const ngcomp::MeshAccess & ma) const;
  };

  /// The integrals of a form as energies: their integrators vary them. NGSolve's own Variation would lose the rules.
  shared_ptr<ngfem::SumOfIntegrals> MakeVariation (const ngfem::SumOfIntegrals & form);

  /// The integrals of a form on some elements of the mesh and of its boundary.
  shared_ptr<ngfem::SumOfIntegrals> IntegralsOn (const ngfem::SumOfIntegrals & form, const ngcore::BitArray & elements, const ngcore::BitArray & boundary_elements);
  /// Those over the body and its cracks, without those over its boundary, on some elements.
  shared_ptr<ngfem::SumOfIntegrals> InnerIntegrals (const ngfem::SumOfIntegrals & form, const ngcore::BitArray & elements);
}
