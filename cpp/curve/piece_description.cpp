#include "curve/piece_description.hpp"
#include "curve/elliptic_arc.hpp"
#include <core/exception.hpp>

namespace ngsxfem_contact
{
  std::vector<PiecePtr> MakePieces (const std::string & kind, const std::vector<Point> & p)
  {
    if (kind == "segment" && p.size() == 2) return { MakeSegment(p[0], p[1]) };
    if (kind == "arc" && p.size() == 3) return { MakeArc(p[0], p[1], p[2]) };
    if (kind == "cubic" && p.size() == 4) return MakeCubic(p[0], p[1], p[2], p[3]);
    if (kind == "ellipse" && p.size() == 4) return MakeEllipticArc(p[0], p[1], p[2], p[3](0), p[3](1));
    throw ngcore::Exception("Crack: a piece is ('segment', [a, b]), ('arc', [start, through, end]), ('cubic', [p0, d0, p1, d1]) or ('ellipse', [centre, a, b, (t0, t1)]), got '"
                            + kind + "' with " + std::to_string(p.size()) + " points");
  }
}
