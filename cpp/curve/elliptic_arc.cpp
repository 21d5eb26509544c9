#include "curve/elliptic_arc.hpp"
#include <algorithm>
#include <core/exception.hpp>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  namespace
  {
    class EllipticArc : public NumericCurve
    {
      Point centre, a, b;
      double from, end;
    public:
      EllipticArc (Point acentre, Point aa, Point ab, double t0, double t1) : centre(acentre), a(aa), b(ab), from(t0), end(t1-t0) { length = Integral(0, end); }
      double End () const override { return end; }
      Point Value (double t) const override { return Point(centre + cos(from+t)*a + sin(from+t)*b); }
      Point Derivative (double t) const override { return Point(cos(from+t)*b - sin(from+t)*a); }
      Point SecondDerivative (double t) const override { return Point(centre - Value(t)); }
      void AppendCrossings (Point p, Point normal, std::vector<double> & t) const override
      {
        // distance = |w| cos(angle - direction), w the vector of the two half axes across the line
        double wa = Dot(a, normal), wb = Dot(b, normal), size = std::hypot(wa, wb), distance = Dot(Point(p-centre), normal);
        if (std::abs(distance) > size) return;
        double direction = atan2(wb, wa), w = acos(distance/size), middle = from + 0.5*end;
        for (double at : { direction-w, direction+w })
          {
            double u = 0.5*end + std::remainder(at-middle, 2*M_PI);
            if (u < 0 || u > end) continue;
            // a Newton step: acos loses half of the digits where the line is nearly tangent
            double rate = Dot(Derivative(u), normal);
            if (std::abs(rate) > 1e-7*size) u -= Dot(Point(Value(u)-p), normal)/rate;
            t.push_back(std::clamp(u, 0.0, end));
          }
      }
      int GaussPoints (int order, double t0, double t1) const override
      {
        // as for a circle: of exp(i x t) on [-1, 1] the error of n Gauss points is x^{2n} π / (4^n (2n)!), about
        double x = 0.5*(order+2)*std::abs(t1-t0), error = 1;
        int extra = 0;
        while (error > 1e-17 && extra < 40)
          {
            extra++;
            error *= x*x/(4*(2*extra-1)*(2*extra));
          }
        return order/2 + 1 + extra;
      }
      PiecePtr Between (double t0, double t1) const override
      {
        if (t1 > t0) return std::make_shared<EllipticArc>(centre, a, b, from+t0, from+t1);
        return std::make_shared<EllipticArc>(centre, a, Point(-1*b), -from-t0, -from-t1);
      }
      std::pair<std::string, std::vector<Point>> Description () const override { return { "ellipse", { centre, a, b, Point(from, from+end) } }; }
      /// Whether Gauss points give the arc length to round-off.
      bool IsTame () const { return end < 2 && std::abs(Integral(0, 0.5*end) + Integral(0.5*end, end) - length) < 1e-14*length; }
    };

    void AppendTame (Point centre, Point a, Point b, double t0, double t1, std::vector<PiecePtr> & pieces)
    {
      auto arc = std::make_shared<EllipticArc>(centre, a, b, t0, t1);
      if (arc->IsTame()) { pieces.push_back(arc); return; }
      AppendTame(centre, a, b, t0, 0.5*(t0+t1), pieces);
      AppendTame(centre, a, b, 0.5*(t0+t1), t1, pieces);
    }
  }

  std::vector<PiecePtr> MakeEllipticArc (Point centre, Point a, Point b, double t0, double t1)
  {
    for (double x : { centre(0), centre(1), a(0), a(1), b(0), b(1), t0, t1 })
      if (!std::isfinite(x)) throw Exception("Crack: the ellipse around " + ToString(centre) + " has a number that is not finite");
    double large = Dot(a, a) + Dot(b, b);
    if (!(std::abs(Cross(a, b)) > 1e-3*large))
      throw Exception("Crack: the half axes " + ToString(a) + " and " + ToString(b) + " of an ellipse are nearly parallel, or one is 1000 times the other; give a segment");
    if (!(t1 > t0 && t1-t0 <= 2*M_PI*(1+1e-12))) throw Exception("Crack: an arc of an ellipse runs from t0 to t1, t0 < t1 <= t0 + 2 pi, got " + ToString(Point(t0, t1)));
    std::vector<PiecePtr> pieces;
    AppendTame(centre, a, b, t0, t1, pieces);
    return pieces;
  }
}
