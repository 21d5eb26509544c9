#include "cut/element_division.hpp"
#include <algorithm>
#include <fem.hpp>
#include <numeric>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  double Area (const Triangle & t) { return 0.5*std::abs(Cross(Point(t[1]-t[0]), Point(t[2]-t[0]))); }

  double LongestEdge (const Triangle & t)
  {
    return std::max({ Norm(Point(t[1]-t[0])), Norm(Point(t[2]-t[1])), Norm(Point(t[0]-t[2])) });
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

  std::vector<Triangle> Fan (const Polygon & polygon)
  {
    std::vector<Triangle> triangles;
    for (size_t i = 1; i+1 < polygon.size(); i++)
      triangles.push_back({ polygon[0], polygon[i], polygon[i+1] });
    return triangles;
  }

  Point Centre (const Polygon & polygon)
  {
    Point sum = std::accumulate(polygon.begin(), polygon.end(), Point(0.,0.), [] (Point a, Point b) { return Point(a+b); });
    return Point(1./polygon.size() * sum);
  }

  double Area (const Part & part, const Crack & crack)
  {
    if (!part.curved) return Area(part.triangle);
    auto [piece, s0, s1] = *part.curved;
    auto & curve = crack.Piece(piece);
    double t0 = curve.Parameter(s0-crack.ArcLength(piece)), t1 = curve.Parameter(s1-crack.ArcLength(piece)), sum = 0;
    for (auto & ip : ngfem::SelectIntegrationRule(ngfem::ET_SEGM, 2*curve.GaussPoints(1, t0, t1)-1))
      {
        double t = t0 + ip(0)*(t1-t0);
        sum += ip.Weight() * Cross(Point(curve.Value(t)-part.triangle[0]), curve.Derivative(t));
      }
    return 0.5*std::abs(sum*(t1-t0));
  }

  namespace
  {
    /// A convex polygon divided along the straight parts of a crack in it, and beyond its ends along their lines.
    class StraightDivision
    {
      const Crack & crack;
      double tolerance;
      struct Line { Point origin, normal; };
      struct Segment { Line line; Point a, b; };
      struct Region { Polygon polygon; std::vector<Segment> segments; };
      std::vector<Region> left;

    public:
      StraightDivision (const Polygon & polygon, const std::vector<Chord> & chords, const Crack & acrack, double atolerance)
        : crack(acrack), tolerance(atolerance), left { { polygon, {} } }
      {
        double size = 0;
        for (auto & p : polygon) size = std::max(size, 2*Norm(Point(p-polygon[0])));
        for (auto & [piece, s0, s1] : chords)
          {
            // a tip: on to the other side of the polygon
            double before = s0 <= tolerance ? size : 0, after = s1 >= crack.Length()-tolerance ? size : 0;
            Line line { crack.Points()[piece], crack.Normal(piece, s0) };
            left[0].segments.push_back({ line, crack.PointAt(piece, s0-before), crack.PointAt(piece, s1+after) });
          }
      }

      std::vector<Part> Parts ()
      {
        std::vector<Part> parts;
        while (!left.empty())
          {
            Region region = std::move(left.back());
            left.pop_back();
            if (!region.segments.empty()) { Divide(region); continue; }
            Side side = crack.SideOf(Centre(region.polygon));
            for (auto & t : Fan(region.polygon)) parts.push_back({ t, side, std::nullopt });
          }
        return parts;
      }

    private:
      double Snapped (const Line & line, Point p) const
      {
        double d = Dot(Point(p-line.origin), line.normal);
        return std::abs(d) <= tolerance ? 0 : d;
      }

      /// Many segments first across their middle, so that work and parts are in proportion to their number; few along their lines.
      void Divide (const Region & region)
      {
        constexpr size_t few = 8;
        auto & segments = region.segments;
        auto & middle = segments[segments.size()/2];
        std::array<Region,2> halves;
        bool balanced = false;
        if (segments.size() > few)
          {
            Point onward = segments.back().b-segments.front().a;
            halves = Halves(region, { middle.a, Point(1/Norm(onward) * onward) });
            balanced = std::max(halves[0].segments.size(), halves[1].segments.size()) <= 3*segments.size()/4;
          }
        if (!balanced) halves = Halves(region, middle.line);
        for (auto & half : halves)
          if (half.polygon.size() > 2) left.push_back(std::move(half));
      }

      /// Without the segments that lie on the line.
      std::array<Region,2> Halves (const Region & region, const Line & line) const
      {
        std::array<Region,2> halves;                // on the positive and the negative side
        std::vector<double> d;
        for (auto & p : region.polygon) d.push_back(Snapped(line, p));
        auto polygons = Split(region.polygon, d);
        for (int k : { 0, 1 }) halves[k].polygon = std::move(polygons[k]);
        for (auto & segment : region.segments)
          {
            double da = Snapped(line, segment.a), db = Snapped(line, segment.b);
            if (da*db < 0)
              {
                Point on = Lerp(segment.a, segment.b, da/(da-db));
                halves[da > 0 ? 0 : 1].segments.push_back({ segment.line, segment.a, on });
                halves[da > 0 ? 1 : 0].segments.push_back({ segment.line, on, segment.b });
              }
            else if (da != 0 || db != 0)
              halves[da+db > 0 ? 0 : 1].segments.push_back(segment);
          }
        return halves;
      }
    };

    /// A crack that crosses a convex polygon once, from boundary to boundary, beyond a tip along its straight extension.
    class Pass
    {
      const Crack & crack;
      const Polygon & polygon;                    // counter-clockwise
      double tolerance, size;
      struct Stretch { Point a, b; std::optional<Chord> curved; };
      std::vector<Stretch> stretches;                    // in the direction of travel

    public:
      Pass (const Polygon & apolygon, const std::vector<Chord> & chords, const Crack & acrack, double atolerance)
        : crack(acrack), polygon(apolygon), tolerance(atolerance), size(0)
      {
        for (auto & p : polygon) size = std::max(size, Norm(Point(p-polygon[0])));
        for (auto & chord : chords)
          {
            Stretch stretch { crack.PointAt(chord.piece, chord.s0), crack.PointAt(chord.piece, chord.s1), std::nullopt };
            if (!crack.IsStraight(chord.piece)) stretch.curved = chord;
            stretches.push_back(stretch);
          }
        auto & first = chords.front(), & last = chords.back();
        if (first.s0 <= tolerance && IsInside(stretches.front().a))
          stretches.insert(stretches.begin(), { Exit(stretches.front().a, Point(-1*crack.Tangent(first.piece, first.s0))), stretches.front().a, std::nullopt });
        if (last.s1 >= crack.Length()-tolerance && IsInside(stretches.back().b))
          stretches.push_back({ stretches.back().b, Exit(stretches.back().b, crack.Tangent(last.piece, last.s1)), std::nullopt });
      }

      /// Appends the triangles of both sides; false if one of them has no point that sees the whole crack.
      bool Append (std::vector<Part> & parts) const
      {
        Point start = stretches.front().a, end = stretches.back().b;
        std::vector<Part> both;
        bool seen = AppendSide(Loop(end, start), Side::Plus, both) && AppendSide(Loop(start, end), Side::Minus, both);
        if (seen) parts.insert(parts.end(), both.begin(), both.end());
        return seen;
      }

    private:
      struct Place { size_t edge; double along; };

      Point Corner (size_t i) const { return polygon[i % polygon.size()]; }

      Place PlaceOf (Point p) const
      {
        size_t best = 0;
        for (size_t i = 1; i < polygon.size(); i++)
          if (Distance(p, Corner(i), Corner(i+1)) < Distance(p, Corner(best), Corner(best+1))) best = i;
        return { best, Dot(Point(p-Corner(best)), Point(Corner(best+1)-Corner(best))) };
      }

      bool IsInside (Point p) const
      {
        auto [edge, along] = PlaceOf(p);
        return Distance(p, Corner(edge), Corner(edge+1)) > 2*tolerance;
      }

      /// Where the ray from a point inside leaves.
      Point Exit (Point p, Point direction) const
      {
        double nearest = std::numeric_limits<double>::infinity();
        for (size_t i = 0; i < polygon.size(); i++)
          {
            Point edge = Corner(i+1)-Corner(i);
            double rate = Cross(direction, edge), t = Cross(Point(Corner(i)-p), edge)/rate;
            if (rate > 0 && t >= 0) nearest = std::min(nearest, t);
          }
        return Point(p + nearest*direction);
      }

      /// The boundary of the polygon, counter-clockwise between two points of it.
      Polygon Loop (Point from, Point to) const
      {
        auto a = PlaceOf(from), b = PlaceOf(to);
        size_t n = polygon.size(), corners = (b.edge+n-a.edge) % n;
        if (corners == 0 && b.along < a.along) corners = n;
        Polygon loop { from };
        for (size_t i = 1; i <= corners; i++) loop.push_back(Corner(a.edge+i));
        loop.push_back(to);
        return loop;
      }

      /// The least sine of the angle between the crack and the rays from A, positive if A is on the given side of all of it.
      double Visibility (Point A, int sign) const
      {
        double least = 1;
        auto see = [&] (Point p, Point tangent, bool end)
        {
          Point ray = p-A;
          if (Norm(ray) <= tolerance) return;
          double sine = sign*Cross(ray, tangent)/(Norm(ray)*Norm(tangent));
          if (!end || sine < -1e-7) least = std::min(least, sine);       // it may touch an edge of T where it ends
        };
        for (auto & stretch : stretches)
          {
            Point d = stretch.b-stretch.a;
            if (Norm(d) <= tolerance) continue;
            if (!stretch.curved)
              {
                if (Norm(Point(A-stretch.a)) > tolerance && Norm(Point(A-stretch.b)) > tolerance) { see(stretch.a, d, false); see(stretch.b, d, false); }
                continue;
              }
            for (double t : { 0.0, 0.02, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 0.98, 1.0 })
              {
                double s = stretch.curved->s0 + t*(stretch.curved->s1-stretch.curved->s0);
                see(crack.PointAt(stretch.curved->piece, s), crack.Tangent(stretch.curved->piece, s), t == 0 || t == 1);
              }
          }
        return least;
      }

      std::optional<Point> Apex (const Polygon & loop, int sign) const
      {
        Polygon candidates = loop;
        for (size_t i = 0; i+1 < loop.size(); i++) candidates.push_back(Lerp(loop[i], loop[i+1], 0.5));
        Point best = candidates[0];
        double most = -1;
        for (auto & p : candidates)
          if (double v = Visibility(p, sign); v > most) { most = v; best = p; }
        return most > 1e-9 ? std::optional(best) : std::nullopt;
      }

      double Thickness (const Polygon & loop) const
      {
        double thickness = 0;
        for (auto & p : loop) thickness = std::max(thickness, crack.Nearest(p).distance);
        return thickness;
      }

      bool AppendSide (const Polygon & loop, Side side, std::vector<Part> & parts) const
      {
        auto apex = Apex(loop, int(side));
        if (!apex) return Thickness(loop) <= 10*tolerance && loop.size() <= 3;     // nothing but round-off
        auto append = [&] (Part part)
        { if (Area(part, crack) > 1e-18*size*size) parts.push_back(part); };
        for (size_t i = 0; i+1 < loop.size(); i++)
          append({ { *apex, loop[i], loop[i+1] }, side, std::nullopt });
        for (auto & stretch : stretches)
          append({ { *apex, stretch.a, stretch.b }, side, stretch.curved });
        return true;
      }
    };

    class CurvedDivision
    {
      const Crack & crack;
      double tolerance;
      std::vector<Part> & parts;

    public:
      CurvedDivision (const Crack & acrack, double atolerance, std::vector<Part> & aparts)
        : crack(acrack), tolerance(atolerance), parts(aparts) { }

      void Append (const Polygon & polygon, const std::vector<Chord> & chords, int depth)
      {
        if (chords.empty())
          {
            Side side = crack.SideOf(Centre(polygon));
            for (auto & t : Fan(polygon)) parts.push_back({ t, side, std::nullopt });
            return;
          }
        for (size_t i = 0; i+1 < chords.size(); i++)
          if (chords[i+1].s0-chords[i].s1 > tolerance)
            return Cut(polygon, chords, 0.5*(chords[i].s1+chords[i+1].s0), depth);
        if (std::all_of(chords.begin(), chords.end(), [&] (auto & chord) { return crack.IsStraight(chord.piece); }))
          {
            auto divided = StraightDivision(polygon, chords, crack, tolerance).Parts();
            parts.insert(parts.end(), divided.begin(), divided.end());
            return;
          }
        if (Pass(polygon, chords, crack, tolerance).Append(parts)) return;
        for (size_t i = 0; i+1 < chords.size(); i++)
          if (chords[i+1].piece == chords[i].piece || crack.IsKink(chords[i+1].piece)) return Cut(polygon, chords, chords[i].s1, depth);
        Cut(polygon, chords, 0.5*(chords.front().s0+chords.back().s1), depth);
      }

    private:
      /// Divides along the normal of the crack at arc length s, which must not meet the crack again.
      void Cut (const Polygon & polygon, const std::vector<Chord> & chords, double s, int depth)
      {
        size_t piece = crack.PieceAt(s);
        Point m = crack.PointAt(piece, s), t = crack.Tangent(piece, s);
        if (s == crack.ArcLength(piece+1) && piece+1 < crack.NumPieces()) t = Point(t + crack.Tangent(piece+1, s));
        std::array<std::vector<Chord>,2> halves;              // ahead and behind
        for (auto chord : chords)
          {
            if (chord.s1 > s+tolerance) halves[0].push_back({ chord.piece, std::max(chord.s0, s), chord.s1 });
            if (chord.s0 < s-tolerance) halves[1].push_back({ chord.piece, chord.s0, std::min(chord.s1, s) });
          }
        bool clear = depth > 0;
        for (int k : { 0, 1 })
          for (auto & chord : halves[k])
            for (int i = 0; i <= 8; i++)
              {
                double along = Dot(Point(crack.PointAt(chord.piece, chord.s0 + i/8.*(chord.s1-chord.s0))-m), t);
                clear = clear && (k == 0 ? along : -along) > -2*tolerance*Norm(t);
              }
        if (!clear)
          throw Exception("CrackedMesh: the crack turns too much inside of an element near " + ToString(m) + "; refine the mesh there");
        std::vector<double> d;
        for (auto & p : polygon)
          {
            double di = Dot(Point(p-m), t)/Norm(t);
            d.push_back(std::abs(di) <= tolerance ? 0 : di);
          }
        auto polygons = Split(polygon, d);
        for (int k : { 0, 1 })
          if (polygons[k].size() > 2) Append(polygons[k], halves[k], depth-1);
      }
    };
  }

  std::vector<Part> Divide (const Polygon & polygon, const std::vector<Chord> & chords, const Crack & crack, double tolerance)
  {
    if (std::all_of(chords.begin(), chords.end(), [&] (auto & chord) { return crack.IsStraight(chord.piece); }))
      return StraightDivision(polygon, chords, crack, tolerance).Parts();
    Polygon oriented = polygon;
    if (Cross(Point(oriented[1]-oriented[0]), Point(oriented[2]-oriented[0])) < 0) std::reverse(oriented.begin(), oriented.end());
    std::vector<Part> parts;
    CurvedDivision(crack, tolerance, parts).Append(oriented, chords, 24);
    return parts;
  }
}
