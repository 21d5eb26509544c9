// Where to divide a polygon: along straight cracks, between curves, across a curve that bends too much.

#include "cut/element_division.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  /// Many stretches first across their middle, so that work and cells are in proportion to their number; few along their lines.
  Line ElementDivision :: LineThrough (const Stretches & stretches) const
  {
    constexpr size_t few = 8;
    Stretches real;
    std::ranges::copy_if(stretches, std::back_inserter(real), &Stretch::real);
    auto & some = real.empty() ? stretches : real;
    auto & middle = some[some.size()/2];
    if (some.size() > few)
      if (Point onward = some.back().b-some.front().a; Norm(onward) > tolerance)
        {
          Line across { middle.a, Point(1/Norm(onward) * onward) };
          auto sorted = Sort(some, across);
          if (std::max(sorted[0].size(), sorted[1].size()) <= 3*some.size()/4) return across;
        }
    return { middle.a, Left(middle.direction) };
  }

  double ElementDivision::Run :: Length () const
  {
    double length = 0;
    for (auto & stretch : stretches) length += stretch.s1-stretch.s0;
    return length;
  }

  int ElementDivision::Run :: SideOf (const Line & line, double tolerance) const
  {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (auto & p : hull)
      {
        least = std::min(least, line.Distance(p));
        most = std::max(most, line.Distance(p));
      }
    double allowed = std::max(margin, 2*tolerance);
    return least > allowed ? 1 : most < -allowed ? -1 : 0;
  }

  ElementDivision::Run ElementDivision :: MakeRun (const Stretches & stretches) const
  {
    Run run { stretches, {}, 0 };
    for (auto & stretch : stretches)
      {
        int n = IsStraight(stretch) ? 1 : 32;
        size_t first = run.hull.size();
        for (int i = 0; i <= n; i++) run.hull.push_back(Part(stretch, stretch.s0 + double(i)/n*(stretch.s1-stretch.s0), stretch.s1).a);
        if (n == 1) run.hull.back() = stretch.b;
        for (size_t i = first+1; i+1 < run.hull.size(); i++)            // an eighth of it is the sagitta
          run.margin = std::max(run.margin, 0.25*Norm(Point(run.hull[i-1]-2*run.hull[i]+run.hull[i+1])));
      }
    run.hull = HullOf(std::move(run.hull));
    return run;
  }

  std::vector<ElementDivision::Run> ElementDivision :: RunsOf (const Stretches & stretches) const
  {
    std::vector<Stretches> groups;
    for (auto & stretch : stretches)
      {
        auto & chord = chords[stretch.chord];
        bool goes_on = !groups.empty();
        if (goes_on)
          {
            auto & last = groups.back().back();
            goes_on = chords[last.chord].crack == chord.crack && Norm(Point(stretch.a-last.b)) <= 2*tolerance
              && (last.chord == stretch.chord || !chord.meets_before);
          }
        if (!goes_on) groups.emplace_back();
        groups.back().push_back(stretch);
      }
    std::vector<Run> runs;
    for (auto & group : groups) runs.push_back(MakeRun(group));
    return runs;
  }

  std::optional<Line> ElementDivision :: LineBetween (const std::vector<Run> & runs) const
  {
    for (size_t i = 0; i < runs.size(); i++)
      for (size_t j = i+1; j < runs.size(); j++)
        if (auto line = LineBetween(runs[i], runs[j])) return line;
    return std::nullopt;
  }

  /// Half-way between two runs, or through the point at which both end; nothing where no straight line separates them.
  std::optional<Line> ElementDivision :: LineBetween (const Run & a, const Run & b) const
  {
    auto [from, to] = ShortestWay(a.hull, b.hull);
    if (Point way = to-from; Norm(way) > 4*tolerance)
      {
        Line line { Lerp(from, to, 0.5), Point(1/Norm(way) * way) };
        if (a.SideOf(line, tolerance)*b.SideOf(line, tolerance) < 0) return line;
      }
    for (Point x : { a.Start(), a.End() })
      for (Point y : { b.Start(), b.End() })
        {
          if (Norm(Point(y-x)) > 4*tolerance) continue;
          auto direction = [&] (const Run & run)
          {
            Point away = Centre(run.hull)-x;
            return Point(1/Norm(away) * away);
          };
          Point normal = direction(b)-direction(a);
          if (Norm(normal) < 1e-3) continue;
          Line line { x, Point(1/Norm(normal) * normal) };
          auto clear = [&] (const Run & run, int sign)
          {
            return std::ranges::all_of(run.hull, [&] (Point p)
            { double off = Norm(Point(p-x)); return off <= 4*tolerance || sign*line.Distance(p) > 1e-3*off; });
          };
          if (clear(a, -1) && clear(b, 1)) return line;
        }
    return std::nullopt;
  }

  /// Along the normal at a kink or another joint of pieces, or in the middle.
  Line ElementDivision :: LineAcross (const Run & run) const
  {
    auto & stretches = run.stretches;
    constexpr double kink = 1e-6;
    for (size_t i = 0; i+1 < stretches.size(); i++)
      {
        Point t = Direction(stretches[i], stretches[i].s1), u = Direction(stretches[i+1], stretches[i+1].s0), both = t+u;
        if (Norm(Point(u-t)) > kink && Norm(both) > 1e-3) return { stretches[i+1].a, Point(1/Norm(both) * both) };
      }
    double left = 0.5*run.Length();
    size_t i = 0;
    while (i+1 < stretches.size() && left > stretches[i].s1-stretches[i].s0) { left -= stretches[i].s1-stretches[i].s0; i++; }
    double middle = stretches[i].s0+left;
    return { Part(stretches[i], middle, stretches[i].s1).a, Direction(stretches[i], middle) };
  }

  Point ElementDivision :: Direction (const Stretch & stretch, double s) const
  {
    if (IsStraight(stretch)) return stretch.direction;
    Point t = CurveOf(stretch).Tangent(PieceOf(stretch), s);
    return Point(1/Norm(t) * t);
  }
}
