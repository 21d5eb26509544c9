#pragma once
// A division of Γ_C: where rules on it end and begin anew, beside the mesh edges and kinks.

#include <algorithm>
#include <compare>
#include <vector>

namespace ngsxfem_contact
{
  /// What divides Γ_C, such as a space of functions that are smooth between its points only, rules do not know.
  class CrackDivision
  {
  public:
    virtual ~CrackDivision () = default;
    /// Against a division of a body of the same dimension, by what it holds: equal ones share their rules.
    virtual std::partial_ordering Compare (const CrackDivision & other) const = 0;
  };

  /// In the plane: at arc lengths of each crack.
  class ArcLengths : public CrackDivision
  {
    std::vector<std::vector<double>> arclengths;
  public:
    /// One list for each crack, in any order; cracks without a list are not divided.
    ArcLengths (std::vector<std::vector<double>> aarclengths) : arclengths(std::move(aarclengths))
    { for (auto & some : arclengths) std::ranges::sort(some); }

    const std::vector<std::vector<double>> & All () const { return arclengths; }
    /// Of one crack, increasing.
    std::vector<double> On (size_t crack) const { return crack < arclengths.size() ? arclengths[crack] : std::vector<double>(); }
    std::partial_ordering Compare (const CrackDivision & other) const override
    { return arclengths <=> dynamic_cast<const ArcLengths&>(other).arclengths; }
  };
}
