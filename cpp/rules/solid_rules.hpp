#pragma once
// The integration rules of a body in space: which elements need one of their own, and which rule that is.

#include "cut/cracked_solid.hpp"
#include "rules/measure_rules.hpp"
#include "rules/slice_rule.hpp"

namespace ngsxfem_contact
{
  /// Rules that serve both.
  std::optional<FrontDemand> Merged (std::optional<FrontDemand> a, const std::optional<FrontDemand> & b);

  /// For functions that are singular at the fronts, if somebody asks for that.
  class SolidRules final : public MeasureRules
  {
    shared_ptr<const CrackedSolid> body;
    std::optional<FrontDemand> demand;
    mutable std::map<std::tuple<RuleKind, VorB, int>, shared_ptr<const RuleTable>> tables;
    mutable std::mutex mutex;

  public:
    /// Throws for a demand that makes no sense.
    SolidRules (shared_ptr<const CrackedSolid> abody, std::optional<FrontDemand> ademand);
    const CrackedSolid & Body () const override { return *body; }
    const std::optional<FrontDemand> & Demand () const { return demand; }
    shared_ptr<const RuleTable> Table (const RuleKind & kind, VorB vb, int order) const override;
    shared_ptr<const MeasureRules> MergedWith (const MeasureRules & other) const override;
  };

  /// Who asks for equal ones while somebody keeps them gets the same.
  shared_ptr<const SolidRules> RulesOf (shared_ptr<const CrackedSolid> body, const std::optional<FrontDemand> & demand);
}
