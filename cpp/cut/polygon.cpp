#include "cut/polygon.hpp"
#include <algorithm>
#include <numeric>

namespace ngsxfem_contact
{
  double Area (const Triangle & t) { return 0.5*std::abs(Cross(Point(t[1]-t[0]), Point(t[2]-t[0]))); }

  double LongestEdge (const Triangle & t)
  {
    return std::max({ Norm(Point(t[1]-t[0])), Norm(Point(t[2]-t[1])), Norm(Point(t[0]-t[2])) });
  }

  Point Centre (const Polygon & polygon)
  {
    Point sum = std::accumulate(polygon.begin(), polygon.end(), Point(0.,0.), [] (Point a, Point b) { return Point(a+b); });
    return Point(1./polygon.size() * sum);
  }

  std::vector<Triangle> Fan (const Polygon & polygon)
  {
    std::vector<Triangle> triangles;
    for (size_t i = 1; i+1 < polygon.size(); i++)
      triangles.push_back({ polygon[0], polygon[i], polygon[i+1] });
    return triangles;
  }

  std::array<Polygon,2> Split (const Polygon & polygon, const std::vector<double> & d)
  {
    std::array<Polygon,2> parts;
    double dmin = *std::min_element(d.begin(), d.end()), dmax = *std::max_element(d.begin(), d.end());
    if (dmin >= 0) { parts[0] = polygon; return parts; }
    if (dmax <= 0) { parts[1] = polygon; return parts; }
    for (size_t i = 0; i < polygon.size(); i++)
      {
        size_t j = (i+1) % polygon.size();
        if (d[i] >= 0) parts[0].push_back(polygon[i]);
        if (d[i] <= 0) parts[1].push_back(polygon[i]);
        if (d[i]*d[j] < 0)
          for (auto & part : parts)
            part.push_back(Lerp(polygon[i], polygon[j], d[i]/(d[i]-d[j])));
      }
    return parts;
  }

  Polygon HullOf (std::vector<Point> points)
  {
    std::ranges::sort(points, {}, [] (Point p) { return std::pair(p(0), p(1)); });
    Polygon hull;
    auto append = [&] (Point p, size_t least)
    {
      while (hull.size() > least && Cross(Point(hull.back()-hull[hull.size()-2]), Point(p-hull.back())) <= 0) hull.pop_back();
      hull.push_back(p);
    };
    for (auto & p : points) append(p, 1);
    size_t lower = hull.size();
    for (size_t i = points.size()-1; i-- > 0; ) append(points[i], lower);
    hull.pop_back();
    return hull;
  }

  namespace
  {
    Point NearestOnSegment (Point p, Point a, Point b)
    {
      Point ab = b-a;
      double length2 = Dot(ab, ab);
      return length2 > 0 ? Lerp(a, b, std::clamp(Dot(Point(p-a), ab)/length2, 0.0, 1.0)) : a;
    }
  }

  std::array<Point,2> ShortestWay (const Polygon & a, const Polygon & b)
  {
    Point from = a[0], to = b[0];
    auto compare = [&] (const Polygon & corners, const Polygon & sides, bool swapped)
    {
      for (auto & p : corners)
        for (size_t i = 0; i < sides.size(); i++)
          if (Point q = NearestOnSegment(p, sides[i], sides[(i+1) % sides.size()]); Norm(Point(q-p)) < Norm(Point(to-from)))
            { from = swapped ? q : p; to = swapped ? p : q; }
    };
    compare(a, b, false);
    compare(b, a, true);
    return { from, to };
  }
}
