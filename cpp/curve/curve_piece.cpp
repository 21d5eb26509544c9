#include "curve/curve_piece.hpp"
#include <algorithm>
#include <fem.hpp>
#include <sstream>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  std::string ToString (Point p)
  {
    std::ostringstream str;
    str << "(" << p(0) << ", " << p(1) << ")";
    return str.str();
  }

  std::string Digits (double x)
  {
    std::ostringstream str;
    str << x;
    return str.str();
  }

  double Distance (Point p, Point a, Point b)
  {
    Point ab = b-a;
    double t = std::clamp(Dot(p-a, ab) / Dot(ab, ab), 0.0, 1.0);
    return Norm(Point(p-Lerp(a, b, t)));
  }

  Point CurvePiece :: Tangent (double s) const
  {
    Point d = Derivative(Parameter(s));
    return Point(1/Norm(d) * d);
  }

  double CurvePiece :: Curvature (double s) const
  {
    double t = Parameter(s);
    Point d = Derivative(t);
    return Cross(d, SecondDerivative(t)) / std::pow(Norm(d), 3);
  }

  std::vector<double> CurvePiece :: Samples (double turn) const
  {
    double largest = 0;
    for (int i = 0; i <= 16; i++) largest = std::max(largest, std::abs(Curvature(i/16.*Length())));
    int n = std::max(1, int(std::ceil(largest*Length()/turn)));
    std::vector<double> samples;
    for (int i = 0; i <= n; i++) samples.push_back(Length()*i/n);
    return samples;
  }

  double NumericCurve :: Integral (double a, double b) const
  {
    double sum = 0;
    for (auto & ip : ngfem::SelectIntegrationRule(ngfem::ET_SEGM, 31))
      {
        Point d = Derivative(a + ip(0)*(b-a));
        sum += ip.Weight() * sqrt(Dot(d, d));
      }
    return sum*(b-a);
  }

  double NumericCurve :: Parameter (double s) const
  {
    double t = std::clamp(s/length, 0.0, 1.0) * End();
    for (int it = 0; it < 20; it++)
      {
        double step = (s-ArcLength(t)) / Norm(Derivative(t));
        t = std::clamp(t+step, 0.0, End());
        if (std::abs(step) < 1e-15*End()) break;
      }
    return t;
  }

  /// Newton's method on (x(t)-p)·x'(t) = 0 from the best of several points, halved where it leaves its bracket.
  double NumericCurve :: Nearest (Point p) const
  {
    constexpr int n = 8;
    double end = End();
    auto distance2 = [&] (double t) { Point d = Value(t)-p; return Dot(d, d); };
    int best = 0;
    double least = distance2(0);
    for (int i = 1; i <= n; i++)
      if (double d2 = distance2(end*i/n); d2 < least) { best = i; least = d2; }
    auto slope = [&] (double t) { return Dot(Point(Value(t)-p), Derivative(t)); };
    double lo = end*std::max(0, best-1)/n, hi = end*std::min(n, best+1)/n;
    if (slope(lo) >= 0) return lo;
    if (slope(hi) <= 0) return hi;
    double t = end*best/n;
    for (int it = 0; it < 60 && hi-lo > 1e-16*end; it++)
      {
        double f = slope(t);
        (f > 0 ? hi : lo) = t;
        Point d = Derivative(t);
        double rate = Dot(d, d) + Dot(Point(Value(t)-p), SecondDerivative(t)), next = t-f/rate;
        if (!(rate > 0 && next > lo && next < hi)) next = 0.5*(lo+hi);
        if (std::abs(next-t) < 1e-16*end) break;
        t = next;
      }
    return t;
  }

  namespace
  {
    class Segment : public CurvePiece
    {
      Point a, b, tangent;
      double length;
    public:
      Segment (Point aa, Point ab) : a(aa), b(ab), length(Norm(Point(ab-aa))) { tangent = 1/length * (b-a); }
      double End () const override { return length; }
      Point Value (double t) const override { return t == length ? b : Point(a + t*tangent); }
      Point Derivative (double) const override { return tangent; }
      Point SecondDerivative (double) const override { return Point(0., 0.); }
      double Length () const override { return length; }
      double ArcLength (double t) const override { return t; }
      double Parameter (double s) const override { return s; }
      double Nearest (Point p) const override { return std::clamp(Dot(Point(p-a), tangent), 0.0, length); }
      void AppendCrossings (Point p, Point normal, std::vector<double> & t) const override
      {
        double rate = Dot(tangent, normal), at = rate ? Dot(Point(p-a), normal)/rate : -1;
        if (at >= 0 && at <= length) t.push_back(at);
      }
      int GaussPoints (int order, double, double) const override { return order/2+1; }
      bool IsStraight () const override { return true; }
      PiecePtr Between (double t0, double t1) const override { return MakeSegment(Value(t0), Value(t1)); }
      std::pair<std::string, std::vector<Point>> Description () const override { return { "segment", { a, b } }; }
    };

    /// x(t) = centre + radius (cos, sin)(angle + t/radius); radius < 0: clockwise.
    class Arc : public CurvePiece
    {
      std::array<Point,3> given;
      Point centre;
      double radius, angle, length;
    public:
      Arc (Point start, Point through, Point end) : given { start, through, end }
      {
        for (Point p : given)
          if (!std::isfinite(p(0)) || !std::isfinite(p(1)))
            throw Exception("Crack.Arc: the point " + ToString(p) + " is not finite");
        Point b = through-start, c = end-start;
        double det = 2*Cross(b, c), size = std::max({ Norm(b), Norm(c), Norm(Point(end-through)) });
        if (!(std::abs(det) > 1e-8*size*size))
          throw Exception("Crack.Arc: the points " + ToString(start) + ", " + ToString(through) + " and " + ToString(end)
                          + " lie on a line; give three points of a circle, or Crack([start, end]) for a straight crack");
        Point offset(Dot(b,b)*c(1)-Dot(c,c)*b(1), Dot(c,c)*b(0)-Dot(b,b)*c(0));
        offset = 1/det * offset;
        centre = start+offset;
        Point u = -1*offset, v = end-centre;
        double turn = atan2(Cross(u, v), Dot(u, v));
        bool left = det > 0;
        if (left && turn < 0) turn += 2*M_PI;
        if (!left && turn > 0) turn -= 2*M_PI;
        radius = left ? Norm(offset) : -Norm(offset);
        length = radius*turn;
        angle = atan2(u(1), u(0));
      }
      double End () const override { return length; }
      Point Value (double t) const override
      {
        if (t == length) return given[2];
        // from the start, so that no digits are lost where the radius is large
        double w = 0.5*t/radius, chord = 2*std::abs(radius)*sin(w), direction = angle+w;
        return Point(given[0] + chord*Point(-sin(direction), cos(direction)));
      }
      Point Derivative (double t) const override
      {
        double w = angle+t/radius;
        return radius > 0 ? Point(-sin(w), cos(w)) : Point(sin(w), -cos(w));
      }
      Point SecondDerivative (double t) const override { return Point(1/radius * Left(Derivative(t))); }
      double Length () const override { return length; }
      double ArcLength (double t) const override { return t; }
      double Parameter (double s) const override { return s; }
      double Nearest (Point p) const override
      {
        Point d = p-centre;
        double middle = angle + 0.5*length/radius;
        double t = 0.5*length + radius*std::remainder(atan2(d(1), d(0))-middle, 2*M_PI);
        return std::clamp(t, 0.0, length);
      }
      void AppendCrossings (Point p, Point normal, std::vector<double> & t) const override
      {
        double size = Norm(normal), distance = Dot(Point(p-centre), normal)/size, r = std::abs(radius);
        if (std::abs(distance) > r) return;
        double direction = atan2(normal(1), normal(0)), w = acos(distance/r);
        for (double at : { direction-w, direction+w })
          {
            double middle = angle + 0.5*length/radius;
            double u = 0.5*length + radius*std::remainder(at-middle, 2*M_PI);
            if (u < 0 || u > length) continue;
            // a Newton step: acos loses half of the digits where the line is nearly tangent
            double rate = Dot(Derivative(u), normal);
            if (std::abs(rate) > 1e-7*size) u -= Dot(Point(Value(u)-p), normal)/rate;
            t.push_back(std::clamp(u, 0.0, length));
          }
      }
      int GaussPoints (int order, double t0, double t1) const override
      {
        // of exp(i a x) on [-1, 1] the error of n Gauss points is a^{2n} π / (4^n (2n)!), about
        double a = 0.5*(order+2)*std::abs((t1-t0)/radius), error = 1;
        int extra = 0;
        while (error > 1e-17 && extra < 40)
          {
            extra++;
            error *= a*a/(4*(2*extra-1)*(2*extra));
          }
        return order/2 + 1 + extra;
      }
      PiecePtr Between (double t0, double t1) const override
      {
        if (std::abs(t1-t0) < 1e-7*std::abs(radius)) return MakeSegment(Value(t0), Value(t1));      // three points on a line
        return MakeArc(Value(t0), Value(0.5*(t0+t1)), Value(t1));
      }
      std::pair<std::string, std::vector<Point>> Description () const override
      { return { "arc", std::vector<Point>(given.begin(), given.end()) }; }
    };

    class Cubic : public NumericCurve
    {
      std::array<Point,4> given;             // values and derivatives at the ends: what it is described by, to the last digit
      std::array<Point,4> c;                 // powers of t in [0, 1]
    public:
      Cubic (Point p0, Point d0, Point p1, Point d1) : given { p0, d0, p1, d1 }
      {
        Point chord = p1-p0;
        c = { p0, d0, Point(3*chord-2*d0-d1), Point(d0+d1-2*chord) };
        length = Integral(0, 1);
      }
      Cubic Part (double t0, double t1) const
      { return Cubic(Value(t0), Point((t1-t0)*Derivative(t0)), Value(t1), Point((t1-t0)*Derivative(t1))); }
      double End () const override { return 1; }
      Point Value (double t) const override { return Point(c[0] + t*(c[1] + t*(c[2] + t*c[3]))); }
      Point Derivative (double t) const override { return Point(c[1] + t*(2*c[2] + t*3*c[3])); }
      Point SecondDerivative (double t) const override { return Point(2*c[2] + 6*t*c[3]); }
      PiecePtr Between (double t0, double t1) const override { return std::make_shared<Cubic>(Part(t0, t1)); }
      void AppendCrossings (Point a, Point normal, std::vector<double> & t) const override
      {
        std::array<double,4> q { Dot(Point(c[0]-a), normal), Dot(c[1], normal), Dot(c[2], normal), Dot(c[3], normal) };
        auto value = [&] (double x) { return q[0] + x*(q[1] + x*(q[2] + x*q[3])); };
        std::vector<double> bounds { 0, 1 };                        // and where it turns
        double disc = q[2]*q[2] - 3*q[1]*q[3];
        if (disc > 0)
          {
            double root = -(q[2] + std::copysign(sqrt(disc), q[2]));
            for (double x : { root/(3*q[3]), q[1]/root })
              if (x > 0 && x < 1) bounds.push_back(x);              // false for nan
          }
        std::sort(bounds.begin(), bounds.end());
        for (size_t i = 0; i+1 < bounds.size(); i++)
          {
            double lo = bounds[i], hi = bounds[i+1], flo = value(lo), fhi = value(hi);
            if (flo == 0) { t.push_back(lo); continue; }
            if (flo*fhi > 0) continue;
            double x = 0.5*(lo+hi);
            for (int it = 0; it < 100 && hi-lo > 1e-17; it++)
              {
                double f = value(x), rate = q[1] + x*(2*q[2] + x*3*q[3]), next = x-f/rate;
                (f*flo > 0 ? lo : hi) = x;
                if (!(next > lo && next < hi)) next = 0.5*(lo+hi);
                if (next == x) break;
                x = next;
              }
            t.push_back(x);
          }
      }
      int GaussPoints (int order, double, double) const override { return (3*order+6)/2; }
      std::pair<std::string, std::vector<Point>> Description () const override
      { return { "cubic", std::vector<Point>(given.begin(), given.end()) }; }
      /// Whether Gauss points give the arc length to round-off, and Newton's method finds nearest points.
      bool IsTame () const
      {
        double speed = Norm(Derivative(0.5)), turn = 0;
        for (int i = 0; i < 8; i++)
          {
            Point a = Derivative(i/8.), b = Derivative((i+1)/8.);
            turn += std::abs(atan2(Cross(a, b), Dot(a, b)));
            if (!(Norm(a) > 0.4*speed && Norm(a) < 2.5*speed)) return false;
          }
        return turn < 1 && std::abs(Integral(0, 0.5) + Integral(0.5, 1) - length) < 1e-14*length;
      }
    };

    void AppendTame (const Cubic & cubic, int depth, std::vector<PiecePtr> & pieces)
    {
      if (cubic.IsTame()) { pieces.push_back(std::make_shared<Cubic>(cubic)); return; }
      if (depth == 0)
        throw Exception("Crack: the curve has a cusp or stops near " + ToString(cubic.Value(0.5))
                        + "; its derivative must not vanish");
      AppendTame(cubic.Part(0, 0.5), depth-1, pieces);
      AppendTame(cubic.Part(0.5, 1), depth-1, pieces);
    }
  }

  PiecePtr MakeSegment (Point a, Point b) { return std::make_shared<Segment>(a, b); }

  PiecePtr MakeArc (Point start, Point through, Point end) { return std::make_shared<Arc>(start, through, end); }

  std::vector<PiecePtr> MakeCubic (Point p0, Point d0, Point p1, Point d1)
  {
    std::vector<PiecePtr> pieces;
    AppendTame(Cubic(p0, d0, p1, d1), 20, pieces);
    return pieces;
  }
}
