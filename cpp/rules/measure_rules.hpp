#pragma once
// What a measure integrates over, and the rules that it needs, of a body of any dimension.

#include "cut/cut_geometry.hpp"
#include "rules/crack_division.hpp"
#include <map>
#include <mutex>
#include <fem.hpp>

namespace ngsxfem_contact
{
  using ngfem::VorB, ngfem::VOL, ngfem::BND;

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
    ngfem::ELEMENT_TYPE type;
    std::vector<int> index;      // by element number; -1: the standard rule
    std::vector<std::unique_ptr<ElementRule>> rules;
    std::map<int, int> gauss;    // the one rule of an order, shared by its elements
  public:
    RuleTable (ngfem::ELEMENT_TYPE atype, size_t n) : type(atype), index(n, -1) { }
    void Add (size_t element, std::unique_ptr<ElementRule> rule)
    { index[element] = int(rules.size()); rules.push_back(std::move(rule)); }
    /// The standard rule of another order.
    void AddGauss (size_t element, int order);
    const ElementRule * Find (size_t element) const
    { return index[element] < 0 ? nullptr : rules[index[element]].get(); }
  };

  /// The rules of a body for functions that are singular at some of its tips or fronts.
  class MeasureRules
  {
  public:
    virtual ~MeasureRules () = default;
    virtual const CrackedBody & Body () const = 0;
    /// The table for rules of the given order.
    virtual shared_ptr<const RuleTable> Table (const RuleKind & kind, VorB vb, int order) const = 0;
    /// Those that serve the functions of other rules of the same body, too.
    virtual shared_ptr<const MeasureRules> MergedWith (const MeasureRules & other) const = 0;
  };

  /// A space with functions that ask for rules of their own.
  class AsksForRules
  {
  public:
    virtual ~AsksForRules () = default;
    virtual const MeasureRules & Rules () const = 0;
  };

  /// The rules of bodies that somebody uses: who asks for equal ones gets the same.
  template <typename BODY, typename DEMANDS, typename RULES>
  class KeptRules
  {
    std::mutex mutex;
    std::map<std::pair<const BODY*, DEMANDS>, std::weak_ptr<const RULES>> known;

  public:
    shared_ptr<const RULES> Find (shared_ptr<const BODY> body, const DEMANDS & demands)
    {
      std::lock_guard guard(mutex);
      Forget();
      auto & kept = known[{ body.get(), demands }];
      auto rules = kept.lock();
      if (!rules) kept = rules = make_shared<RULES>(body, demands);
      return rules;
    }

    size_t Count (const BODY & body)
    {
      std::lock_guard guard(mutex);
      Forget();
      return std::ranges::count_if(known, [&] (auto & item) { return item.first.first == &body; });
    }

  private:
    void Forget () { std::erase_if(known, [] (auto & item) { return item.second.expired(); }); }
  };
}
