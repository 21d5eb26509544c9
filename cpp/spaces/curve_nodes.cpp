#include "spaces/curve_nodes.hpp"

namespace ngsxfem_contact
{
  void CurveNodes :: Append (size_t crack, const std::vector<double> & s, const std::vector<double> & length)
  {
    for (size_t i = 0; i < s.size(); i++)
      {
        if (i > 0) neighbours.push_back({ positions.size()-1, positions.size() });
        positions.push_back(body->GetCrack(crack).PointAt(s[i]));
      }
    cracks.resize(positions.size(), crack);
    arclengths.insert(arclengths.end(), s.begin(), s.end());
    weights.insert(weights.end(), length.begin(), length.end());
  }
}
