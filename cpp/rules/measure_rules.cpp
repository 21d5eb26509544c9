#include "rules/measure_rules.hpp"

namespace ngsxfem_contact
{
  void RuleTable :: AddGauss (size_t element, int order)
  {
    auto [it, is_new] = gauss.insert({ order, int(rules.size()) });
    if (is_new) rules.push_back(std::make_unique<ElementRule>(ngfem::SelectIntegrationRule(type, order).Copy()));
    index[element] = it->second;
  }

  bool RuleKind :: operator< (const RuleKind & other) const
  {
    auto rest = [] (const RuleKind & kind) { return std::tuple(kind.domain, kind.crack, bool(kind.division)); };
    if (rest(*this) != rest(other) || !division) return rest(*this) < rest(other);
    return division->Compare(*other.division) < 0;
  }
}
