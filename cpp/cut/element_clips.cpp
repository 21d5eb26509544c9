// The parts of a crack's pieces in an element, straight or curved.

#include "cut/element_location.hpp"
#include "curve/interpolant.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception;
  using ngfem::ElementId, ngfem::VOL;

  namespace
  {
    struct Range { double t0, t1; };

    /// Parameters between which a piece is not far from an element.
    std::vector<Range> RangesBeside (const CurvePiece & piece, const ElementMap & map)
    {
      auto t = map.Corners();
      if (Cross(Point(t[1]-t[0]), Point(t[2]-t[0])) < 0) std::swap(t[1], t[2]);
      double h = LongestEdge(t), margin = 1.5*map.Bulge() + 0.05*h;
      auto is_near = [&] (Point p)
      {
        for (int i = 0; i < 3; i++)
          if (Point e = t[(i+1)%3]-t[i]; Cross(e, Point(p-t[i])) < -margin*Norm(e)) return false;
        return true;
      };
      int n = std::max(2, int(std::ceil(piece.Length()/(0.05*h))));
      auto at = [&] (int i) { return i <= 0 ? 0 : i >= n ? piece.End() : piece.Parameter(piece.Length()*i/n); };
      std::vector<Range> ranges;
      int last = -3;
      for (int i = 0; i <= n; i++)
        {
          if (!is_near(piece.Value(at(i)))) continue;
          if (i > last+2) ranges.push_back({ at(i-1), 0 });
          ranges.back().t1 = at(i+1);
          last = i;
        }
      return ranges;
    }
  }

  std::optional<CrackLocation::Clip> CrackLocation :: ClipSegment (const Triangle & t, size_t piece) const
  {
    std::array<double,3> d, along;
    int zeros = 0;
    for (int i = 0; i < 3; i++)
      {
        d[i] = crack.LineDistance(piece, t[i]);
        if (std::abs(d[i]) <= tolerance) { d[i] = 0; zeros++; }
        along[i] = Dot(Point(t[i]-crack.Points()[piece]), crack.Tangent(piece, 0));
      }
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    auto extend = [&] (double a) { lo = std::min(lo, a); hi = std::max(hi, a); };
    bool crosses = false;
    for (int i = 0; i < 3; i++)
      {
        int j = (i+1)%3;
        if (d[i] == 0) extend(along[i]);
        if (d[i]*d[j] < 0)
          {
            crosses = true;
            extend((d[i]*along[j]-d[j]*along[i]) / (d[i]-d[j]));
          }
      }
    if (!crosses && zeros != 2) return std::nullopt;

    double s = crack.ArcLength(piece), length = crack.ArcLength(piece+1)-s;
    bool starts = lo < -tolerance, ends = hi > length+tolerance;
    lo = std::max(lo, 0.0);
    hi = std::min(hi, length);
    if (hi-lo <= tolerance) return std::nullopt;
    return Clip { !crosses, { piece, s+lo, s+hi }, starts, ends, nullptr };
  }

  std::vector<CrackLocation::Clip> CrackLocation :: ClipPiece (size_t element, const ElementMap & map, size_t piece) const
  {
    if (map.IsCurved()) return ClipInCurved(element, map, piece);
    if (!crack.IsStraight(piece)) return ClipCurve(element, map.Corners(), piece);
    auto clip = ClipSegment(map.Corners(), piece);
    return clip ? std::vector<Clip> { *clip } : std::vector<Clip>();
  }

  /// Both neighbours of an edge find the same crossings: its line is the same for them to the last bit.
  std::vector<CrackLocation::Inside> CrackLocation :: RangesInside (const CurvePiece & piece, size_t element, const Triangle & t) const
  {
    struct Edge { Point a, normal; bool positive; };
    std::vector<Edge> edges;
    std::vector<double> breaks { 0, piece.End() };
    for (auto nr : mesh.GetElement(ElementId(VOL, element)).Edges())
      {
        auto [v0, v1] = mesh.GetEdgePNums(nr);
        Point a = mesh.GetPoint<2>(std::min(v0, v1)), b = mesh.GetPoint<2>(std::max(v0, v1));
        Point normal = Left(Point(1/Norm(Point(b-a)) * (b-a))), centre = 1./3*(t[0]+t[1]+t[2]);
        edges.push_back({ a, normal, Dot(Point(centre-a), normal) > 0 });
        piece.AppendCrossings(a, normal, breaks);
      }
    std::sort(breaks.begin(), breaks.end());
    auto inside = [&] (Point p, double margin)
    {
      return std::all_of(edges.begin(), edges.end(), [&] (auto & edge)
      { double d = Dot(Point(p-edge.a), edge.normal); return edge.positive ? d >= margin : -d > margin; });
    };
    std::vector<Inside> ranges;
    for (size_t i = 0; i+1 < breaks.size(); i++)
      if (breaks[i+1] > breaks[i] && inside(piece.Value(0.5*(breaks[i]+breaks[i+1])), 0))
        {
          bool starts = breaks[i] == 0 && inside(piece.Value(0), 2*tolerance);
          bool ends = breaks[i+1] == piece.End() && inside(piece.Value(piece.End()), 2*tolerance);
          ranges.push_back({ breaks[i], breaks[i+1], starts, ends });      // one of two where the crack touches an edge
        }
    return ranges;
  }

  std::vector<CrackLocation::Clip> CrackLocation :: ClipCurve (size_t element, const Triangle & t, size_t piece) const
  {
    auto & curve = crack.Piece(piece);
    double s = crack.ArcLength(piece);
    std::vector<Clip> clips;
    for (auto [t0, t1, starts, ends] : RangesInside(curve, element, t))
      if (Chord chord { piece, s+curve.ArcLength(t0), s+curve.ArcLength(t1) }; chord.s1-chord.s0 > tolerance)
        clips.push_back({ false, chord, starts, ends, nullptr });
    return clips;
  }

  /// In the coordinates of the straight triangle, where the piece is another curve.
  std::vector<CrackLocation::Clip> CrackLocation :: ClipInCurved (size_t element, const ElementMap & map, size_t piece) const
  {
    auto & t = map.Corners();
    auto & curve = crack.Piece(piece);
    double s = crack.ArcLength(piece);
    if (crack.IsStraight(piece))
      if (auto clip = ClipSegment(t, piece); clip && clip->aligned)
        if (Point p = crack.PointAt(piece, 0.5*(clip->chord.s0+clip->chord.s1)); Norm(Point(map.Value(p)-p)) <= tolerance) return { *clip };
    std::vector<Clip> clips;
    for (auto [from, to] : RangesBeside(curve, map))
      {
        auto straightened = MakeInterpolant([&, from=from] (double u)
        {
          auto p = map.Inverse(curve.Value(from+u));
          if (!p) throw Exception("CrackedMesh: the crack meets a curved element that is bent too much near " + ToString(Centre({ t.begin(), t.end() })) + "; refine the mesh there");
          return *p;
        }, to-from);
        for (auto [u0, u1, starts, ends] : RangesInside(*straightened, element, t))
          {
            double t0 = u0 == 0 ? from : from+u0, t1 = u1 == straightened->End() ? to : from+u1;
            Chord chord { piece, s+curve.ArcLength(t0), s+curve.ArcLength(t1) };
            if (chord.s1-chord.s0 > tolerance)
              clips.push_back({ false, chord, starts && t0 == 0, ends && t1 == curve.End(), straightened->Between(u0, u1) });
          }
      }
    return clips;
  }
}
