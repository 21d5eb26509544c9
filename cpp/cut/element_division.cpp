#include "cut/element_division.hpp"
#include "cut/crossing.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  ElementDivision :: ElementDivision (const Polygon & polygon, std::vector<ElementChord> achords, double atolerance)
    : corners(polygon), chords(std::move(achords)), tolerance(atolerance), round_off(0.01*tolerance)
  {
    Stretches stretches;
    for (size_t i = 0; i < chords.size(); i++)
      {
        auto & [piece, s0, s1] = chords[i].here;
        auto & curve = *chords[i].curve;
        stretches.push_back({ i, true, s0, s1, curve.PointAt(piece, s0), curve.PointAt(piece, s1), curve.Tangent(piece, s0) });
      }
    Build(polygon, stretches, 40);
    NumberParts();
    JoinFacets();
  }

  ElementDivision::Stretch ElementDivision :: Part (const Stretch & whole, double s0, double s1) const
  {
    Stretch part = whole;
    part.s0 = s0;
    part.s1 = s1;
    auto at = [&] (double s) { return IsStraight(whole) ? Point(whole.a + (s-whole.s0)*whole.direction) : CurveOf(whole).PointAt(PieceOf(whole), s); };
    if (s0 != whole.s0) part.a = at(s0);
    if (s1 != whole.s1) part.b = at(s1);
    return part;
  }

  /// With what lies beyond tips inside of the polygon.
  ElementDivision::Stretches ElementDivision :: Extended (const Stretches & stretches, const Polygon & polygon) const
  {
    Stretches extended;
    for (auto & stretch : stretches)
      {
        auto & chord = chords[stretch.chord];
        if (chord.starts_at_tip && stretch.s0 == chord.here.s0)
          if (auto before = Beyond(stretch, false, polygon)) extended.push_back(*before);
        extended.push_back(stretch);
        if (chord.ends_at_tip && stretch.s1 == chord.here.s1)
          if (auto after = Beyond(stretch, true, polygon)) extended.push_back(*after);
      }
    return extended;
  }

  /// From a tip straight on to the boundary of the polygon: there the functions of the tip are not smooth enough for one rule.
  std::optional<ElementDivision::Stretch> ElementDivision :: Beyond (const Stretch & stretch, bool at_end, const Polygon & polygon) const
  {
    Point p = at_end ? stretch.b : stretch.a, onward = (at_end ? 1. : -1.)*CurveOf(stretch).Tangent(PieceOf(stretch), at_end ? stretch.s1 : stretch.s0);
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < polygon.size(); i++)
      {
        Point corner = polygon[i], edge = polygon[(i+1) % polygon.size()]-corner;
        if (double rate = Cross(onward, edge), t = Cross(Point(corner-p), edge)/rate; rate > 0 && t >= 0) nearest = std::min(nearest, t);
      }
    if (!(nearest > 2*tolerance && nearest < std::numeric_limits<double>::infinity())) return std::nullopt;
    Point q = p + nearest*onward;
    if (at_end) return Stretch { stretch.chord, false, stretch.s1, stretch.s1+nearest, p, q, onward };
    return Stretch { stretch.chord, false, stretch.s0-nearest, stretch.s0, q, p, Point(-1*onward) };
  }

  /// 0 on the line.
  double ElementDivision :: DistanceFrom (const Line & line, Point p) const
  { return line.Snapped(p, std::ranges::any_of(corners, [&] (Point corner) { return corner(0) == p(0) && corner(1) == p(1); }) ? tolerance : round_off); }

  bool ElementDivision :: AreStraight (const Stretches & stretches) const
  { return std::ranges::all_of(stretches, [&] (auto & stretch) { return IsStraight(stretch); }); }

  size_t ElementDivision :: Build (const Polygon & polygon, const Stretches & stretches, int depth)
  {
    if (AreStraight(stretches)) return BuildStraight(polygon, Extended(stretches, polygon));
    auto runs = RunsOf(stretches);
    if (runs.size() == 1)
      if (auto crossing = MakeCrossing(polygon, Extended(stretches, polygon))) return *crossing;
    if (depth == 0)
      throw Exception("CrackedMesh: cracks touch each other, or turn too much, inside of an element near " + ToString(stretches[0].a) + "; refine the mesh there, or separate them");
    auto line = LineBetween(runs);
    return Divide(polygon, stretches, line ? *line : LineAcross(*std::ranges::max_element(runs, {}, &Run::Length)),
                  [&] (const Polygon & half, const Stretches & some) { return Build(half, some, depth-1); });
  }

  size_t ElementDivision :: BuildStraight (const Polygon & polygon, const Stretches & stretches)
  {
    if (stretches.empty()) return MakeLeaf(polygon);
    return Divide(polygon, stretches, LineThrough(stretches), [&] (const Polygon & half, const Stretches & some) { return BuildStraight(half, some); });
  }

  size_t ElementDivision :: MakeLeaf (const Polygon & polygon)
  {
    size_t leaf = cells.Add();
    for (auto & t : Fan(polygon)) triangles.push_back({ t, leaf, std::nullopt });
    nodes.push_back({ Node::Leaf, leaf, {}, {}, nullptr });
    return nodes.size()-1;
  }

  std::optional<size_t> ElementDivision :: MakeCrossing (const Polygon & polygon, const Stretches & stretches)
  {
    std::vector<Crossing::Stretch> curve;
    for (auto & stretch : stretches)
      {
        curve.push_back({ stretch.a, stretch.b, std::nullopt });
        if (!IsStraight(stretch)) curve.back().curved = { &CurveOf(stretch), { PieceOf(stretch), stretch.s0, stretch.s1 } };
      }
    Crossing crossing(polygon, std::move(curve), tolerance);
    if (!crossing.IsWhole()) return std::nullopt;
    auto sides = crossing.Triangles();
    if (!sides) return std::nullopt;
    size_t plus = cells.Add(), minus = cells.Add();
    for (int k : { 0, 1 })
      for (auto & t : (*sides)[k])
        {
          triangles.push_back(t);
          triangles.back().part = plus+k;
        }
    for (auto & stretch : stretches)
      if (!stretch.real) cells.Join(plus, minus);
      else facets.push_back({ stretch.chord, stretch.s0, stretch.s1, plus, minus });
    nodes.push_back({ Node::Crossed, plus, {}, {}, crossing.Curve() });
    return nodes.size()-1;
  }

  template <typename F>
  size_t ElementDivision :: Divide (const Polygon & polygon, const Stretches & stretches, const Line & line, F && build)
  {
    std::vector<double> d;
    for (auto & p : polygon) d.push_back(DistanceFrom(line, p));
    auto halves = Split(polygon, d);
    auto sorted = Sort(stretches, line);
    size_t node = nodes.size();
    nodes.push_back({ Node::Divided, 0, line, { no_node, no_node }, nullptr });
    for (int k : { 0, 1 })
      if (halves[k].size() > 2)
        {
          size_t child = build(halves[k], sorted[k]);
          nodes[node].child[k] = child;
        }
    Compare(node, polygon, d, sorted[2]);
    return node;
  }

  /// Those on the positive side, on the negative one, and on the line.
  std::array<ElementDivision::Stretches,3> ElementDivision :: Sort (const Stretches & stretches, const Line & line) const
  {
    std::array<Stretches,3> sorted;
    for (auto & stretch : stretches)
      {
        double da = line.Snapped(stretch.a, round_off), db = line.Snapped(stretch.b, round_off);
        std::vector<double> cuts { stretch.s0, stretch.s1 };
        if (IsStraight(stretch))
          {
            if (da == 0 && db == 0) { sorted[2].push_back(stretch); continue; }
            if (da*db < 0) cuts.push_back(stretch.s0 + da/(da-db)*(stretch.s1-stretch.s0));
          }
        else
          {
            auto & curve = CurveOf(stretch);
            double first = curve.ArcLength(PieceOf(stretch));
            std::vector<double> parameters;
            curve.Piece(PieceOf(stretch)).AppendCrossings(line.origin, line.normal, parameters);
            for (double t : parameters)
              if (double s = first + curve.Piece(PieceOf(stretch)).ArcLength(t); s > stretch.s0+tolerance && s < stretch.s1-tolerance) cuts.push_back(s);
          }
        std::ranges::sort(cuts);
        for (size_t i = 0; i+1 < cuts.size(); i++)
          {
            auto part = Part(stretch, cuts[i], cuts[i+1]);
            double middle = IsStraight(part) ? line.Distance(Lerp(part.a, part.b, 0.5)) : line.Distance(CurveOf(part).PointAt(PieceOf(part), 0.5*(part.s0+part.s1)));
            sorted[middle > 0 ? 0 : 1].push_back(part);
          }
      }
    return sorted;
  }

  /// The cells on both sides of the line of a node: facets of Γ_C between them, or one part.
  void ElementDivision :: Compare (size_t node, const Polygon & polygon, const std::vector<double> & d, const Stretches & on)
  {
    auto [line, child] = std::pair(nodes[node].line, nodes[node].child);
    if (child[0] == no_node || child[1] == no_node) return;
    Point along(line.normal(1), -line.normal(0));
    std::vector<Point> ends;
    for (size_t i = 0; i < polygon.size(); i++)
      {
        size_t j = (i+1) % polygon.size();
        if (d[i] == 0) ends.push_back(polygon[i]);
        if (d[i]*d[j] < 0) ends.push_back(Lerp(polygon[i], polygon[j], d[i]/(d[i]-d[j])));
      }
    if (ends.size() < 2) return;
    auto [first, last] = std::ranges::minmax(ends, {}, [&] (Point p) { return Dot(p, along); });
    double length = Dot(Point(last-first), along);
    std::array<std::vector<Passage>,2> sides;
    std::vector<double> breaks;
    for (int k : { 0, 1 })
      {
        Follow(child[k], first, last, 0, length, sides[k]);
        for (auto & passage : sides[k]) { breaks.push_back(passage.t0); breaks.push_back(passage.t1); }
      }
    auto place = [&] (Point p) { return Dot(Point(p-first), along); };
    for (auto & stretch : on) { breaks.push_back(place(stretch.a)); breaks.push_back(place(stretch.b)); }
    std::ranges::sort(breaks);
    auto leaf_at = [] (const std::vector<Passage> & passages, double t)
    { return std::ranges::find_if(passages, [t] (auto & passage) { return passage.t0 <= t && t <= passage.t1; }); };
    for (size_t i = 0; i+1 < breaks.size(); i++)
      {
        double t0 = breaks[i], t1 = breaks[i+1], t = 0.5*(t0+t1);
        if (t1-t0 <= 2*tolerance) continue;
        auto above = leaf_at(sides[0], t), below = leaf_at(sides[1], t);
        if (above == sides[0].end() || below == sides[1].end()) continue;
        const Stretch * crack = nullptr;
        for (auto & stretch : on)
          if (auto [from, to] = std::minmax({ place(stretch.a), place(stretch.b) }); stretch.real && from <= t && t <= to)
            {
              if (crack) throw Exception("CrackedMesh: cracks " + std::to_string(chords[crack->chord].crack) + " and " + std::to_string(chords[stretch.chord].crack)
                                         + " coincide near " + ToString(Point(first + t*along)) + "; give what they share once");
              crack = &stretch;
            }
        if (!crack) { cells.Join(above->leaf, below->leaf); continue; }
        bool forward = Dot(crack->direction, along) > 0;
        auto arclength = [&] (double at) { return crack->s0 + std::clamp((forward ? 1 : -1)*(at-place(crack->a)), 0.0, crack->s1-crack->s0); };
        auto [s0, s1] = std::minmax({ arclength(t0), arclength(t1) });
        bool plus_above = Dot(Left(crack->direction), line.normal) > 0;
        facets.push_back({ crack->chord, s0, s1, plus_above ? above->leaf : below->leaf, plus_above ? below->leaf : above->leaf });
      }
  }

  /// The cells along a segment on the boundary of that of a node.
  void ElementDivision :: Follow (size_t number, Point p, Point q, double t0, double t1, std::vector<Passage> & passages) const
  {
    auto & node = nodes[number];
    if (node.kind == Node::Leaf) { passages.push_back({ t0, t1, node.leaf }); return; }
    if (node.kind == Node::Crossed) return FollowCrossing(node, p, q, t0, t1, passages);
    auto & child = node.child;
    double dp = DistanceFrom(node.line, p), dq = DistanceFrom(node.line, q);
    bool above = dp+dq > 0 || (dp+dq == 0 && child[0] != no_node);
    if (child[0] == no_node || child[1] == no_node) above = child[0] != no_node;
    else if (dp*dq < 0)
      {
        double along = dp/(dp-dq), t = t0 + along*(t1-t0);
        Point on = Lerp(p, q, along);
        Follow(child[dp > 0 ? 0 : 1], p, on, t0, t, passages);
        Follow(child[dp > 0 ? 1 : 0], on, q, t, t1, passages);
        return;
      }
    Follow(child[above ? 0 : 1], p, q, t0, t1, passages);
  }

  void ElementDivision :: FollowCrossing (const Node & node, Point p, Point q, double t0, double t1, std::vector<Passage> & passages) const
  {
    std::vector<double> cuts { 0, 1 };
    Point d = q-p;
    double length = Norm(d);
    for (Point end : { node.crossing->Points().front(), node.crossing->Points().back() })
      if (double along = Dot(Point(end-p), d)/(length*length); Distance(end, p, q) <= 2*tolerance && along*length > tolerance && (1-along)*length > tolerance)
        cuts.push_back(along);
    std::ranges::sort(cuts);
    for (size_t i = 0; i+1 < cuts.size(); i++)
      {
        bool plus = node.crossing->SideOf(Lerp(p, q, 0.5*(cuts[i]+cuts[i+1]))) == Side::Plus;
        passages.push_back({ t0+cuts[i]*(t1-t0), t0+cuts[i+1]*(t1-t0), node.leaf + (plus ? 0 : 1) });
      }
  }

  void ElementDivision :: NumberParts ()
  {
    part_of = cells.Trees();
    areas.assign(std::ranges::max(part_of)+1, 0);
    for (auto & t : triangles)
      {
        t.part = part_of[t.part];
        areas[t.part] += Area(t);
      }
  }

  void ElementDivision :: JoinFacets ()
  {
    for (auto & facet : facets)
      {
        facet.plus = part_of[facet.plus];
        facet.minus = part_of[facet.minus];
      }
    std::ranges::sort(facets, {}, [] (auto & facet) { return std::pair(facet.chord, facet.s0); });
    std::vector<Facet> joined;
    for (auto & facet : facets)
      if (!joined.empty() && joined.back().chord == facet.chord && joined.back().plus == facet.plus && joined.back().minus == facet.minus
          && facet.s0-joined.back().s1 <= 2*tolerance)
        joined.back().s1 = facet.s1;
      else
        joined.push_back(facet);
    facets = std::move(joined);
  }

  size_t ElementDivision :: PartAt (Point p) const
  {
    size_t number = 0;
    while (true)
      {
        auto & node = nodes[number];
        if (node.kind == Node::Leaf) return part_of[node.leaf];
        if (node.kind == Node::Crossed) return part_of[node.leaf + (node.crossing->SideOf(p) == Side::Plus ? 0 : 1)];
        bool above = node.line.Distance(p) >= 0;
        number = node.child[above ? 0 : 1] == no_node ? node.child[above ? 1 : 0] : node.child[above ? 0 : 1];
      }
  }

  std::vector<ElementDivision::Interval> ElementDivision :: Along (Point a, Point b) const
  {
    std::vector<Passage> passages;
    Follow(0, a, b, 0, 1, passages);
    std::vector<Interval> intervals;
    for (auto & [t0, t1, leaf] : passages)
      if (size_t part = part_of[leaf]; !intervals.empty() && intervals.back().part == part) intervals.back().t1 = t1;
      else intervals.push_back({ t0, t1, part });
    return intervals;
  }
}
