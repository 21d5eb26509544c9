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
    for (auto [i, j] : tet_edges) longest = std::max(longest, Norm(Point3(t[j]-t[i])));
    return longest;
  }
}
