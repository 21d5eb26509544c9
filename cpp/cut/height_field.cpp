#include "cut/height_field.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  namespace
  {
    /// The four B-splines that are not zero at t in [0, 1] of an interval, and their derivatives by t.
    std::array<std::array<double,4>,2> Splines (double t)
    {
      double s = 1-t;
      return { { { s*s*s/6, (3*t*t*t - 6*t*t + 4)/6, (3*s*s*s - 6*s*s + 4)/6, t*t*t/6 },
                 { -0.5*s*s, 1.5*t*t - 2*t, 2*s - 1.5*s*s, 0.5*t*t } } };
    }
  }

  void HeightField :: Check () const
  {
    if (!(spacing(0) > 0 && spacing(1) > 0) || size[0] < 4 || size[1] < 4 || coefficients.size() != size[0]*size[1])
      throw Exception("HeightField: give positive distances of knots, and at least 4 times 4 coefficients");
    if (!std::ranges::all_of(coefficients, [] (double c) { return std::isfinite(c); })) throw Exception("HeightField: a coefficient is not finite");
  }

  std::array<double,3> HeightField :: At (Point p) const
  {
    std::array<size_t,2> first;
    std::array<std::array<std::array<double,4>,2>,2> splines;
    Point beyond;
    for (int k = 0; k < 2; k++)
      {
        double intervals = double(size[k]-3), x = (p(k)-lower(k))/spacing(k), inside = std::clamp(x, 0.0, intervals);
        first[k] = size_t(std::min(inside, intervals-1));
        splines[k] = Splines(inside-double(first[k]));
        beyond(k) = (x-inside)*spacing(k);
      }
    std::array<double,3> f { 0, 0, 0 };
    for (size_t i = 0; i < 4; i++)
      for (size_t j = 0; j < 4; j++)
        {
          double c = coefficients[(first[0]+i)*size[1] + first[1]+j];
          f[0] += c*splines[0][0][i]*splines[1][0][j];
          f[1] += c*splines[0][1][i]*splines[1][0][j]/spacing(0);
          f[2] += c*splines[0][0][i]*splines[1][1][j]/spacing(1);
        }
    f[0] += f[1]*beyond(0) + f[2]*beyond(1);
    return f;
  }

  GraphSurface :: GraphSurface (Point3 origin, std::array<Point3,2> axes, HeightField afield) : plane(PlaneOf(origin, axes, "Sheet")), field(std::move(afield))
  { field.Check(); }

  Point3 GraphSurface :: Flat (Point3 x) const
  {
    Point p = plane.Project(x);
    return Point3(p(0), p(1), plane.Height(x) - field.At(p)[0]);
  }

  Surface::Place GraphSurface :: At (Point p) const
  {
    auto [f, by_first, by_second] = field.At(p);
    Point3 first = plane.axes[0] + by_first*plane.normal, second = plane.axes[1] + by_second*plane.normal, normal = Cross(first, second);
    return { plane.Value(p, f), { first, second }, 1/Norm(normal) * normal, plane.normal };
  }

  std::array<Point3,2> GraphSurface :: Bounds (Point lo, Point hi) const
  {
    auto [least, most] = std::ranges::minmax(field.coefficients);                // splines lie between their coefficients
    for (Point p : { lo, hi, Point(lo(0), hi(1)), Point(hi(0), lo(1)) })
      {
        least = std::min(least, field.At(p)[0]);
        most = std::max(most, field.At(p)[0]);
      }
    return BoxOfPlane(plane, lo, hi, least, most);
  }
}
