#pragma once
// Points and weights on the parts of elements that a curved crack bounds, and on the curve itself. No polyline: the
// points lie on the right side of the curve, areas and lengths are exact to round-off, weights are positive.

#include "rules/cut_rule.hpp"

namespace ngsxfem_contact
{
  /// Gauss points of the cone x = A + ρ (γ(t) - A) over the curved side of a part, weights ρ |(γ - A) × γ'|.
  void AppendCone (const PartTriangle & part, int order, PointRule & rule);

  /// The rule for a curved part that meets the disk of a tip: in the coordinates of TipCurve where its curved side
  /// belongs to that tip's crack and the functions are not smooth at the scale of the part.
  void AppendConeNearTip (const PartTriangle & part, int order, const TipQuadrature & tip, PointRule & rule);

  /// Gauss on a curved stretch of Γ_C; in √r, and divided at the breaks and at break_distance from the tip, if tip != nullptr.
  void AppendCurve (const Crack & crack, const Chord & chord, int order, const TipQuadrature * tip, double break_distance, PointRule & rule);
}
