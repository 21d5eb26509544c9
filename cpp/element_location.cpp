#include "element_location.hpp"
#include <algorithm>
#include <numeric>

namespace ngsxfem_contact
{
  using ngcore::Exception;
  using ngfem::ElementId, ngfem::VOL, ngfem::BND, ngfem::NodeId;

  double Area (const Triangle & t) { return 0.5*std::abs(Cross(Point(t[1]-t[0]), Point(t[2]-t[0]))); }

  Triangle VerticesOf (const MeshAccess & mesh, size_t element)
  {
    auto vertices = mesh.GetElement(ElementId(VOL, element)).Vertices();
    return { mesh.GetPoint<2>(vertices[0]), mesh.GetPoint<2>(vertices[1]), mesh.GetPoint<2>(vertices[2]) };
  }

  double LongestEdge (const Triangle & t)
  {
    return std::max({ Norm(Point(t[1]-t[0])), Norm(Point(t[2]-t[1])), Norm(Point(t[0]-t[2])) });
  }

  namespace
  {
    std::string Place (const Triangle & t) { return "near " + ToString(Point(1./3*(t[0]+t[1]+t[2]))); }

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
    LocateBoundary();
  }

  std::vector<size_t> CrackLocation :: ElementsBeside () const
  {
    std::vector<size_t> beside;
    auto & points = crack.Points();
    for (size_t element = 0; element < mesh.GetNE(VOL); element++)
      {
        auto t = VerticesOf(mesh, element);
        auto overlap = [&] (size_t i, int k)
        {
          auto [lo, hi] = std::minmax({ t[0](k), t[1](k), t[2](k) });
          double margin = 1e-3*(hi-lo);
          return std::max(points[i](k), points[i+1](k)) >= lo-margin && std::min(points[i](k), points[i+1](k)) <= hi+margin;
        };
        for (size_t i = 0; i < crack.NumSegments(); i++)
          if (overlap(i, 0) && overlap(i, 1))
            { beside.push_back(element); break; }
      }
    if (beside.empty())
      throw Exception("CrackedMesh: the crack from " + ToString(points.front()) + " to " + ToString(points.back())
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
        along[i] = Dot(Point(t[i]-crack.Points()[segment]), crack.Tangent(segment));
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

  void CrackLocation :: LocateElement (size_t element, std::map<size_t, std::vector<size_t>> & aligned)
  {
    auto t = VerticesOf(mesh, element);
    ElementLocation location { element, ElementKind::Cut, {}, t, LongestEdge(t) };
    for (size_t i = 0; i < crack.NumSegments(); i++)
      if (auto clip = ClipSegment(t, i))
        {
          if (clip->aligned)
            {
              aligned[AlignedEdge(element, t, clip->chord)].push_back(element);
              continue;
            }
          bool tip = (i == 0 && clip->starts_inside) || (i+1 == crack.NumSegments() && clip->ends_inside);
          if (tip) location.kind = ElementKind::Tip;
          location.degeneracy.kink_inside |= (clip->starts_inside && i > 0) || (clip->ends_inside && i+1 < crack.NumSegments());
          location.chords.push_back(clip->chord);
        }
    if (location.chords.empty()) return;
    if (mesh.GetElement(ElementId(VOL, element)).is_curved)
      throw Exception("CrackedMesh: the crack cuts a curved element " + Place(t)
                      + "; keep the elements beside the crack straight (curve only the outer boundary, away from the mouths)");
    CheckConnected(location);
    Divide(location);
    index[element] = elements.size();
    elements.push_back(std::move(location));
  }

  void CrackLocation :: CheckConnected (const ElementLocation & location) const
  {
    auto & chords = location.chords;
    for (size_t i = 1; i < chords.size(); i++)
      if (chords[i].s0-chords[i-1].s1 > tolerance)
        throw Exception("CrackedMesh: the crack passes more than once through the element " + Place(location.triangle)
                        + "; refine the mesh there (h below the distance of the two passes)");
  }

  /// T divided along the lines of its chords (at a kink or a tip beyond them, too): convex parts, each on one side.
  void CrackLocation :: Divide (ElementLocation & location) const
  {
    std::vector<Polygon> parts { Polygon(location.triangle.begin(), location.triangle.end()) };
    for (auto & chord : location.chords)
      {
        std::vector<Polygon> divided;
        for (auto & part : parts)
          {
            std::vector<double> d;
            for (auto & p : part)
              {
                double di = crack.LineDistance(chord.segment, p);
                d.push_back(std::abs(di) <= tolerance ? 0 : di);
              }
            for (auto & half : Split(part, d))
              if (half.size() > 2) divided.push_back(half);
          }
        parts = std::move(divided);
      }
    location.area_plus = location.area_minus = 0;
    for (auto & part : parts)
      {
        Side side = crack.SideOf(Centre(part));
        for (auto & t : Fan(part))
          {
            (side == Side::Plus ? location.area_plus : location.area_minus) += Area(t);
            location.pieces.push_back({ t, side });
          }
      }
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
    throw Exception("CrackedMesh: the element " + Place(t) + " is degenerate");
  }

  /// Both neighbours of an aligned edge see the same part of Γ_C; the larger one carries it (the first of equals).
  void CrackLocation :: LocateAligned (const std::map<size_t, std::vector<size_t>> & aligned)
  {
    for (auto & [edge, neighbours] : aligned)
      {
        std::set<size_t> owners(neighbours.begin(), neighbours.end());
        auto first = VerticesOf(mesh, *owners.begin());
        if (owners.size() < 2)
          throw Exception("CrackedMesh: the crack runs along the boundary of the body " + Place(first) + "; move it inside");
        size_t owner = *owners.begin(), other = *owners.rbegin();
        if (Area(VerticesOf(mesh, other)) > (1+1e-8)*Area(first)) owner = other;
        aligned_edges.insert(edge);
        if (!index.count(owner))
          {
            auto t = VerticesOf(mesh, owner);
            ElementLocation location { owner, ElementKind::Aligned, {}, t, LongestEdge(t) };
            Divide(location);
            index[owner] = elements.size();
            elements.push_back(std::move(location));
          }
        auto & location = elements[index[owner]];
        location.degeneracy.along_edge = true;
        for (size_t i = 0; i < crack.NumSegments(); i++)
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
