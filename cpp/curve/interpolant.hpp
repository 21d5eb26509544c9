#pragma once
// A curve that is known by its points, as a polynomial.

#include "curve/curve_piece.hpp"
#include <functional>

namespace ngsxfem_contact
{
  /// The polynomial that agrees with an analytic curve, t from 0 to end, to round-off. Throws where there is none.
  PiecePtr MakeInterpolant (const std::function<Point(double)> & curve, double end);
}
