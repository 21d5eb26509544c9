#include "cut/element_location.hpp"
#include <algorithm>

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

  CrackLocation :: CrackLocation (const MeshAccess & amesh, const Crack & acrack, std::vector<double> ameetings)
    : mesh(amesh), crack(acrack), meetings(std::move(ameetings))
  {
    auto beside = ElementsBeside(mesh, crack);
    if (beside.empty())
      throw Exception("CrackedMesh: the crack from " + ToString(crack.Points().front()) + " to " + ToString(crack.Points().back())
                      + " lies outside the body; give its points in the mesh's coordinates");
    double h = std::numeric_limits<double>::infinity();
    for (auto element : beside)
      h = std::min(h, LongestEdge(VerticesOf(mesh, element)));
    tolerance = geometric_tolerance * h;
    for (auto element : beside)
      LocateElement(element);
    ends = { LocateEnd(0, beside), LocateEnd(crack.Length(), beside) };
  }

  void CrackLocation :: Complete ()
  {
    for (auto & location : elements)
      {
        std::ranges::sort(location.chords, {}, &Chord::s0);
        MarkDegenerate(location);
      }
    CheckCovered();
    MakeIntervals();
    LocateBoundary();
  }

  std::vector<size_t> ElementsBeside (const MeshAccess & mesh, const Crack & crack)
  {
    std::vector<size_t> beside;
    for (size_t element = 0; element < mesh.GetNE(VOL); element++)
      if (!crack.PiecesNear(BoxAround(ElementMap(mesh, element))).empty()) beside.push_back(element);
    return beside;
  }

  void CrackLocation :: LocateElement (size_t element)
  {
    ElementMap map(mesh, element);
    auto & t = map.Corners();
    ElementLocation location { element, ElementKind::Cut, {}, t, LongestEdge(t), {}, map.IsCurved(), {} };
    for (size_t i : crack.PiecesNear(BoxAround(map)))
      for (auto & clip : ClipPiece(element, map, i))
        {
          if (clip.aligned)
            {
              auto & along = aligned_edges[AlignedEdge(element, t, clip.chord)];
              if (std::ranges::none_of(along, [&] (auto & chord) { return chord.piece == i; })) along.push_back(clip.chord);     // both elements see it
              continue;
            }
          bool tip = (i == 0 && clip.starts_inside) || (i+1 == crack.NumPieces() && clip.ends_inside);
          if (tip) location.kind = ElementKind::Tip;
          location.degeneracy.kink_inside |= (clip.starts_inside && i > 0 && crack.IsKink(i))
            || (clip.ends_inside && i+1 < crack.NumPieces() && crack.IsKink(i+1));
          location.chords.push_back(clip.chord);
          if (location.curved)
            {
              auto straightened = std::make_shared<const Crack>(Crack::Unchecked({ clip.straightened }));
              location.straightened.push_back({ straightened, { 0, 0, straightened->Length() } });
            }
        }
    if (location.chords.empty()) return;
    DivideAtMeetings(location);
    index[element] = elements.size();
    elements.push_back(std::move(location));
  }

  bool CrackLocation :: IsMeeting (double s) const
  { return std::ranges::any_of(meetings, [&] (double meeting) { return std::abs(meeting-s) <= 2*tolerance; }); }

  void CrackLocation :: DivideAtMeetings (ElementLocation & location) const
  {
    ElementMap map(mesh, location.element);
    for (double s : meetings)
      for (size_t i = 0; i < location.chords.size(); i++)
        {
          auto chord = location.chords[i];
          if (s <= chord.s0+tolerance || s >= chord.s1-tolerance) continue;
          location.chords[i].s1 = s;
          location.chords.insert(location.chords.begin()+i+1, { chord.piece, s, chord.s1 });
          if (!location.curved) break;
          auto [straightened, whole] = location.straightened[i];
          double there = straightened->ArcLength(straightened->Nearest(map.Inverse(crack.PointAt(chord.piece, s)).value()));
          location.straightened[i].chord.s1 = there;
          location.straightened.insert(location.straightened.begin()+i+1, { straightened, { 0, there, whole.s1 } });
          break;
        }
  }

  std::vector<ElementChord> CrackLocation :: DividingChords (const ElementLocation & location, size_t number) const
  {
    std::vector<ElementChord> chords;
    auto is_tip = [&] (int end, double s) { return ends[end].kind == EndKind::Tip && s == ends[end].s; };
    for (size_t i = 0; i < location.chords.size(); i++)
      {
        auto & chord = location.chords[i];
        auto & curve = location.curved ? *location.straightened[i].crack : crack;
        chords.push_back({ number, &curve, location.curved ? location.straightened[i].chord : chord, is_tip(0, chord.s0), is_tip(1, chord.s1), IsMeeting(chord.s0) });
      }
    return chords;
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

  void CrackLocation :: Align (size_t edge, size_t owner)
  {
    if (!index.count(owner))
      {
        ElementMap map(mesh, owner);
        index[owner] = elements.size();
        elements.push_back({ owner, ElementKind::Aligned, {}, map.Corners(), LongestEdge(map.Corners()), {}, map.IsCurved(), {} });
      }
    auto & location = elements[index[owner]];
    location.degeneracy.along_edge = true;
    auto & along = aligned_edges.at(edge);
    location.chords.insert(location.chords.end(), along.begin(), along.end());
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

  CrackEnd CrackLocation :: LocateEnd (double s, const std::vector<size_t> & beside) const
  {
    Point p = crack.PointAt(s);
    CrackEnd end { crack.IsClosed() || IsMeeting(s) ? EndKind::Junction : EndKind::Tip, s, p, NodeId(ngfem::NT_CELL, size_t(-1)) };
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
            if (neighbours.Size() == 1) end.kind = EndKind::Mouth;      // ∂Ω goes before another crack
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
            for (auto & chord : location.chords)
              for (double s : { chord.s0, chord.s1 })
                if (auto p = map.Inverse(crack.PointAt(s)); p && Distance(*p, a, b) <= 2*tolerance
                    && Norm(Point(*p-a)) > 2*tolerance && Norm(Point(*p-b)) > 2*tolerance)
                  AddBoundaryEdge({ it->second, a, b, crack.PointAt(s), Norm(Point(*p-a))/Norm(Point(b-a)) });
          }
  }

  /// Neighbours see the same crossing.
  void CrackLocation :: AddBoundaryEdge (const CutBoundaryEdge & edge)
  {
    auto [known, last] = boundary_edges.equal_range(edge.element);
    for (; known != last; ++known)
      if (Norm(Point(known->second.crossing-edge.crossing)) <= 4*tolerance) return;
    boundary_edges.insert({ edge.element, edge });
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
}
