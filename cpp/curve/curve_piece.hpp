#pragma once
// The smooth pieces of a crack, such as segments, circular arcs and cubics, each with its arc length.

#include <bla.hpp>
#include <array>
#include <memory>
#include <string>
#include <vector>

namespace ngsxfem_contact
{
  using ngbla::Vec;
  using Point = Vec<2>;

  /// Every geometric decision (on a vertex, along an edge, which side) is taken to this multiple of the
  /// mesh size at the place where it is taken.
  constexpr double geometric_tolerance = 1e-10;

  inline double Dot (Point a, Point b) { return a(0)*b(0) + a(1)*b(1); }
  inline double Cross (Point a, Point b) { return a(0)*b(1) - a(1)*b(0); }
  inline double Norm (Point a) { return std::hypot(a(0), a(1)); }
  inline Point Lerp (Point a, Point b, double t) { return Point(a + t*(b-a)); }
  /// Turned by a right angle to the left.
  inline Point Left (Point a) { return Point(-a(1), a(0)); }
  std::string ToString (Point p);
  /// A number for messages.
  std::string Digits (double x);
  /// Distance from p to the closed segment [a, b].
  double Distance (Point p, Point a, Point b);

  /// A regular curve x(t) with t from 0 to End(), and its arc length s from 0 to Length(). All pieces are analytic.
  class CurvePiece
  {
  public:
    virtual ~CurvePiece () = default;
    virtual double End () const = 0;
    virtual Point Value (double t) const = 0;
    virtual Point Derivative (double t) const = 0;
    virtual Point SecondDerivative (double t) const = 0;
    virtual double Length () const = 0;
    virtual double ArcLength (double t) const = 0;
    virtual double Parameter (double s) const = 0;
    /// The parameter of the nearest point.
    virtual double Nearest (Point p) const = 0;
    /// Appends the parameters at which (x(t)-a)·normal = 0.
    virtual void AppendCrossings (Point a, Point normal, std::vector<double> & t) const = 0;
    /// Gauss points in t that integrate f(x(t)) × x'(t), f a polynomial of the given order, between two parameters.
    virtual int GaussPoints (int order, double t0, double t1) const = 0;
    virtual bool IsStraight () const { return false; }
    /// The part between two parameters; they may lie a little beyond the ends, where the curve goes on. t1 < t0: in the
    /// other direction.
    virtual std::shared_ptr<const CurvePiece> Between (double t0, double t1) const = 0;
    /// "segment", "arc", "cubic" or "ellipse", and the points that define it.
    virtual std::pair<std::string, std::vector<Point>> Description () const = 0;

    Point PointAt (double s) const { return Value(Parameter(s)); }
    Point Tangent (double s) const;
    /// Positive where the curve turns left.
    double Curvature (double s) const;
    /// Arc lengths from 0 to Length() between which the direction turns by at most `turn` (about).
    std::vector<double> Samples (double turn) const;
  };

  /// A curve whose arc length and nearest points are found by numbers.
  class NumericCurve : public CurvePiece
  {
  protected:
    double length = 0;
    double Integral (double a, double b) const;
  public:
    double Length () const override { return length; }
    double ArcLength (double t) const override { return t >= End() ? length : Integral(0, t); }
    double Parameter (double s) const override;
    double Nearest (Point p) const override;
  };

  using PiecePtr = std::shared_ptr<const CurvePiece>;

  PiecePtr MakeSegment (Point a, Point b);
  /// Throws for three points on a line.
  PiecePtr MakeArc (Point start, Point through, Point end);
  /// The cubic with the given values and derivatives at t = 0 and 1, as one piece or several.
  /// Throws where its derivative vanishes.
  std::vector<PiecePtr> MakeCubic (Point p0, Point d0, Point p1, Point d1);
}
