#pragma once
// Points and weights on T∩Ω⁺, T∩Ω⁻, T∩Γ_C and on cut boundary edges, graded to the √r singularity of a tip.
// Geometry in, weighted physical points out; all weights are positive.

#include "cut/disk.hpp"
#include "curve/tip_curve.hpp"
#include <fem.hpp>
#include <set>

namespace ngsxfem_contact
{
  struct WeightedPoint { Point p; double weight; };
  using PointRule = std::vector<WeightedPoint>;

  /// What the singular functions of one tip ask of a rule: inside r1 they are smooth functions of θ and √r,
  /// with a kink of some derivative at each radius in breaks (r0, r1, ...).
  struct TipDemand
  {
    std::set<double> breaks;
    double tolerance;              // aimed at, relative to the integral over an element
    int smoothness;                // continuous derivatives of χ
    auto operator<=> (const TipDemand &) const = default;
  };

  /// The same with the place.
  struct TipQuadrature : TipDemand
  {
    TipCurve curve;
    Point tip;

    double Radius () const { return *breaks.rbegin(); }
    ngsxfem_contact::Disk Disk () const { return { tip, Radius() }; }
    /// Between the two breaks around r: the scale on which χ varies there.
    double AnnulusWidth (double r) const;
    /// The order of Gauss that integrates over a kink at the radius r in a triangle of size h; large if h is.
    double KinkOrder (double r, double h) const;
    /// 1D Gauss points that integrate the radial part, a polynomial in √r, with those of degree order beside it.
    int RadialPoints (int order) const;
  };

  /// Gauss-Legendre with n points on [a, b].
  template <typename F>
  void Gauss (double a, double b, int n, F && visit)
  {
    for (auto & ip : ngfem::SelectIntegrationRule(ngfem::ET_SEGM, 2*n-1))
      visit(a + ip(0)*(b-a), ip.Weight()*(b-a));
  }

  /// a, the breaks between, b.
  std::vector<double> Breakpoints (double a, double b, const std::set<double> & breaks);

  /// Gauss-Legendre in √r on [a, b], n points between two breaks: visit(r, weight of dr), exact for polynomials in √r of degree 2n-2.
  template <typename F>
  void GaussInRoot (double a, double b, const std::set<double> & breaks, int n, F && visit)
  {
    auto radii = Breakpoints(a, b, breaks);
    for (size_t i = 0; i+1 < radii.size(); i++)
      Gauss(sqrt(radii[i]), sqrt(radii[i+1]), n, [&] (double root, double weight) { visit(root*root, 2*root*weight); });
  }

  /// Plain Gauss rule of the given order on one triangle.
  void AppendTriangle (const Triangle & t, int order, PointRule & rule);

  /// The order of plain Gauss that integrates the functions of a tip over a triangle to the tolerance, if it can.
  std::optional<int> GaussOrder (const Triangle & t, int order, const TipQuadrature & tip);

  /// The rule for a triangle that meets the disk of a tip: plain Gauss of raised order where the functions are
  /// smooth at the scale of t, in polar coordinates around the tip elsewhere.
  void AppendTriangleNearTip (const Triangle & t, int order, const TipQuadrature & tip, PointRule & rule);

  /// Gauss on a straight part of Γ_C; in √r, and divided at the breaks and at break_distance from the tip, if tip != nullptr.
  void AppendSegment (Point a, Point b, int order, const TipQuadrature * tip, double break_distance, PointRule & rule);

  /// Gauss on a segment in the disk of a tip that is no part of Γ_C: divided at the breaks and towards the tip, in √r if the tip is on its line.
  void AppendSegmentBesideTip (Point a, Point b, int order, const TipQuadrature & tip, PointRule & rule);
}
