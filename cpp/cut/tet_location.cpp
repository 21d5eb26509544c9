#include "cut/tet_location.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception, ngcore::Array;
  using ngfem::ElementId, ngfem::VOL;

  constexpr double smallest_angle = M_PI/9;                // between a front and ∂Ω

  SheetLocation :: SheetLocation (const MeshAccess & amesh, const Sheet & asheet, size_t anumber)
    : mesh(amesh), sheet(asheet), number(anumber), kinks(sheet.IsPlanar() ? std::vector<double>() : sheet.GetSurface()->Kinks()), inside_body(sheet.Loops().size()), on_boundary(sheet.Loops().size())
  {
    auto beside = ElementsBeside(mesh, sheet);
    FindHeights(beside);
    for (auto element : beside) LocateElement(element);
    if (cells.empty()) Refuse("lies outside of the body: no element is cut by it", sheet.PointAt(sheet.Loops()[0].Points()[0]));
    FollowSegments();
    MakeFronts();
  }

  void SheetLocation :: Refuse (const string & what, Point3 where) const
  { throw Exception("CrackedMesh: sheet " + std::to_string(number) + " " + what + ", near " + ToString(where)); }

  std::vector<size_t> ElementsBeside (const MeshAccess & mesh, const Sheet & sheet)
  {
    auto [lo, hi] = sheet.Bounds();
    std::vector<size_t> beside;
    std::map<size_t, double> heights;
    double margin = 1e-8*sheet.Size();
    auto height = [&] (size_t v)
    {
      auto [it, isnew] = heights.insert({ v, 0 });
      if (isnew) it->second = sheet.GetPlane().Height(sheet.Flat(mesh.GetPoint<3>(v)));
      return it->second;
    };
    auto meets = [&] (auto vertices, auto && value, double from, double to)
    {
      double least = std::numeric_limits<double>::infinity(), most = -least;
      for (auto v : vertices)
        {
          double x = value(v);
          least = std::min(least, x);
          most = std::max(most, x);
        }
      return most >= from-margin && least <= to+margin;
    };
    for (size_t i = 0; i < mesh.GetNE(VOL); i++)
      {
        auto vertices = mesh.GetElement(ElementId(VOL, i)).Vertices();
        bool in_box = true;
        for (int k = 0; k < 3 && in_box; k++) in_box = meets(vertices, [&] (size_t v) { return mesh.GetPoint<3>(v)(k); }, lo(k), hi(k));
        if (in_box && meets(vertices, height, 0, 0)) beside.push_back(i);
      }
    return beside;
  }

  void SheetLocation :: FindHeights (const std::vector<size_t> & beside)
  {
    std::map<size_t, double> shortest;                     // edge, by vertex
    tolerance = std::numeric_limits<double>::infinity();
    for (auto element : beside)
      for (auto edge : mesh.GetElement(ElementId(VOL, element)).Edges())
        {
          auto [a, b] = mesh.GetEdgePNums(edge);
          double length = Norm(Point3(mesh.GetPoint<3>(b)-mesh.GetPoint<3>(a)));
          for (size_t v : { a, b }) shortest[v] = std::min(shortest.insert({ v, length }).first->second, length);
          tolerance = std::min(tolerance, geometric_tolerance*length);
        }
    for (auto [v, length] : shortest)
      {
        double here = sheet.GetPlane().Height(flat[v] = sheet.Flat(mesh.GetPoint<3>(v)));
        height[v] = std::abs(here) <= geometric_tolerance*length ? 0 : here;
      }
  }

  TraceNode SheetLocation :: NodeOf (const SheetCell & cell, const CutCorner & corner) const
  { return { cell.corners[corner.i], cell.corners[corner.j] }; }

  void SheetLocation :: AddCell (SheetCell cell, const std::vector<CutCorner> & corners)
  {
    bool aligned = corners.size() == 3 && std::ranges::all_of(corners, [] (auto & c) { return c.i == c.j; });
    for (auto & corner : corners)
      {
        auto node = NodeOf(cell, corner);
        auto place = places.insert({ node, sheet.GetPlane().Project(corner.point) }).first;
        cell.polygon.push_back(place->second);
        cell.nodes.push_back(node);
      }
    for (size_t i = 0; i < corners.size(); i++) AddSegment(cell.element, NodeOf(cell, corners[i]), NodeOf(cell, corners[(i+1) % corners.size()]));
    MeetLoops(cell);
    Point centre = Centre(cell.polygon);
    bool enters = !cell.chords.empty();
    if (!enters && !sheet.Contains(centre)) return;
    if (aligned && !cell.neighbour)
      Refuse("runs along the boundary of the body; move it inside", sheet.PointAt(centre));
    if (enters && !kinks.empty() && !IsFaithful(cell.tet, cell.in_space))
      Refuse("has a front nearer to a kink than an element; refine the mesh there", sheet.PointAt(centre));
    cell.kind = enters ? ElementKind::Tip : aligned ? ElementKind::Aligned : ElementKind::Cut;
    if (enters)
      {
        front_elements.insert(cell.element);
        if (cell.neighbour) front_elements.insert(*cell.neighbour);
      }
    if (Cross(Point(cell.polygon[1]-cell.polygon[0]), Point(cell.polygon[2]-cell.polygon[0])) < 0)
      {
        std::ranges::reverse(cell.polygon);
        std::ranges::reverse(cell.nodes);
      }
    cells.push_back(std::move(cell));
  }

  void SheetLocation :: AddSegment (size_t element, TraceNode a, TraceNode b)
  {
    TraceSegment segment { std::min(a, b), std::max(a, b) };
    segments.insert(segment);
    for (auto & node : segment)
      if (node[0] == node[1]) places.insert({ node, sheet.GetPlane().Project(flat.at(node[0])) });
    for (auto face : mesh.GetElement(ElementId(VOL, element)).Faces())
      {
        Array<int> both;
        mesh.GetFacetElements(face, both);
        if (both.Size() > 1) continue;
        std::vector<size_t> v;
        for (auto vertex : mesh.GetFacePNums(face)) v.push_back(vertex);
        auto has = [&] (size_t vertex) { return std::ranges::find(v, vertex) != v.end(); };
        if (!has(a[0]) || !has(a[1]) || !has(b[0]) || !has(b[1])) continue;
        Point3 p = mesh.GetPoint<3>(v[0]), normal = Cross(Point3(mesh.GetPoint<3>(v[1])-p), Point3(mesh.GetPoint<3>(v[2])-p));
        boundary[segment] = 1/Norm(normal) * normal;
      }
  }

  /// The lines of the polygon's sides are the same for both neighbours to the last bit, so that they find the same crossings.
  void SheetLocation :: MeetLoops (SheetCell & cell)
  {
    struct Side { Point a, normal; double sign; };
    auto & polygon = cell.polygon;
    Point centre = Centre(polygon);
    std::vector<Side> sides;
    for (size_t i = 0; i < polygon.size(); i++)
      {
        Point a = polygon[i], b = polygon[(i+1) % polygon.size()];
        if (std::pair(b(0), b(1)) < std::pair(a(0), a(1))) std::swap(a, b);
        double length = Norm(Point(b-a));
        if (length <= tolerance) continue;
        Point normal = Left(Point(1/length * (b-a)));
        sides.push_back({ a, normal, Dot(Point(centre-a), normal) > 0 ? 1. : -1. });
      }
    auto depth = [&] (Point p)
    {
      double least = std::numeric_limits<double>::infinity();
      for (auto & side : sides) least = std::min(least, side.sign*Dot(Point(p-side.a), side.normal));
      return least;
    };
    auto box = BoxOf(polygon).Grown(2*tolerance);
    for (size_t l = 0; l < sheet.Loops().size(); l++)
      {
        auto & loop = sheet.Loops()[l];
        double length = 0;
        for (size_t i : loop.PiecesNear(box))
          {
            auto & piece = loop.Piece(i);
            std::vector<double> breaks { 0, piece.End() };
            for (auto & side : sides) piece.AppendCrossings(side.a, side.normal, breaks);
            std::ranges::sort(breaks);
            for (size_t k = 0; k+1 < breaks.size(); k++)
              {
                double t0 = breaks[k], t1 = breaks[k+1], middle = depth(piece.Value(0.5*(t0+t1)));
                if (!(t1 > t0) || middle < -2*tolerance) continue;
                double s0 = loop.ArcLength(i) + piece.ArcLength(t0), s1 = loop.ArcLength(i) + piece.ArcLength(t1);
                inside_body[l].push_back({ s0, s1 });
                double deepest = std::max({ middle, depth(piece.Value(0.75*t0+0.25*t1)), depth(piece.Value(0.25*t0+0.75*t1)) });
                if (deepest <= tolerance || s1-s0 <= tolerance) continue;
                cell.chords.push_back({ l, { i, s0, s1 } });
                length += s1-s0;
              }
          }
        if (length >= (1-1e-9)*loop.Length())
          Refuse(string(l == 0 ? "lies" : "has a hole that lies") + " inside of one element; it is smaller than an element: refine the mesh there", sheet.PointAt(centre));
      }
  }

  std::vector<size_t> SheetLocation :: ElementsOf (const TraceSegment & segment) const
  {
    std::set<size_t> needed;
    for (auto & node : segment) needed.insert(node.begin(), node.end());
    std::vector<size_t> elements;
    for (auto element : mesh.GetVertexElements(*needed.begin()))
      {
        std::set<size_t> corners;
        for (auto v : mesh.GetElement(ElementId(VOL, element)).Vertices()) corners.insert(v);
        if (std::ranges::includes(corners, needed)) elements.push_back(element);
      }
    return elements;
  }

  void SheetLocation :: FollowSegments ()
  { for (auto & segment : segments) FollowSegment(segment); }

  /// Where straight pieces run along it.
  void SheetLocation :: FollowSegment (const TraceSegment & segment)
  {
    Point a = places.at(segment[0]), b = places.at(segment[1]), d = b-a;
    double length = Norm(d);
    if (length <= 4*tolerance) return;
    auto box = BoxOf(std::array { a, b }).Grown(2*tolerance);
    for (size_t l = 0; l < sheet.Loops().size(); l++)
      for (auto & loop = sheet.Loops()[l]; size_t i : loop.PiecesNear(box))
        {
          if (!loop.IsStraight(i) || std::abs(loop.LineDistance(i, a)) > 2*tolerance || std::abs(loop.LineDistance(i, b)) > 2*tolerance) continue;
          auto along_piece = [&] (Point p) { return Dot(Point(p-loop.Points()[i]), loop.Tangent(i, 0)); };
          auto [from, to] = std::minmax({ along_piece(a), along_piece(b) });
          double u0 = std::max(0.0, from), u1 = std::min(loop.Piece(i).Length(), to), first = loop.ArcLength(i);
          if (u1-u0 <= 4*tolerance) continue;
          if (boundary.contains(segment)) { on_boundary[l].push_back({ first+u0, first+u1 }); continue; }
          for (auto element : ElementsOf(segment)) front_elements.insert(element);
        }
  }

  namespace
  {
    using Ranges = std::vector<std::pair<double,double>>;

    Ranges Union (Ranges ranges, double gap)
    {
      std::ranges::sort(ranges);
      Ranges joined;
      for (auto & [s0, s1] : ranges)
        if (!joined.empty() && s0-joined.back().second <= gap) joined.back().second = std::max(joined.back().second, s1);
        else joined.push_back({ s0, s1 });
      return joined;
    }

    Ranges Without (const Ranges & ranges, const Ranges & removed)
    {
      Ranges left;
      for (auto [s0, s1] : ranges)
        {
          for (auto & [r0, r1] : removed)
            if (r1 > s0 && r0 < s1)
              {
                if (r0 > s0) left.push_back({ s0, r0 });
                s0 = std::max(s0, r1);
              }
          if (s1 > s0) left.push_back({ s0, s1 });
        }
      return left;
    }

    void AppendStretch (const Crack & loop, double s0, double s1, double shortest, std::vector<PiecePtr> & pieces)
    {
      for (size_t i = 0; i < loop.NumPieces(); i++)
        {
          double first = loop.ArcLength(i), last = loop.ArcLength(i+1), from = std::max(s0, first), to = std::min(s1, last);
          if (to-from <= shortest) continue;
          auto & piece = loop.Piece(i);
          if (from == first && to == last) pieces.push_back(loop.Pieces()[i]);
          else pieces.push_back(piece.Between(from == first ? 0 : piece.Parameter(from-first), to == last ? piece.End() : piece.Parameter(to-first)));
        }
    }
  }

  void SheetLocation :: MakeFronts ()
  {
    double gap = 16*tolerance;
    for (size_t l = 0; l < sheet.Loops().size(); l++)
      {
        auto & loop = sheet.Loops()[l];
        double length = loop.Length();
        Ranges ranges;
        for (auto & range : Without(Union(inside_body[l], gap), Union(on_boundary[l], gap)))
          if (range.second-range.first > gap) ranges.push_back(range);
        if (ranges.empty()) continue;
        bool around = ranges.front().first <= gap && ranges.back().second >= length-gap;
        if (around && ranges.size() == 1)
          {
            fronts.push_back(Front(number, l, sheet, loop));
            CheckKinks(fronts.back());
            continue;
          }
        for (size_t i = around ? 1 : 0; i < ranges.size(); i++)
          {
            std::vector<PiecePtr> pieces;
            AppendStretch(loop, ranges[i].first, ranges[i].second, gap, pieces);
            if (around && i+1 == ranges.size()) AppendStretch(loop, ranges[0].first, ranges[0].second, gap, pieces);
            fronts.push_back(Front(number, l, sheet, Crack::Unchecked(pieces)));
            CheckKinks(fronts.back());
            for (bool at_end : { false, true }) CheckEnd(fronts.back(), at_end);
          }
      }
  }

  /// A front keeps on one smooth part of the sheet, which is all that the elements that it passes have of it.
  void SheetLocation :: CheckKinks (const Front & front) const
  {
    for (double place : kinks)
      {
        auto points = front.Curve().Outline(0.2);
        auto [first, last] = std::ranges::minmax(points, {}, [] (Point p) { return p(1); });
        if (first(1) < place && last(1) > place)
          {
            auto there = std::ranges::min_element(points, {}, [place] (Point p) { return std::abs(p(1)-place); });
            Refuse("has a front that passes a kink of the extruded crack, where p2 = " + Digits(place) + "; let the sheet go on through the body there, or round the kink by an arc",
                   sheet.PointAt(Point((*there)(0), place)));
          }
      }
  }

  void SheetLocation :: CheckEnd (const Front & front, bool at_end) const
  {
    double s = at_end ? front.Length() : 0, steepest = -1;
    Point3 x = front.PointAt(s), tangent = front.FrameAt(s)[2];
    Point p = front.Curve().PointAt(s);
    for (auto & [segment, normal] : boundary)
      if (Distance(p, places.at(segment[0]), places.at(segment[1])) <= 32*tolerance) steepest = std::max(steepest, std::abs(Dot(tangent, normal)));
    if (steepest < 0 && !kinks.empty())
      Refuse("has a front nearer to a kink than an element; refine the mesh there", x);
    if (steepest < 0)
      Refuse("has a front that ends inside of the body, which is a fault of the program", x);
    if (steepest < sin(smallest_angle))
      Refuse("has a front that meets the boundary of the body at less than 20 degrees; let it end inside, or cross the boundary more steeply", x);
  }
}
