#include "cut/cracked_mesh.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  CrackedMesh :: CrackedMesh (shared_ptr<MeshAccess> amesh, std::vector<Crack> acracks, bool is_part)
    : mesh(amesh), located_in(*amesh), cracks(std::move(acracks))
  {
    CheckNames();
    CheckTriangles(*mesh);
    BodyBoundary boundary(*mesh, is_part);
    for (size_t c = 0; c < cracks.size(); c++) cracks[c] = FittedToBody(cracks[c], c, boundary, notes);
    FitToEachOther(cracks, *mesh, boundary, notes);
    LocateCracks(AllMeetings(cracks, boundary.Tolerance()));
    CompareNeighbours();
    DivideBoundary();
    FindTips(boundary);
  }

  void CrackedMesh :: LocateCracks (const std::vector<std::vector<double>> & meetings)
  {
    for (size_t c = 0; c < cracks.size(); c++) locations.emplace_back(*mesh, cracks[c], meetings[c]);
    std::map<size_t, std::vector<ElementChord>> chords;
    for (size_t c = 0; c < cracks.size(); c++)
      for (auto & location : locations[c].Elements())
        std::ranges::move(locations[c].DividingChords(location, c), std::back_inserter(chords[location.element]));
    for (auto & [element, some] : chords) cut_elements.try_emplace(element, ElementMap(*mesh, element), cracks, some);
    AlignEdges();
    for (size_t c = 0; c < cracks.size(); c++)
      {
        locations[c].Complete();
        for (auto & location : locations[c].Elements())
          cut_elements.at(location.element).cracks.push_back({ c, &location, location.kind });
      }
  }

  CutElement & CrackedMesh :: CutElementOf (size_t element)
  { return cut_elements.try_emplace(element, ElementMap(*mesh, element), cracks, std::vector<ElementChord>()).first->second; }

  void CrackedMesh :: AlignEdges ()
  {
    for (size_t c = 0; c < cracks.size(); c++)
      for (auto & [edge, chords] : locations[c].AlignedEdges()) AlignEdge(c, edge, chords);
  }

  std::vector<ElementDivision::Interval> CrackedMesh :: Along (size_t element, size_t edge) const
  {
    auto [v0, v1] = mesh->GetEdgePNums(edge);
    auto cut = Find(element);
    if (!cut) return { { 0, 1, 0 } };
    return cut->Along(mesh->GetPoint<2>(std::min(v0, v1)), mesh->GetPoint<2>(std::max(v0, v1)));
  }

  namespace
  {
    struct Common { double t0, t1; size_t first, second; };

    /// Where two lists of intervals overlap by more than round-off.
    std::vector<Common> Overlaps (const std::vector<ElementDivision::Interval> & a, const std::vector<ElementDivision::Interval> & b, double round_off)
    {
      std::vector<Common> common;
      for (auto & i : a)
        for (auto & j : b)
          if (double t0 = std::max(i.t0, j.t0), t1 = std::min(i.t1, j.t1); t1-t0 > round_off) common.push_back({ t0, t1, i.part, j.part });
      return common;
    }
  }

  constexpr double edge_round_off = 4*geometric_tolerance;          // of its length

  /// The element with the larger part beside the edge carries the crack, of equals the one on the plus side.
  void CrackedMesh :: AlignEdge (size_t c, size_t edge, const std::vector<Chord> & chords)
  {
    ngcore::Array<int> both;
    mesh->GetEdgeElements(edge, both);
    auto centre = [&] (size_t element) { auto t = VerticesOf(*mesh, element); return Centre({ t.begin(), t.end() }); };
    if (both.Size() < 2)
      throw Exception("CrackedMesh: the crack runs along the boundary of the body near " + ToString(centre(both[0])) + "; move it inside");
    auto [v0, v1] = mesh->GetEdgePNums(edge);
    Point a = mesh->GetPoint<2>(std::min(v0, v1)), b = mesh->GetPoint<2>(std::max(v0, v1)), ab = b-a;
    auto & crack = cracks[c];
    auto side = [&] (size_t element) { return Dot(Point(centre(element)-a), crack.Normal(chords[0].piece, chords[0].s0)) > 0 ? Side::Plus : Side::Minus; };
    auto least = [&] (size_t element)
    {
      auto cut = Find(element);
      double area = Area(VerticesOf(*mesh, element));
      for (auto & interval : Along(element, edge)) area = cut ? std::min(area, cut->sizes[interval.part]) : area;
      return area;
    };
    double first = least(both[0]), second = least(both[1]);
    bool equal = std::abs(first-second) <= 1e-8*(first+second);
    size_t k = equal ? (side(both[0]) == Side::Plus ? 0 : 1) : first > second ? 0 : 1;
    size_t owner = both[k], neighbour = both[1-k];
    locations[c].Align(edge, owner);
    auto overlaps = Overlaps(Along(owner, edge), Along(neighbour, edge), edge_round_off);
    auto & cut = CutElementOf(owner);
    auto & covered = cut_edges[edge].covered;
    for (auto & chord : chords)
      {
        auto place = [&] (double s) { return Dot(Point(crack.PointAt(chord.piece, s)-a), ab)/Dot(ab, ab); };
        double t0 = place(chord.s0), t1 = place(chord.s1), rate = (chord.s1-chord.s0)/(t1-t0);
        auto [from, to] = std::minmax(t0, t1);
        for (auto & other : covered)
          if (std::min(other.t1, to)-std::max(other.t0, from) > edge_round_off)
            throw Exception("CrackedMesh: two cracks coincide near " + ToString(crack.PointAt(chord.piece, 0.5*(chord.s0+chord.s1))) + "; give what they share once");
        covered.push_back({ from, to });
        for (auto & common : overlaps)
          if (double u0 = std::max(common.t0, from), u1 = std::min(common.t1, to); u1-u0 > edge_round_off)
            {
              auto [s0, s1] = std::minmax({ chord.s0+(u0-t0)*rate, chord.s0+(u1-t0)*rate });
              cut.AddAligned(c, { chord.piece, s0, s1 }, common.first, side(owner), { neighbour, common.second });
            }
      }
  }

  void CrackedMesh :: CompareNeighbours ()
  {
    for (auto & [element, cut] : cut_elements)
      for (auto edge : mesh->GetElement(ElementId(VOL, element)).Edges()) cut_edges[edge];
    for (auto & [edge, here] : cut_edges)
      {
        ngcore::Array<int> both;
        mesh->GetEdgeElements(edge, both);
        if (both.Size() < 2) continue;
        std::ranges::sort(here.covered, {}, &CutEdge::Covered::t0);
        std::set<std::array<size_t,2>> links;
        for (auto & common : Overlaps(Along(both[0], edge), Along(both[1], edge), edge_round_off))
          {
            double t = common.t0;
            bool open = false;
            for (auto & crack : here.covered)
              {
                open = open || std::min(crack.t0, common.t1)-t > edge_round_off;
                t = std::max(t, crack.t1);
              }
            if (open || common.t1-t > edge_round_off) links.insert({ common.first, common.second });
          }
        here.links.assign(links.begin(), links.end());
      }
  }

  void CrackedMesh :: DivideBoundary ()
  {
    for (size_t i = 0; i < mesh->GetNE(BND); i++)
      {
        auto el = mesh->GetElement(ElementId(BND, i));
        ngcore::Array<int> neighbours;
        mesh->GetEdgeElements(el.Edges()[0], neighbours);
        auto element = std::ranges::find_if(neighbours, [&] (int number) { return Find(number); });
        if (element == neighbours.end()) continue;
        DividedBoundary parts;
        auto intervals = Find(*element)->Along(mesh->GetPoint<2>(el.Vertices()[1]), mesh->GetPoint<2>(el.Vertices()[0]));
        for (auto & [t0, t1, part] : intervals)
          {
            parts.ends.push_back(t1);
            parts.sizes.push_back((t1-t0)*EdgeMap(*mesh, i).Length());
            parts.beside.push_back({ size_t(*element), part });
          }
        boundary_parts.emplace(i, std::move(parts));
      }
  }

  void CrackedMesh :: CheckNames () const
  {
    for (size_t c = 0; c < cracks.size(); c++)
      for (size_t d = c+1; d < cracks.size(); d++)
        if (cracks[c].Name().size() && cracks[c].Name() == cracks[d].Name())
          throw Exception("CrackedMesh: cracks " + std::to_string(c) + " and " + std::to_string(d) + " are both named '" + cracks[c].Name() + "'; give each a name of its own");
  }

  size_t CrackedMesh :: CrackNumber (const string & name) const
  {
    string names;
    for (size_t c = 0; c < cracks.size(); c++)
      {
        if (cracks[c].Name().empty()) continue;
        if (cracks[c].Name() == name) return c;
        names += (names.empty() ? "'" : ", '") + cracks[c].Name() + "'";
      }
    throw std::invalid_argument("CrackedMesh: no crack is named '" + name + "'; " + (names.empty() ? "none has a name, see Crack(..., name=)" : "there is " + names));
  }

  std::vector<std::pair<size_t, ngfem::IntegrationPoint>> CrackedMesh :: OnCrack (size_t c, const std::vector<double> & arclengths) const
  {
    CheckMesh();
    auto & crack = GetCrack(c);
    std::vector<std::pair<size_t, ngfem::IntegrationPoint>> points;
    for (double s : arclengths)
      {
        auto element = Location(c).At(crack.Checked(s)).element;
        points.push_back({ element, ElementMap(*mesh, element).PhysicalInReference(crack.PointAt(s), 0) });
      }
    return points;
  }

  void CrackedMesh :: FindTips (const BodyBoundary & boundary)
  {
    for (size_t c = 0; c < cracks.size(); c++)
      for (auto & end : locations[c].Ends())
        if (end.kind == EndKind::Tip)
          {
            bool at_end = end.s > 0;
            TipCurve curve(cracks[c], at_end);
            tips.push_back({ c, end.s, curve, end.point, curve.Ahead(), at_end ? 1 : -1, 0, "" });
          }
    for (auto & tip : tips) SetClearance(tip, boundary);
  }

  void CrackedMesh :: SetClearance (Tip & tip, const BodyBoundary & boundary) const
  {
    tip.distances.push_back({ boundary.Nearest(tip.point).distance, "the boundary of the body" });
    for (size_t c = 0; c < cracks.size(); c++)
      if (c != tip.crack) tip.distances.push_back({ cracks[c].Nearest(tip.point).distance, "crack " + cracks[c].Label(c) });
    tip.clearance = std::numeric_limits<double>::infinity();
    auto limit = [&] (double distance, std::string what)
    { if (distance < tip.clearance) { tip.clearance = distance; tip.limit = what; } };
    for (auto & [distance, what] : tip.distances) limit(distance, what);
    LimitByOwnCrack(tip, limit);
    for (auto & other : tips)
      if (&other != &tip) limit(0.5*Norm(Point(other.point-tip.point)), "half the way to the tip at " + ToString(other.point));
  }

  void CrackedMesh :: LimitByOwnCrack (const Tip & tip, const std::function<void(double, std::string)> & limit) const
  {
    limit(tip.curve.CurvatureLimit(), "half of the crack's radius of curvature");
    auto & crack = cracks[tip.crack];
    double followed = tip.curve.ReachLength(), tolerance = 1e-10*crack.Length();
    for (size_t i = 0; i < crack.NumPieces(); i++)
      {
        auto & piece = crack.Piece(i);
        auto [nearer, farther] = std::minmax({ std::abs(crack.ArcLength(i)-tip.s), std::abs(crack.ArcLength(i+1)-tip.s) });
        if (nearer >= followed-tolerance)
          limit(Norm(Point(piece.Value(piece.Nearest(tip.point))-tip.point)), "another piece of the same crack");
        else if (farther > followed+tolerance)
          // a piece that turns back
          for (double s : piece.Samples(0.02))
            if (std::abs(crack.ArcLength(i)+s-tip.s) >= followed-tolerance)
              limit(0.98*Norm(Point(piece.PointAt(s)-tip.point)), "the same crack, which turns back");
      }
  }

  Frame<2> CrackedMesh :: FrameAt (size_t crack, const ElementCracks<2> *, Point x) const
  {
    Point t = cracks[crack].Tangent(cracks[crack].Nearest(x));
    return { Left(t), { t } };
  }

  size_t CrackedMesh :: CrackAt (const ElementCracks<2> * element, Point x) const
  {
    if (element) return static_cast<const CutElement*>(element)->CrackAt(x).crack;
    return std::ranges::min_element(cracks, {}, [x] (auto & crack) { return crack.Nearest(x).distance; }) - cracks.begin();
  }

  std::vector<std::array<size_t,2>> CrackedMesh :: Links (size_t edge) const
  {
    auto it = cut_edges.find(edge);
    if (it == cut_edges.end()) return { { 0, 0 } };
    return it->second.links;
  }
}
