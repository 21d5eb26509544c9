#pragma once
// Γ_C: an oriented polyline, its arc length, its normal and the side of a point (method.md, section 1).

#include <bla.hpp>
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
  std::string ToString (Point p);
  /// Distance from p to the closed segment [a, b].
  double Distance (Point p, Point a, Point b);

  enum class Side : int { Minus = -1, Plus = 1 };

  class Crack
  {
    std::vector<Point> points;
    std::vector<double> arclength;   // at the points

  public:
    /// Throws for fewer than two points, a non-finite coordinate, a segment of zero length, a curve that meets itself.
    explicit Crack (std::vector<Point> apoints);

    const std::vector<Point> & Points() const { return points; }
    size_t NumSegments() const { return points.size()-1; }
    double Length() const { return arclength.back(); }
    /// Arc length at the i-th point of the polyline.
    double ArcLength (size_t i) const { return arclength[i]; }

    Point Tangent (size_t segment) const;
    /// To the left of the direction of travel, from the minus to the plus side.
    Point Normal (size_t segment) const;

    /// The segment that carries arc length s; at a kink the one that ends there.
    size_t SegmentAt (double s) const;
    Point PointAt (double s) const;
    /// Signed distance of p from the infinite line of a segment, positive on the plus side.
    double LineDistance (size_t segment, Point p) const;

    struct Projection { size_t segment; double s, distance; bool beyond_end; };
    /// The nearest point of Γ_C.
    Projection Nearest (Point p) const;
    /// Side of p with respect to Γ_C and, beyond its ends, to their straight extensions. Plus on Γ_C itself.
    Side SideOf (Point p) const;

  private:
    void CheckSegments() const;
    void CheckSelfContact() const;
  };

  /// The distance of two cracks, and a point of the first where it is attained.
  std::pair<double, Point> Distance (const Crack & a, const Crack & b);
}
