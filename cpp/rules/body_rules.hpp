#pragma once
// The integration rules of a body: which elements need one of their own, and which rule that is.

#include "cut/cracked_mesh.hpp"
#include "rules/crack_division.hpp"
#include "rules/curved_rule.hpp"
#include <mutex>

namespace ngsxfem_contact
{
  /// What a measure integrates over: Ω∖Γ_C (and ∂Ω), the larger part of each element that a crack divides, or Γ_C.
  enum class Domain { Bulk, Larger, Crack };

  /// Which rules an integral needs. division: of those on Γ_C, if there is one. crack: on Γ_C and on the larger parts of one
  /// crack only.
  struct RuleKind
  {
    Domain domain = Domain::Bulk;
    shared_ptr<const CrackDivision> division;
    std::optional<size_t> crack;
    bool operator< (const RuleKind & other) const;
  };

  /// A rule in reference coordinates: weights times the element's measure give physical lengths and areas.
  struct ElementRule
  {
    ngfem::IntegrationRule ir;
    ngfem::SIMD_IntegrationRule simd_ir;
    ElementRule (ngfem::IntegrationRule && air) : ir(std::move(air)), simd_ir(ir) { }
  };

  /// The elements for which the standard rule is not right, and theirs.
  class RuleTable
  {
    std::vector<int> index;      // by element number; -1: the standard rule
    std::vector<std::unique_ptr<ElementRule>> rules;
    std::map<int, int> gauss;    // the one rule of an order, shared by its elements
  public:
    RuleTable (size_t n) : index(n, -1) { }
    void Add (size_t element, std::unique_ptr<ElementRule> rule)
    { index[element] = int(rules.size()); rules.push_back(std::move(rule)); }
    /// The standard rule of another order.
    void AddGauss (size_t element, int order);
    const ElementRule * Find (size_t element) const
    { return index[element] < 0 ? nullptr : rules[index[element]].get(); }
  };

  /// What the functions of a space ask for, by the number of the tip. Where several spaces meet in one integral, rules serve all of them.
  using TipDemands = std::map<size_t, TipDemand>;
  TipDemands Merged (TipDemands a, const TipDemands & b);

  /// The rules of a body for functions that are singular in some disks: made when they are first asked for, and kept.
  class BodyRules
  {
    shared_ptr<const CrackedMesh> body;
    TipDemands demands;
    std::vector<TipQuadrature> tips;
    BoxTree disks;               // the boxes of their disks
    mutable std::map<std::tuple<RuleKind, VorB, int>, shared_ptr<const RuleTable>> tables;
    mutable std::mutex mutex;

  public:
    BodyRules (shared_ptr<const CrackedMesh> abody, TipDemands ademands);
    const CrackedMesh & Body() const { return *body; }
    const TipDemands & Demands() const { return demands; }
    /// The table for rules of the given order.
    shared_ptr<const RuleTable> Table (const RuleKind & kind, VorB vb, int order) const;
  };

  /// The rules of a body for functions with these demands. Who asks for equal ones while somebody keeps them gets the same.
  shared_ptr<const BodyRules> RulesOf (shared_ptr<const CrackedMesh> body, const TipDemands & demands);

  /// How many sets of rules of a body, for different disks, somebody keeps.
  size_t NumKeptRules (const CrackedMesh & body);

  /// A space with functions that ask for rules of their own.
  class AsksForRules
  {
  public:
    virtual ~AsksForRules () = default;
    virtual const BodyRules & Rules () const = 0;
  };
}
