#include "element_location.hpp"
#include <algorithm>
#include <numeric>

namespace ngsxfem_contact
{
  using ngcore::Exception;
  using ngfem::ElementId, ngfem::VOL, ngfem::BND, ngfem::NodeId;

  Triangle VerticesOf (const MeshAccess & mesh, size_t element)
  {
    auto vertices = mesh.GetElement(ElementId(VOL, element)).Vertices();
    return { mesh.GetPoint<2>(vertices[0]), mesh.GetPoint<2>(vertices[1]), mesh.GetPoint<2>(vertices[2]) };
  }

  namespace
  {
    std::string Place (const Triangle & t) { return "near " + ToString(Point(1./3*(t[0]+t[1]+t[2]))); }

    /// Somewhat larger than the triangle.
    Box BoxAround (const Triangle & t) { return BoxOf(t).Grown(1e-3*LongestEdge(t)); }

    void CheckTriangles (const MeshAccess & mesh)
    {
      if (mesh.GetDimension() != 2)
        throw Exception("CrackedMesh: the mesh has dimension " + std::to_string(mesh.GetDimension()) + "; only plane bodies can be cracked");
      for (size_t i = 0; i < mesh.GetNE(VOL); i++)
        if (mesh.GetElType(ElementId(VOL, i)) != ngfem::ET_TRIG)
          throw Exception("CrackedMesh: element " + std::to_string(i)
                          + " is not a triangle; generate the mesh without quads (quad_dominated=False)");
    }
  }

  CrackLocation :: CrackLocation (const MeshAccess & amesh, const Crack & acrack)
    : mesh(amesh), crack(acrack)
  {
    CheckTriangles(mesh);
    auto beside = ElementsBeside();
    double h = std::numeric_limits<double>::infinity();
    for (auto element : beside)
      h = std::min(h, LongestEdge(VerticesOf(mesh, element)));
    tolerance = geometric_tolerance * h;

    std::map<size_t, std::vector<size_t>> aligned;
    for (auto element : beside)
      LocateElement(element, aligned);
    LocateAligned(aligned);
    LocateEnds(beside);
    for (auto & location : elements)
      MarkDegenerate(location);
    CheckCovered();
    MakeIntervals();
    LocateBoundary();
  }

  std::vector<size_t> CrackLocation :: ElementsBeside () const
  {
    std::vector<size_t> beside;
    for (size_t element = 0; element < mesh.GetNE(VOL); element++)
      {
        auto t = VerticesOf(mesh, element);
        if (!crack.PiecesNear(BoxAround(t)).empty()) beside.push_back(element);
      }
    if (beside.empty())
      throw Exception("CrackedMesh: the crack from " + ToString(crack.Points().front()) + " to " + ToString(crack.Points().back())
                      + " lies outside the body; give its points in the mesh's coordinates");
    return beside;
  }

  std::optional<CrackLocation::Clip> CrackLocation :: ClipSegment (const Triangle & t, size_t segment) const
  {
    std::array<double,3> d, along;
    int zeros = 0;
    for (int i = 0; i < 3; i++)
      {
        d[i] = crack.LineDistance(segment, t[i]);
        if (std::abs(d[i]) <= tolerance) { d[i] = 0; zeros++; }
        along[i] = Dot(Point(t[i]-crack.Points()[segment]), crack.Tangent(segment, 0));
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

    double s = crack.ArcLength(segment), length = crack.ArcLength(segment+1)-s;
    bool starts = lo < -tolerance, ends = hi > length+tolerance;
    lo = std::max(lo, 0.0);
    hi = std::min(hi, length);
    if (hi-lo <= tolerance) return std::nullopt;
    return Clip { !crosses, { segment, s+lo, s+hi }, starts, ends };
  }

  std::vector<CrackLocation::Clip> CrackLocation :: ClipPiece (size_t element, const Triangle & t, size_t segment) const
  {
    if (!crack.IsStraight(segment)) return ClipCurve(element, t, segment);
    auto clip = ClipSegment(t, segment);
    return clip ? std::vector<Clip> { *clip } : std::vector<Clip>();
  }

  /// Both neighbours of an edge find the same crossings: its line is the same for them to the last bit.
  std::vector<CrackLocation::Clip> CrackLocation :: ClipCurve (size_t element, const Triangle & t, size_t segment) const
  {
    auto & piece = crack.Piece(segment);
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
    double s = crack.ArcLength(segment);
    std::vector<Clip> clips;
    for (size_t i = 0; i+1 < breaks.size(); i++)
      if (breaks[i+1] > breaks[i] && inside(piece.Value(0.5*(breaks[i]+breaks[i+1])), 0))
        {
          Chord chord { segment, s+piece.ArcLength(breaks[i]), s+piece.ArcLength(breaks[i+1]) };
          bool starts = breaks[i] == 0 && inside(piece.Value(0), 2*tolerance);
          bool ends = breaks[i+1] == piece.End() && inside(piece.Value(piece.End()), 2*tolerance);
          clips.push_back({ false, chord, starts, ends });          // one of two where the crack touches an edge
        }
    std::erase_if(clips, [&] (auto & clip) { return clip.chord.s1-clip.chord.s0 <= tolerance; });
    return clips;
  }

  void CrackLocation :: LocateElement (size_t element, std::map<size_t, std::vector<size_t>> & aligned)
  {
    auto t = VerticesOf(mesh, element);
    ElementLocation location { element, ElementKind::Cut, {}, t, LongestEdge(t) };
    for (size_t i : crack.PiecesNear(BoxAround(t)))
      for (auto & clip : ClipPiece(element, t, i))
        {
          if (clip.aligned)
            {
              aligned[AlignedEdge(element, t, clip.chord)].push_back(element);
              continue;
            }
          bool tip = (i == 0 && clip.starts_inside) || (i+1 == crack.NumSegments() && clip.ends_inside);
          if (tip) location.kind = ElementKind::Tip;
          location.degeneracy.kink_inside |= (clip.starts_inside && i > 0 && crack.IsKink(i))
            || (clip.ends_inside && i+1 < crack.NumSegments() && crack.IsKink(i+1));
          location.chords.push_back(clip.chord);
        }
    if (location.chords.empty()) return;
    if (mesh.GetElement(ElementId(VOL, element)).is_curved)
      throw Exception("CrackedMesh: the crack cuts a curved element " + Place(t)
                      + "; keep the elements beside the crack straight (curve only the outer boundary, away from the mouths)");
    CheckConnected(location);
    SetPieces(location);
    index[element] = elements.size();
    elements.push_back(std::move(location));
  }

  /// The crack may leave an element for a moment and come back, if it does not turn much on the way: on either side of it
  /// the element stays in one piece, as far as neighbours are taken into account.
  void CrackLocation :: CheckConnected (const ElementLocation & location) const
  {
    auto & chords = location.chords;
    for (size_t i = 1; i < chords.size(); i++)
      {
        auto & from = chords[i-1], & to = chords[i];
        if (to.s0-from.s1 <= tolerance) continue;
        bool onward = Dot(crack.Tangent(from.segment, from.s1), crack.Tangent(to.segment, to.s0)) > 0.5;
        if (to.s0-from.s1 > 2*location.h || !onward)
          throw Exception("CrackedMesh: the crack passes more than once through the element " + Place(location.triangle)
                          + "; refine the mesh there (h below the distance of the two passes)");
      }
  }

  void CrackLocation :: SetPieces (ElementLocation & location) const
  {
    location.pieces = Divide(Polygon(location.triangle.begin(), location.triangle.end()), location.chords, crack, tolerance);
    location.area_plus = location.area_minus = 0;
    for (auto & piece : location.pieces)
      (piece.side == Side::Plus ? location.area_plus : location.area_minus) += Area(piece, crack);
  }

  size_t CrackLocation :: AlignedEdge (size_t element, const Triangle & t, const Chord & chord) const
  {
    for (auto edge : mesh.GetElement(ElementId(VOL, element)).Edges())
      {
        auto [v0, v1] = mesh.GetEdgePNums(edge);
        if (std::abs(crack.LineDistance(chord.segment, mesh.GetPoint<2>(v0))) <= tolerance &&
            std::abs(crack.LineDistance(chord.segment, mesh.GetPoint<2>(v1))) <= tolerance)
          return edge;
      }
    throw Exception("CrackedMesh: the element " + Place(t) + " is degenerate, its corners lie on a line; mesh the body anew");
  }

  /// Both neighbours of an aligned edge see the same part of Γ_C; the larger one carries it, of equals that on the plus side.
  void CrackLocation :: LocateAligned (const std::map<size_t, std::vector<size_t>> & aligned)
  {
    for (auto & [edge, neighbours] : aligned)
      {
        std::set<size_t> both(neighbours.begin(), neighbours.end());
        auto first = VerticesOf(mesh, *both.begin()), second = VerticesOf(mesh, *both.rbegin());
        if (both.size() < 2)
          throw Exception("CrackedMesh: the crack runs along the boundary of the body " + Place(first) + "; move it inside");
        bool first_is_plus = crack.SideOf(Centre({ first.begin(), first.end() })) == Side::Plus;
        Side larger = first_is_plus ? LargerSide(Area(first), Area(second)) : LargerSide(Area(second), Area(first));
        size_t owner = (larger == Side::Plus) == first_is_plus ? *both.begin() : *both.rbegin();
        aligned_edges.insert(edge);
        if (!index.count(owner))
          {
            auto t = VerticesOf(mesh, owner);
            ElementLocation location { owner, ElementKind::Aligned, {}, t, LongestEdge(t) };
            SetPieces(location);
            index[owner] = elements.size();
            elements.push_back(std::move(location));
          }
        auto & location = elements[index[owner]];
        location.degeneracy.along_edge = true;
        for (size_t i : crack.PiecesNear(BoxAround(location.triangle)))
          if (auto clip = ClipSegment(location.triangle, i); clip && clip->aligned && AlignedEdge(owner, location.triangle, clip->chord) == edge)
            location.chords.push_back(clip->chord);
        std::sort(location.chords.begin(), location.chords.end(), [] (auto & a, auto & b) { return a.s0 < b.s0; });
        CheckConnected(location);
      }
  }

  void CrackLocation :: MarkDegenerate (ElementLocation & location) const
  {
    auto & d = location.degeneracy;
    for (auto & chord : location.chords)
      for (auto & vertex : location.triangle)
        for (double s : { chord.s0, chord.s1 })
          d.through_vertex |= Norm(Point(crack.PointAt(s)-vertex)) <= 2*tolerance;
    for (auto & end : ends)
      if (end.kind == EndKind::Tip && (std::abs(end.s-location.S0()) <= 2*tolerance || std::abs(end.s-location.S1()) <= 2*tolerance))
        {
          d.tip_on_vertex |= end.node.GetType() == ngfem::NT_VERTEX;
          d.tip_on_edge |= end.node.GetType() == ngfem::NT_EDGE;
        }
  }

  void CrackLocation :: LocateEnds (const std::vector<size_t> & beside)
  {
    ends[0] = LocateEnd(0, beside);
    ends[1] = LocateEnd(crack.Length(), beside);
  }

  CrackEnd CrackLocation :: LocateEnd (double s, const std::vector<size_t> & beside)
  {
    Point p = crack.PointAt(s);
    CrackEnd end { EndKind::Tip, s, p, NodeId(ngfem::NT_CELL, size_t(-1)) };
    bool found = false;
    auto place = [&] (NodeId node)     // a vertex goes before an edge, an edge before a cell
    {
      if (!found || node.GetType() < end.node.GetType()) end.node = node;
      found = true;
    };
    for (auto element : beside)
      {
        auto el = mesh.GetElement(ElementId(VOL, element));
        auto t = VerticesOf(mesh, element);
        for (auto v : el.Vertices())
          if (Norm(Point(mesh.GetPoint<2>(v)-p)) <= 2*tolerance) place(NodeId(ngfem::NT_VERTEX, v));
        for (auto e : el.Edges())
          {
            auto [v0, v1] = mesh.GetEdgePNums(e);
            if (Distance(p, mesh.GetPoint<2>(v0), mesh.GetPoint<2>(v1)) > 2*tolerance) continue;
            place(NodeId(ngfem::NT_EDGE, e));
            ngcore::Array<int> neighbours;
            mesh.GetEdgeElements(e, neighbours);
            if (neighbours.Size() == 1) end.kind = EndKind::Mouth;
          }
        auto side = [&] (int i) { return Cross(Point(t[(i+1)%3]-t[i]), Point(p-t[i])) > 0; };
        if (side(0) == side(1) && side(1) == side(2)) place(NodeId(ngfem::NT_CELL, element));
      }
    if (!found)
      throw Exception("CrackedMesh: the end " + ToString(p) + " of the crack lies outside the body; end it inside (a tip) or exactly on the boundary (a mouth)");
    return end;
  }

  void CrackLocation :: CheckCovered () const
  {
    std::vector<Chord> chords;
    for (auto & location : elements)
      chords.insert(chords.end(), location.chords.begin(), location.chords.end());
    std::sort(chords.begin(), chords.end(), [] (auto & a, auto & b) { return a.s0 < b.s0; });
    double s = 0, allowed = 1e-8*crack.Length();
    for (auto & chord : chords)
      {
        if (chord.s0-s > allowed) break;
        s = std::max(s, chord.s1);
      }
    if (crack.Length()-s > allowed)
      throw Exception("CrackedMesh: the crack leaves the body at " + ToString(crack.PointAt(s)) + "; cut it off there");
  }

  void CrackLocation :: LocateBoundary ()
  {
    std::map<size_t, size_t> boundary_of_edge;
    for (size_t i = 0; i < mesh.GetNE(BND); i++)
      boundary_of_edge[mesh.GetElement(ElementId(BND, i)).Edges()[0]] = i;
    for (auto & location : elements)
      for (auto edge : mesh.GetElement(ElementId(VOL, location.element)).Edges())
        if (auto it = boundary_of_edge.find(edge); it != boundary_of_edge.end())
          {
            auto v = mesh.GetElement(ElementId(BND, it->second)).Vertices();
            Point a = mesh.GetPoint<2>(v[0]), b = mesh.GetPoint<2>(v[1]);
            for (double s : { location.S0(), location.S1() })
              if (Point p = crack.PointAt(s); Distance(p, a, b) <= 2*tolerance
                  && Norm(Point(p-a)) > 2*tolerance && Norm(Point(p-b)) > 2*tolerance)
                boundary_edges[it->second] = { it->second, a, b, p };
          }
  }

  void CrackLocation :: MakeIntervals ()
  {
    for (size_t i = 0; i < elements.size(); i++)
      for (auto & chord : elements[i].chords) intervals.push_back({ chord.s0, chord.s1, 0, i });
    std::ranges::sort(intervals, {}, [] (auto & i) { return std::pair(i.s0, i.s1); });
    double reach = 0;
    for (auto & interval : intervals) interval.reach = reach = std::max(reach, interval.s1);
  }

  const ElementLocation & CrackLocation :: At (double s) const
  {
    s -= 2*tolerance;                  // so that round-off does not choose
    auto ahead = std::ranges::upper_bound(intervals, s, {}, &Interval::s0), best = ahead;
    double off = ahead == intervals.end() ? std::numeric_limits<double>::infinity() : ahead->s0-s;
    while (ahead != intervals.begin() && std::max(0.0, s-(--ahead)->reach) <= off)
      if (double d = std::max(0.0, s-ahead->s1); d <= off) { best = ahead; off = d; }
    return elements[best->location];
  }

  const ElementLocation * CrackLocation :: Find (size_t element) const
  {
    auto it = index.find(element);
    return it == index.end() ? nullptr : &elements[it->second];
  }

  const CutBoundaryEdge * CrackLocation :: FindBoundaryEdge (size_t bnd_element) const
  {
    auto it = boundary_edges.find(bnd_element);
    return it == boundary_edges.end() ? nullptr : &it->second;
  }
}
