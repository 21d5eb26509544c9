#include "cut/cut_element.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  /// Relative to h_T: what cracks in one element must keep between them. The functions of thinner ligaments are combinations
  /// of others but for round-off (P3: errors of λ of 5e-6 above, of 1e-3 at 0.02; docs/measured.md).
  constexpr double least_ligament = 0.03;

  namespace
  {
    struct Line
    {
      Point origin, normal;
      double Distance (Point p) const { return Dot(Point(p-origin), normal); }
    };

    Point NearestOnSegment (Point p, Point a, Point b)
    {
      Point ab = b-a;
      double length2 = Dot(ab, ab);
      return length2 > 0 ? Lerp(a, b, std::clamp(Dot(Point(p-a), ab)/length2, 0.0, 1.0)) : a;
    }

    /// The corners of the convex hull of points, around it.
    std::vector<Point> HullOf (std::vector<Point> points)
    {
      std::ranges::sort(points, {}, [] (Point p) { return std::pair(p(0), p(1)); });
      std::vector<Point> hull;
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

    /// The hull of the parts of a crack in an element, but for less than the margin.
    struct Hull
    {
      std::vector<Point> points;
      double margin;

      Hull (const Crack & crack, const ElementLocation & location) : margin(2*geometric_tolerance*location.h)
      {
        for (auto & chord : location.chords)
          {
            int n = crack.IsStraight(chord.piece) ? 1 : 32;
            size_t first = points.size();
            for (int i = 0; i <= n; i++) points.push_back(crack.PointAt(chord.piece, chord.s0 + double(i)/n*(chord.s1-chord.s0)));
            for (size_t i = first+1; i+1 < points.size(); i++)            // an eighth of it is the sagitta
              margin = std::max(margin, 0.25*Norm(Point(points[i-1]-2*points[i]+points[i+1])));
          }
        points = HullOf(std::move(points));
      }

      /// +1, -1, or 0 if the line meets the hull.
      int SideOf (const Line & line) const
      {
        auto [least, most] = std::minmax_element(points.begin(), points.end(), [&] (Point p, Point q) { return line.Distance(p) < line.Distance(q); });
        if (line.Distance(*least) > margin) return 1;
        return line.Distance(*most) < -margin ? -1 : 0;
      }
    };

    /// The shortest way from one hull to another.
    std::array<Point,2> ShortestWay (const Hull & a, const Hull & b)
    {
      Point from = a.points[0], to = b.points[0];
      auto compare = [&] (const Hull & corners, const Hull & sides, bool swapped)
      {
        for (auto & p : corners.points)
          for (size_t i = 0; i < sides.points.size(); i++)
            if (Point q = NearestOnSegment(p, sides.points[i], sides.points[(i+1) % sides.points.size()]); Norm(Point(q-p)) < Norm(Point(to-from)))
              { from = swapped ? q : p; to = swapped ? p : q; }
      };
      compare(a, b, false);
      compare(b, a, true);
      return { from, to };
    }

    bool LiesOnEdge (const Crack & crack, const Chord & chord, const ElementLocation & location)
    {
      auto & t = location.triangle;
      Point p = crack.PointAt(chord.piece, 0.5*(chord.s0+chord.s1));
      double d = std::min({ Distance(p, t[0], t[1]), Distance(p, t[1], t[2]), Distance(p, t[2], t[0]) });
      return crack.IsStraight(chord.piece) && d <= 2*geometric_tolerance*location.h;
    }

    /// The parts of a triangle that several cracks meet.
    class Separation
    {
      const std::vector<Crack> & all;
      CutElement & element;
      std::vector<Hull> hulls;

    public:
      Separation (const std::vector<Crack> & aall, CutElement & aelement) : all(aall), element(aelement)
      { for (auto & here : element.cracks) hulls.emplace_back(all[here.crack], *here.location); }

      void Append (const Polygon & polygon, const std::vector<size_t> & some)
      {
        if (some.size() == 1) return AppendDivided(polygon, some[0]);
        auto [line, groups] = Separate(some);
        std::vector<double> d;
        for (auto & p : polygon) d.push_back(line.Distance(p));
        auto halves = Split(polygon, d);
        for (int k : { 0, 1 }) Append(halves[k], groups[k]);
      }

    private:
      struct Separated { Line line; std::array<std::vector<size_t>,2> groups; };

      Separated Separate (const std::vector<size_t> & some) const
      {
        for (size_t i : some)
          for (size_t j : some)
            {
              if (i >= j) continue;
              auto [from, to] = ShortestWay(hulls[i], hulls[j]);
              Point way = to-from;
              bool clear = Norm(way) > least_ligament*element.cracks[i].location->h;
              Separated found { { Lerp(from, to, 0.5), Point(1/std::max(Norm(way), 1e-300) * way) }, {} };
              for (size_t k : some)
                {
                  int side = hulls[k].SideOf(found.line);
                  clear = clear && side;
                  found.groups[side > 0 ? 0 : 1].push_back(k);
                }
              if (clear && !found.groups[0].empty() && !found.groups[1].empty()) return found;
            }
        auto & first = element.cracks[some[0]], & second = element.cracks[some[1]];
        throw Exception("CrackedMesh: cracks " + std::to_string(first.crack) + " and " + std::to_string(second.crack) + " meet the same element near "
                        + ToString(hulls[some[0]].points[0]) + " without a straight strip between them, at least "
                        + std::to_string(int(100*least_ligament)) + " % of its size wide; refine the mesh there, to elements smaller than their distance");
      }

      void AppendDivided (const Polygon & polygon, size_t k)
      {
        size_t number = element.cracks[k].crack;
        auto location = element.cracks[k].location;
        std::vector<Chord> chords;
        for (auto & chord : location->chords)
          if (!LiesOnEdge(all[number], chord, *location)) chords.push_back(chord);
        for (auto & divided : Divide(polygon, chords, all[number], geometric_tolerance*location->h))
          {
            ElementPart part { divided, number, {}, {} };
            for (auto & other : element.cracks)
              part.sides.push_back(other.crack == number ? part.side : all[other.crack].SideOf(Centre({ part.triangle.begin(), part.triangle.end() })));
            element.parts.push_back(std::move(part));
          }
      }
    };

    /// Whether a part lies directly beside the k-th crack: no other crack that divides the element is between them.
    bool IsBeside (const ElementPart & part, const CutElement & element, const std::vector<Crack> & all, size_t k)
    {
      size_t number = element.cracks[k].crack;
      auto & chord = element.cracks[k].location->chords.front();
      Point on = all[number].PointAt(chord.piece, 0.5*(chord.s0+chord.s1));
      for (size_t d = 0; d < element.cracks.size(); d++)
        if (d != k && element.cracks[d].kind == ElementKind::Cut && part.sides[d] != all[element.cracks[d].crack].SideOf(on)) return false;
      return true;
    }

    void SetLarger (CutElement & element, const std::vector<Crack> & all, size_t k)
    {
      Measures beside;
      for (auto & part : element.parts)
        if (IsBeside(part, element, all, k)) beside[part.sides[k]] += Area(part, element.CrackOf(all, part));
      element.cracks[k].larger = beside.Larger();
      for (auto & part : element.parts)
        part.larger.push_back(part.sides[k] == element.cracks[k].larger && IsBeside(part, element, all, k));
    }
  }

  CutElement :: CutElement (const std::vector<Crack> & all, std::vector<ElementCrack> acracks)
    : ElementCracks { std::move(acracks), 0 }
  {
    auto & t = cracks[0].location->triangle;
    h = cracks[0].location->h;
    if (IsShared())
      {
        if (cracks[0].location->curved)
          throw Exception("CrackedMesh: cracks " + std::to_string(cracks[0].crack) + " and " + std::to_string(cracks[1].crack)
                          + " meet the same curved element near " + ToString(Centre({ t.begin(), t.end() })) + "; refine the mesh there");
        std::vector<size_t> everyone;
        for (size_t k = 0; k < cracks.size(); k++) everyone.push_back(k);
        Separation(all, *this).Append({ t.begin(), t.end() }, everyone);
      }
    else
      for (auto & part : cracks[0].location->parts) parts.push_back({ part, cracks[0].crack, { part.side }, {} });
    for (size_t k = 0; k < cracks.size(); k++) SetLarger(*this, all, k);
  }

  const ElementCrack & CutElement :: CrackAt (const std::vector<Crack> & all, Point x) const
  {
    if (!IsShared()) return cracks[0];
    return *std::min_element(cracks.begin(), cracks.end(), [&] (auto & a, auto & b) { return all[a.crack].Nearest(x).distance < all[b.crack].Nearest(x).distance; });
  }
}
