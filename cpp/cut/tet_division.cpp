#include "cut/tet_division.hpp"

namespace ngsxfem_contact
{
  namespace
  {
    constexpr int faces[4][3] { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };          // opposite to the corner

    Point3 OnEdge (const Tet & t, const std::array<double,4> & d, int i, int j)
    {
      if (i > j) std::swap(i, j);
      return Lerp(t[i], t[j], d[i]/(d[i]-d[j]));
    }
  }

  std::vector<CutCorner> CutPolygon (const Tet & t, const std::array<double,4> & d)
  {
    std::vector<CutCorner> corners;
    std::array<std::vector<int>,2> sides;                         // positive and negative
    for (int i = 0; i < 4; i++)
      if (d[i] == 0) corners.push_back({ i, i, t[i] });
      else sides[d[i] > 0 ? 0 : 1].push_back(i);
    auto & [plus, minus] = sides;
    if (plus.empty() || minus.empty()) return {};
    auto add = [&] (int i, int j) { corners.push_back({ std::min(i, j), std::max(i, j), OnEdge(t, d, i, j) }); };
    // consecutive corners lie on a common face: two pairs that share a corner of t
    for (size_t k = 0; k < plus.size(); k++)
      for (size_t l = 0; l < minus.size(); l++) add(plus[k], minus[k % 2 ? minus.size()-1-l : l]);
    return corners;
  }

  std::array<std::vector<Tet>,2> Split (const Tet & t, const std::array<double,4> & d)
  {
    std::array<std::vector<Tet>,2> parts;
    auto polygon = CutPolygon(t, d);
    if (polygon.empty())
      {
        bool positive = false;
        for (double height : d) positive = positive || height > 0;
        parts[positive ? 0 : 1].push_back(t);
        return parts;
      }
    // each side is a cone over its faces, seen from a corner of the polygon
    auto & apex = polygon.back();
    for (int side : { 0, 1 })
      for (int k = 0; k < 4; k++)
        {
          if (apex.i != k && apex.j != k) continue;               // the face has the apex
          std::vector<Point3> face;
          for (int m = 0; m < 3; m++)
            {
              int i = faces[k][m], j = faces[k][(m+1)%3];
              if (side == 0 ? d[i] >= 0 : d[i] <= 0) face.push_back(t[i]);
              if (d[i]*d[j] < 0) face.push_back(OnEdge(t, d, i, j));
            }
          for (size_t m = 1; m+1 < face.size(); m++) parts[side].push_back({ apex.point, face[0], face[m], face[m+1] });
        }
    return parts;
  }

  std::array<Tet,8> Refined (const Tet & t)
  {
    auto m = [&] (int i, int j) { return Lerp(t[i], t[j], 0.5); };
    Point3 a = m(0,1), b = m(0,2), c = m(0,3), d = m(1,2), e = m(1,3), f = m(2,3);
    return { Tet { t[0], a, b, c }, Tet { a, t[1], d, e }, Tet { b, d, t[2], f }, Tet { c, e, f, t[3] },
             Tet { a, b, c, e }, Tet { a, b, d, e }, Tet { b, c, e, f }, Tet { b, d, e, f } };
  }
}
