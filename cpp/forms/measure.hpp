#pragma once
// The measures body.dx, body.ds, body.dlarger, body.dcrack: NGSolve's differential symbols with the rules of a cracked mesh.

#include "rules/body_rules.hpp"
#include "rules/solid_rules.hpp"
#include <integratorcf.hpp>
#include <variant>

namespace ngsxfem_contact
{
  using ngfem::CoefficientFunction;

  struct Measure
  {
    shared_ptr<const CrackedBody> body;
    RuleKind kind;
    shared_ptr<const MeasureRules> rules;

    Measure (shared_ptr<const CrackedMesh> abody, RuleKind akind) : body(abody), kind(std::move(akind)), rules(RulesOf(abody, {})) { }
    Measure (shared_ptr<const CrackedSolid> abody, RuleKind akind, std::optional<FrontDemand> demand = std::nullopt)
      : body(abody), kind(std::move(akind)), rules(RulesOf(abody, demand)) { }

    shared_ptr<const RuleTable> Rules (VorB vb, int order) const { return rules->Table(kind, vb, order); }
    /// With rules for the functions of a space, too, if it is one on this body.
    Measure With (const ngcomp::FESpace & space) const;
    /// With rules for the functions of all spaces whose functions or test functions are part of an integrand.
    Measure With (CoefficientFunction & integrand) const;
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
    std::optional<FrontDemand> fronts;                                      // of functions that are singular at the fronts of a solid
  };

  class CutDifferentialSymbol : public ngfem::DifferentialSymbol
  {
  public:
    Measure measure;
    CutDifferentialSymbol (Measure ameasure, VorB avb) : DifferentialSymbol(avb), measure(std::move(ameasure)) { }
    /// On Γ_C, or on the larger parts beside it: on the elements that cracks meet.
    static CutDifferentialSymbol OnCracks (Measure measure);
    /// Throws for regions that the mesh does not have, or that are of another dimension.
    CutDifferentialSymbol Restricted (const Restriction & to) const;
    /// With rules for the functions of a space, if there is one.
    CutDifferentialSymbol For (const shared_ptr<ngcomp::FESpace> & space) const;
    shared_ptr<ngfem::Integral> MakeIntegral (shared_ptr<CoefficientFunction> cf) const override;
  };

  /// NGSolve evaluates functions on the stack, and a rule may have 1e5 points: so many of them at a time, and bytes for that.
  constexpr size_t points_at_once = 2000, heap_for_points = 30000000;

  /// The points of a measure, element by element: physical weights, and by dimension of the body reference coordinates and places.
  struct MeasurePoints { std::vector<size_t> element; std::vector<double> weight; std::vector<std::vector<double>> reference, place; };
  MeasurePoints RulePoints (const CutDifferentialSymbol & symbol, int order);
}
