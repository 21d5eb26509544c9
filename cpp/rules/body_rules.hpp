#pragma once
// The integration rules of a plane body: which elements need one of their own, and which rule that is.

#include "cut/cracked_mesh.hpp"
#include "rules/curved_rule.hpp"
#include "rules/measure_rules.hpp"
#include <mutex>

namespace ngsxfem_contact
{
  /// What the functions of a space ask for, by the number of the tip. Where several spaces meet in one integral, rules serve all of them.
  using TipDemands = std::map<size_t, TipDemand>;
  TipDemands Merged (TipDemands a, const TipDemands & b);

  /// The rules of a body for functions that are singular in some disks: made when they are first asked for, and kept.
  class BodyRules final : public MeasureRules
  {
    shared_ptr<const CrackedMesh> body;
    TipDemands demands;
    std::vector<TipQuadrature> tips;
    BoxTree disks;               // the boxes of their disks
    mutable std::map<std::tuple<RuleKind, VorB, int>, shared_ptr<const RuleTable>> tables;
    mutable std::mutex mutex;

  public:
    BodyRules (shared_ptr<const CrackedMesh> abody, TipDemands ademands);
    const CrackedMesh & Body () const override { return *body; }
    const TipDemands & Demands() const { return demands; }
    shared_ptr<const RuleTable> Table (const RuleKind & kind, VorB vb, int order) const override;
    shared_ptr<const MeasureRules> MergedWith (const MeasureRules & other) const override;
  };

  /// The rules of a body for functions with these demands. Who asks for equal ones while somebody keeps them gets the same.
  shared_ptr<const BodyRules> RulesOf (shared_ptr<const CrackedMesh> body, const TipDemands & demands);

  /// How many sets of rules of a body, for different disks, somebody keeps.
  size_t NumKeptRules (const CrackedMesh & body);
}
