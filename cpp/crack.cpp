#include "crack.hpp"
#include <algorithm>
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

  double Distance (Point p, Point a, Point b)
  {
    Point ab = b-a;
    double t = std::clamp(Dot(p-a, ab) / Dot(ab, ab), 0.0, 1.0);
    return Norm(Point(p-Lerp(a, b, t)));
  }

  namespace
  {
    bool Cross (Point a, Point b, Point c, Point d)
    {
      // the sign of three points on a line is round-off; segments that touch there are found by their end points
      auto orient = [] (Point p, Point q, Point r)
      {
        double o = ngsxfem_contact::Cross(q-p, r-p);
        return std::abs(o) <= 1e-14*Norm(Point(q-p))*Norm(Point(r-p)) ? 0 : o;
      };
      return orient(a,b,c)*orient(a,b,d) < 0 && orient(c,d,a)*orient(c,d,b) < 0;
    }

    double Distance (Point a, Point b, Point c, Point d)
    {
      using ngsxfem_contact::Distance;
      if (Cross(a, b, c, d)) return 0;
      return std::min({ Distance(a,c,d), Distance(b,c,d), Distance(c,a,b), Distance(d,a,b) });
    }
  }

  Crack :: Crack (std::vector<Point> apoints) : points(std::move(apoints))
  {
    CheckSegments();
    arclength.push_back(0);
    for (size_t i = 0; i < NumSegments(); i++)
      arclength.push_back(arclength[i] + Norm(Point(points[i+1]-points[i])));
    CheckSelfContact();
  }

  void Crack :: CheckSegments () const
  {
    if (points.size() < 2)
      throw Exception("Crack: needs at least two points, got " + std::to_string(points.size()));
    for (size_t i = 0; i < points.size(); i++)
      if (!std::isfinite(points[i](0)) || !std::isfinite(points[i](1)))
        throw Exception("Crack: point " + std::to_string(i) + " is " + ToString(points[i]) + "; coordinates must be finite");
    double size = 0;
    for (auto & p : points)
      size = std::max(size, Norm(Point(p-points[0])));
    for (size_t i = 0; i < NumSegments(); i++)
      if (Norm(Point(points[i+1]-points[i])) <= geometric_tolerance * size)
        throw Exception("Crack: points " + std::to_string(i) + " and " + std::to_string(i+1) + " coincide at "
                        + ToString(points[i]) + "; a segment of zero length has no direction: remove one of them");
  }

  void Crack :: CheckSelfContact () const
  {
    for (size_t i = 0; i < NumSegments(); i++)
      for (size_t j = i+1; j < NumSegments(); j++)
        {
          bool adjacent = j == i+1;
          double distance = adjacent
            ? ngsxfem_contact::Distance(points[j+1], points[i], points[i+1])
            : Distance(points[i], points[i+1], points[j], points[j+1]);
          if (adjacent)
            distance = std::min(distance, ngsxfem_contact::Distance(points[i], points[j], points[j+1]));
          if (distance <= geometric_tolerance * Length())
            throw Exception("Crack: segments " + std::to_string(i) + " and " + std::to_string(j) + " meet near "
                            + ToString(points[j]) + "; a crack must not touch or cross itself: split or shorten it");
        }
  }

  Point Crack :: Tangent (size_t i) const
  {
    Point d = points[i+1]-points[i];
    return Point(1/Norm(d) * d);
  }

  Point Crack :: Normal (size_t i) const
  {
    Point t = Tangent(i);
    return Point(-t(1), t(0));
  }

  size_t Crack :: SegmentAt (double s) const
  {
    size_t i = std::lower_bound(arclength.begin()+1, arclength.end()-1, s) - arclength.begin();
    return i-1;
  }

  Point Crack :: PointAt (double s) const
  {
    size_t i = SegmentAt(s);
    return Point(points[i] + (s-arclength[i]) * Tangent(i));
  }

  double Crack :: LineDistance (size_t i, Point p) const
  {
    return Dot(Point(p-points[i]), Normal(i));
  }

  Crack::Projection Crack :: Nearest (Point p) const
  {
    Projection best { 0, 0, std::numeric_limits<double>::infinity(), false };
    for (size_t i = 0; i < NumSegments(); i++)
      {
        double length = arclength[i+1]-arclength[i];
        double along = Dot(Point(p-points[i]), Tangent(i));
        double clamped = std::clamp(along, 0.0, length);
        double distance = Norm(Point(p - points[i] - clamped*Tangent(i)));
        if (distance < best.distance)
          best = { i, arclength[i]+clamped, distance,
                   (i == 0 && along < 0) || (i+1 == NumSegments() && along > length) };
      }
    return best;
  }

  Side Crack :: SideOf (Point p) const
  {
    auto [i, s, distance, beyond] = Nearest(p);
    double d = LineDistance(i, p);
    // nearest to a kink: the sum of the two normals decides, whichever segment was found first
    bool at_start = s == arclength[i] && i > 0, at_end = s == arclength[i+1] && i+1 < NumSegments();
    if (!beyond && (at_start || at_end))
      {
        size_t kink = at_start ? i : i+1;
        d = Dot(Point(p-points[kink]), Point(Normal(kink-1) + Normal(kink)));
      }
    return d >= 0 ? Side::Plus : Side::Minus;
  }

  std::pair<double, Point> Distance (const Crack & a, const Crack & b)
  {
    std::pair<double, Point> best { std::numeric_limits<double>::infinity(), Point(0,0) };
    for (size_t i = 0; i < a.NumSegments(); i++)
      for (size_t j = 0; j < b.NumSegments(); j++)
        if (double d = Distance(a.Points()[i], a.Points()[i+1], b.Points()[j], b.Points()[j+1]); d < best.first)
          best = { d, Lerp(a.Points()[i], a.Points()[i+1], 0.5) };
    return best;
  }
}
