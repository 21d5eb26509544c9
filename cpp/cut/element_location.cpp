#include "cut/element_location.hpp"
#include <algorithm>
#include <numeric>

namespace ngsxfem_contact
{
  using ngcore::Exception;
  using ngfem::ElementId, ngfem::VOL, ngfem::BND, ngfem::NodeId;

  namespace
  {
    std::string Place (const Triangle & t) { return "near " + ToString(Point(1./3*(t[0]+t[1]+t[2]))); }

    /// Somewhat larger than the element.
    Box BoxAround (const ElementMap & map) { return BoxOf(map.Corners()).Grown(1e-3*LongestEdge(map.Corners()) + 1.5*map.Bulge()); }
  }

  void CheckTriangles (const MeshAccess & mesh)
  {
    if (mesh.GetDimension() != 2)
      throw Exception("CrackedMesh: the mesh has dimension " + std::to_string(mesh.GetDimension()) + "; only plane bodies can be cracked");
    for (size_t i = 0; i < mesh.GetNE(VOL); i++)
      if (mesh.GetElType(ElementId(VOL, i)) != ngfem::ET_TRIG)
        throw Exception("CrackedMesh: element " + std::to_string(i)
                        + " is not a triangle; generate the mesh without quads (quad_dominated=False)");
  }

  CrackLocation :: CrackLocation (const MeshAccess & amesh, const Crack & acrack)
    : mesh(amesh), crack(acrack)
  {
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
      if (!crack.PiecesNear(BoxAround(ElementMap(mesh, element))).empty()) beside.push_back(element);
    if (beside.empty())
      throw Exception("CrackedMesh: the crack from " + ToString(crack.Points().front()) + " to " + ToString(crack.Points().back())
                      + " lies outside the body; give its points in the mesh's coordinates");
    return beside;
  }

  void CrackLocation :: LocateElement (size_t element, std::map<size_t, std::vector<size_t>> & aligned)
  {
    ElementMap map(mesh, element);
    auto & t = map.Corners();
    ElementLocation location { element, ElementKind::Cut, {}, t, LongestEdge(t), {}, {}, {}, map.IsCurved(), nullptr };
    std::vector<PiecePtr> straightened;
    for (size_t i : crack.PiecesNear(BoxAround(map)))
      for (auto & clip : ClipPiece(element, map, i))
        {
          if (clip.aligned)
            {
              aligned[AlignedEdge(element, t, clip.chord)].push_back(element);
              continue;
            }
          bool tip = (i == 0 && clip.starts_inside) || (i+1 == crack.NumPieces() && clip.ends_inside);
          if (tip) location.kind = ElementKind::Tip;
          location.degeneracy.kink_inside |= (clip.starts_inside && i > 0 && crack.IsKink(i))
            || (clip.ends_inside && i+1 < crack.NumPieces() && crack.IsKink(i+1));
          location.chords.push_back(clip.chord);
          straightened.push_back(clip.straightened);
        }
    if (location.chords.empty()) return;
    CheckConnected(location);
    if (location.curved) Straighten(location, straightened);
    SetParts(location);
    index[element] = elements.size();
    elements.push_back(std::move(location));
  }

  void CrackLocation :: Straighten (ElementLocation & location, const std::vector<PiecePtr> & pieces) const
  {
    for (size_t i = 1; i < pieces.size(); i++)
      if (location.chords[i].s0-location.chords[i-1].s1 > tolerance)
        throw Exception("CrackedMesh: the crack leaves a curved element and comes back " + Place(location.triangle) + "; refine the mesh there, or move the crack");
    StraightenedCrack straightened { Crack(pieces), {} };
    for (size_t i = 0; i < pieces.size(); i++)
      straightened.chords.push_back({ i, straightened.crack.ArcLength(i), straightened.crack.ArcLength(i+1) });
    location.straightened = std::make_shared<const StraightenedCrack>(std::move(straightened));
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
        bool onward = Dot(crack.Tangent(from.piece, from.s1), crack.Tangent(to.piece, to.s0)) > 0.5;
        if (to.s0-from.s1 > 2*location.h || !onward)
          throw Exception("CrackedMesh: the crack passes more than once through the element " + Place(location.triangle)
                          + "; refine the mesh there (h below the distance of the two passes)");
      }
  }

  void CrackLocation :: SetParts (ElementLocation & location) const
  {
    auto & in_triangle = location.CrackInTriangle(crack);
    auto & chords = location.straightened ? location.straightened->chords : location.chords;
    location.parts = Divide(Polygon(location.triangle.begin(), location.triangle.end()), chords, in_triangle, tolerance);
    location.areas = {};
    for (auto & part : location.parts) location.areas[part.side] += Area(part, in_triangle);
  }

  size_t CrackLocation :: AlignedEdge (size_t element, const Triangle & t, const Chord & chord) const
  {
    for (auto edge : mesh.GetElement(ElementId(VOL, element)).Edges())
      {
        auto [v0, v1] = mesh.GetEdgePNums(edge);
        if (std::abs(crack.LineDistance(chord.piece, mesh.GetPoint<2>(v0))) <= tolerance &&
            std::abs(crack.LineDistance(chord.piece, mesh.GetPoint<2>(v1))) <= tolerance)
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
        Side larger = (first_is_plus ? Measures { Area(first), Area(second) } : Measures { Area(second), Area(first) }).Larger();
        size_t owner = (larger == Side::Plus) == first_is_plus ? *both.begin() : *both.rbegin();
        aligned_edges.insert(edge);
        if (!index.count(owner))
          {
            ElementMap map(mesh, owner);
            ElementLocation location { owner, ElementKind::Aligned, {}, map.Corners(), LongestEdge(map.Corners()), {}, {}, {}, map.IsCurved(), nullptr };
            SetParts(location);
            index[owner] = elements.size();
            elements.push_back(std::move(location));
          }
        auto & location = elements[index[owner]];
        location.degeneracy.along_edge = true;
        for (size_t i : crack.PiecesNear(BoxAround(ElementMap(mesh, owner))))
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
        ElementMap map(mesh, element);
        auto & t = map.Corners();
        auto in_triangle = map.Inverse(end.point);
        if (!in_triangle) continue;
        Point p = *in_triangle;
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
            ElementMap map(mesh, location.element);
            for (double s : { location.S0(), location.S1() })
              if (auto p = map.Inverse(crack.PointAt(s)); p && Distance(*p, a, b) <= 2*tolerance
                  && Norm(Point(*p-a)) > 2*tolerance && Norm(Point(*p-b)) > 2*tolerance)
                boundary_edges[it->second] = { it->second, a, b, crack.PointAt(s), Norm(Point(*p-a))/Norm(Point(b-a)) };
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

  bool CrackLocation :: EndsIn (NodeId node, FlatArray<int> support) const
  {
    for (auto & end : ends)
      {
        if (end.kind != EndKind::Tip) continue;
        if (end.node == node) return true;
        if (end.node.GetType() == ngfem::NT_CELL && support.Contains(int(end.node.GetNr()))) return true;
        if (end.node.GetType() == ngfem::NT_EDGE && HasVertex(end.node.GetNr(), node)) return true;
      }
    return false;
  }

  bool CrackLocation :: RunsAlong (NodeId node) const
  { return std::ranges::any_of(aligned_edges, [&] (size_t edge) { return node == NodeId(ngfem::NT_EDGE, edge) || HasVertex(edge, node); }); }

  bool CrackLocation :: HasVertex (size_t edge, NodeId node) const
  {
    auto [v0, v1] = mesh.GetEdgePNums(edge);
    return node == NodeId(ngfem::NT_VERTEX, v0) || node == NodeId(ngfem::NT_VERTEX, v1);
  }

  Side CrackLocation :: SideBeyond (size_t element, size_t edge) const
  {
    // the crack may run along the edge
    ElementMap map(mesh, element);
    auto [v0, v1] = mesh.GetEdgePNums(edge);
    auto & t = map.Corners();
    return crack.SideOf(map.Value(Lerp(Centre({ t[0], t[1], t[2] }), Lerp(mesh.GetPoint<2>(v0), mesh.GetPoint<2>(v1), 0.5), 1.001)));
  }

  std::optional<Measures> CrackLocation :: BoundarySizes (size_t bnd_element) const
  {
    auto it = boundary_edges.find(bnd_element);
    if (it == boundary_edges.end()) return std::nullopt;
    auto & [element, a, b, crossing, along] = it->second;
    Measures sizes;
    for (Point end : { a, b }) sizes[crack.SideOf(Lerp(end, crossing, 0.5))] += Norm(Point(crossing-end));
    return sizes;
  }
}
