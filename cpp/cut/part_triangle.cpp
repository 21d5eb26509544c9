#include "cut/part_triangle.hpp"
#include <fem.hpp>

namespace ngsxfem_contact
{
  double Area (const PartTriangle & t)
  {
    if (!t.curved) return Area(t.triangle);
    auto [piece, s0, s1] = t.curved->chord;
    auto & crack = *t.curved->curve;
    auto & curve = crack.Piece(piece);
    double t0 = curve.Parameter(s0-crack.ArcLength(piece)), t1 = curve.Parameter(s1-crack.ArcLength(piece)), sum = 0;
    for (auto & ip : ngfem::SelectIntegrationRule(ngfem::ET_SEGM, 2*curve.GaussPoints(1, t0, t1)-1))
      {
        double at = t0 + ip(0)*(t1-t0);
        sum += ip.Weight() * Cross(Point(curve.Value(at)-t.triangle[0]), curve.Derivative(at));
      }
    return 0.5*std::abs(sum*(t1-t0));
  }
}
