#pragma once
// The ends of a crack and the boundary of the body: what leaves the body is cut off, an end that nearly reaches it reaches it.

#include "cut/body_boundary.hpp"
#include <string>

namespace ngsxfem_contact
{
  /// Relative to the element there: an end inside the body, nearer to ∂Ω than this, is a mouth. The mesh sees no thinner ligament.
  constexpr double least_end_distance = 0.1;

  /// The part of a crack in the body, with ends on ∂Ω where they nearly are; appends a sentence for each end that moved.
  /// Throws for a crack outside of the body, one that leaves it and comes back or touches ∂Ω on its way, and one that ends
  /// beside ∂Ω without running into it.
  Crack FittedToBody (const Crack & crack, size_t number, const BodyBoundary & boundary, std::vector<std::string> & notes);
}
