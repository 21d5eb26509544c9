#include "curve/space.hpp"
#include <algorithm>
#include <sstream>

namespace ngsxfem_contact
{
  std::string ToString (Point3 p)
  {
    std::ostringstream str;
    str << "(" << p(0) << ", " << p(1) << ", " << p(2) << ")";
    return str.str();
  }

  double LongestEdge (const Tet & t)
  {
    double longest = 0;
    for (auto & [i, j] : tet_edges) longest = std::max(longest, Norm(Point3(t[j]-t[i])));
    return longest;
  }

  bool IsFaithful (const Tet & t, const Tet & other)
  {
    for (auto & [i, j] : tet_edges)
      if (double ratio = Norm(Point3(t[j]-t[i]))/Norm(Point3(other[j]-other[i])); !(ratio > 0.5 && ratio < 2)) return false;
    auto oriented = [] (const Tet & t) { return Dot(Point3(t[1]-t[0]), Cross(Point3(t[2]-t[0]), Point3(t[3]-t[0]))); };
    double ratio = oriented(t)/oriented(other);
    return ratio > 0.25 && ratio < 4;
  }
}
