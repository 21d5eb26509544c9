#pragma once
// Arcs of ellipses.

#include "curve/curve_piece.hpp"

namespace ngsxfem_contact
{
  /// centre + cos(t) a + sin(t) b, t from t0 to t1, as one piece or several. a and b need not be perpendicular.
  /// Throws for vectors that are parallel, or nearly so: the ratio of the half axes is limited to 1000.
  std::vector<PiecePtr> MakeEllipticArc (Point centre, Point a, Point b, double t0, double t1);
}
