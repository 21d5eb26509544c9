#pragma once
// The measures body.dx, body.ds, body.dcrack: NGSolve's differential symbols, integrals and symbolic integrators with
// the rules of a cracked mesh on the elements that need them.

#include "rules/body_rules.hpp"
#include <integratorcf.hpp>
#include <variant>

namespace ngsxfem_contact
{
  using ngfem::CoefficientFunction;

  struct Measure
  {
    shared_ptr<const CrackedMesh> body;
    RuleKind kind;
    shared_ptr<const BodyRules> rules;

    Measure (shared_ptr<const CrackedMesh> abody, RuleKind akind) : body(abody), kind(std::move(akind)), rules(RulesOf(body, {})) { }

    shared_ptr<const RuleTable> Rules (VorB vb, int order) const { return rules->Table(kind, vb, order); }
    /// With rules for the functions of a space, too, if it is one on this body.
    Measure With (const ngcomp::FESpace & space) const;
    /// With rules for the functions of all spaces whose functions or test functions are part of an integrand.
    Measure With (CoefficientFunction & integrand) const;
  };

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

  /// To what a measure is restricted, and for what its rules are made.
  struct Restriction
  {
    std::optional<std::variant<ngcomp::Region, string>> definedon;          // materials or boundaries, or a regular expression for their names
    int bonus_intorder = 0;
    shared_ptr<ngcore::BitArray> definedonelements;
    std::optional<size_t> crack;
    std::optional<std::vector<std::vector<double>>> nodes;                  // arc lengths at which rules on Γ_C are divided
    shared_ptr<ngcomp::FESpace> space;                                      // whose functions the rules serve, too
  };

  class CutDifferentialSymbol : public ngfem::DifferentialSymbol
  {
  public:
    Measure measure;
    CutDifferentialSymbol (Measure ameasure, VorB avb) : DifferentialSymbol(avb), measure(std::move(ameasure)) { }
    /// On Γ_C, or on the larger parts beside it: on the elements that cracks meet.
    static CutDifferentialSymbol OnCracks (shared_ptr<const CrackedMesh> body, RuleKind kind);
    /// Throws for regions that the mesh does not have, or that are of another dimension.
    CutDifferentialSymbol Restricted (const Restriction & to) const;
    /// With rules for the functions of a space, if there is one.
    CutDifferentialSymbol For (const shared_ptr<ngcomp::FESpace> & space) const;
    shared_ptr<ngfem::Integral> MakeIntegral (shared_ptr<CoefficientFunction> cf) const override;
  };

  /// The points of a measure, element by element: reference coordinates, physical weights and places.
  struct MeasurePoints { std::vector<size_t> element; std::vector<double> xi, eta, weight, x, y; };
  MeasurePoints RulePoints (const CutDifferentialSymbol & symbol, int order);

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

  /// The integrals of a form over the body and its cracks, without those over its boundary, on some elements.
  shared_ptr<ngfem::SumOfIntegrals> InnerIntegrals (const ngfem::SumOfIntegrals & form, const ngcore::BitArray & elements);
}
