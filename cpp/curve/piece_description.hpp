#pragma once
// Pieces of cracks from the points that describe them.

#include "curve/curve_piece.hpp"

namespace ngsxfem_contact
{
  /// The pieces of a Description: "segment" by 2 points, "arc" by 3, "cubic" by 4, "ellipse" by its centre, the two vectors of its half axes and
  /// the parameters (t0, t1) of MakeEllipticArc. Throws for another one.
  std::vector<PiecePtr> MakePieces (const std::string & kind, const std::vector<Point> & points);
}
