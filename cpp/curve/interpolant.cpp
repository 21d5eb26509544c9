#include "curve/interpolant.hpp"
#include <algorithm>
#include <core/exception.hpp>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  namespace
  {
    /// A sum of Chebyshev polynomials on [0, end].
    class Interpolant : public NumericCurve
    {
      double end;
      std::vector<Point> c, dc, ddc;         // coefficients of the curve and its derivatives

    public:
      Interpolant (const std::function<Point(double)> & curve, double aend) : end(aend)
      {
        for (int n = 8; ; n *= 2)
          {
            Fit(curve, n);
            double size = Norm(c[1]), round_off = 1e-13*size + 1e-14*Norm(c[0]);
            if (std::max(Norm(c[n]), Norm(c[n-1])) <= round_off) break;
            if (n == 64) throw Exception("Crack: the curve near " + ToString(Value(0.5*end)) + " is not smooth enough");
          }
        dc = Differentiated(c);
        ddc = Differentiated(dc);
        length = Integral(0, end);
      }
      double End () const override { return end; }
      Point Value (double t) const override { return Sum(c, t); }
      Point Derivative (double t) const override { return Sum(dc, t); }
      Point SecondDerivative (double t) const override { return Sum(ddc, t); }
      PiecePtr Between (double t0, double t1) const override
      { return MakeInterpolant([&] (double t) { return Value(t1 > t0 ? t0+t : t0-t); }, std::abs(t1-t0)); }
      int GaussPoints (int order, double, double) const override { return order/2 + int(c.size()); }
      std::pair<std::string, std::vector<Point>> Description () const override { return { "interpolant", c }; }

      void AppendCrossings (Point a, Point normal, std::vector<double> & t) const override
      {
        auto value = [&] (double u) { return Dot(Point(Value(u)-a), normal); };
        auto rate = [&] (double u) { return Dot(Derivative(u), normal); };
        constexpr int n = 16;
        std::vector<double> bounds { 0 };                           // and where it turns
        for (int i = 0; i < n; i++)
          {
            double lo = end*i/n, hi = end*(i+1)/n;
            if (rate(lo)*rate(hi) < 0) bounds.push_back(Root(rate, lo, hi));
            bounds.push_back(hi);
          }
        for (size_t i = 0; i+1 < bounds.size(); i++)
          if (double lo = value(bounds[i]), hi = value(bounds[i+1]); lo == 0) t.push_back(bounds[i]);
          else if (lo*hi < 0) t.push_back(Root(value, bounds[i], bounds[i+1]));
      }

    private:
      void Fit (const std::function<Point(double)> & curve, int n)
      {
        std::vector<Point> values;
        for (int k = 0; k <= n; k++) values.push_back(curve(0.5*end*(1+cos(M_PI*(k+0.5)/(n+1)))));
        c.assign(n+1, Point(0., 0.));
        for (int j = 0; j <= n; j++)
          for (int k = 0; k <= n; k++)
            c[j] += (j ? 2. : 1.)/(n+1) * cos(M_PI*j*(k+0.5)/(n+1)) * values[k];
      }

      std::vector<Point> Differentiated (const std::vector<Point> & from) const
      {
        std::vector<Point> d(from.size()+1, Point(0., 0.));
        for (size_t j = from.size(); j-- > 1; ) d[j-1] = d[j+1] + 4.*j/end*from[j];
        d[0] = 0.5*d[0];
        d.resize(std::max<size_t>(1, from.size()-1));
        return d;
      }

      /// Clenshaw's recurrence.
      Point Sum (const std::vector<Point> & from, double t) const
      {
        double x = 2*t/end-1;
        Point b1(0., 0.), b2(0., 0.);
        for (size_t j = from.size(); j-- > 1; )
          {
            Point b = from[j] + 2*x*b1 - b2;
            b2 = b1;
            b1 = b;
          }
        return Point(from[0] + x*b1 - b2);
      }

      template <typename F>
      static double Root (F && f, double lo, double hi)
      {
        bool rises = f(lo) < 0;
        for (int it = 0; it < 100 && hi-lo > 1e-16*hi; it++)
          {
            double middle = 0.5*(lo+hi);
            if (middle == lo || middle == hi) break;
            ((f(middle) < 0) == rises ? lo : hi) = middle;
          }
        return 0.5*(lo+hi);
      }
    };
  }

  PiecePtr MakeInterpolant (const std::function<Point(double)> & curve, double end) { return std::make_shared<Interpolant>(curve, end); }
}
