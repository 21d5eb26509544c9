#include "cracked_mesh.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception;
  using ngfem::IntegrationRule, ngfem::IntegrationPoint;

  void RuleTable :: AddGauss (size_t element, int order)
  {
    auto [it, is_new] = gauss.insert({ order, int(rules.size()) });
    if (is_new) rules.push_back(std::make_unique<ElementRule>(ngfem::SelectIntegrationRule(ngfem::ET_TRIG, order).Copy()));
    index[element] = it->second;
  }

  CrackedMesh :: CrackedMesh (shared_ptr<MeshAccess> amesh, std::vector<Crack> acracks)
    : mesh(amesh), num_elements(amesh->GetNE(VOL)), cracks(std::move(acracks))
  {
    if (cracks.empty()) throw Exception("CrackedMesh: give at least one crack");
    locations.reserve(cracks.size());
    for (auto & crack : cracks)
      locations.emplace_back(*mesh, crack);
    CheckDistinct();
    FindCutElements();
    FindTips();
  }

  size_t CrackedMesh :: Checked (size_t crack) const
  {
    if (crack >= cracks.size())
      throw Exception("CrackedMesh: there is no crack " + std::to_string(crack) + "; the body has " + std::to_string(cracks.size()));
    return crack;
  }

  void CrackedMesh :: CheckMesh () const
  {
    if (mesh->GetNE(VOL) != num_elements)
      throw Exception("CrackedMesh: the mesh has changed since the cracks were located in it; build a new CrackedMesh after refinement");
  }

  void CrackedMesh :: CheckDistinct () const
  {
    for (size_t c = 0; c < cracks.size(); c++)
      for (size_t d = c+1; d < cracks.size(); d++)
        if (auto [distance, place] = Distance(cracks[c], cracks[d]); distance <= locations[c].Tolerance())
          throw Exception("CrackedMesh: cracks " + std::to_string(c) + " and " + std::to_string(d) + " meet near "
                          + ToString(place) + "; crossing and branching are not supported: separate them");
  }

  void CrackedMesh :: FindCutElements ()
  {
    std::map<size_t, std::vector<ElementCrack>> meetings;
    for (size_t c = 0; c < cracks.size(); c++)
      for (auto & location : locations[c].Elements())
        meetings[location.element].push_back({ c, &location, Side::Plus });
    for (auto & [element, meeting] : meetings)
      cut_elements.emplace(element, CutElement(cracks, std::move(meeting)));
  }

  void CrackedMesh :: FindTips ()
  {
    for (size_t c = 0; c < cracks.size(); c++)
      for (auto & end : locations[c].Ends())
        if (end.kind == EndKind::Tip)
          {
            bool at_end = end.s > 0;
            TipCurve curve(cracks[c], at_end);
            tips.push_back({ c, end.s, curve, end.point, curve.Ahead(), at_end ? 1 : -1, 0, "" });
          }
    for (auto & tip : tips) SetClearance(tip);
    tip_quadrature.resize(tips.size());
  }

  void CrackedMesh :: SetClearance (Tip & tip) const
  {
    tip.clearance = std::numeric_limits<double>::infinity();
    auto limit = [&] (double distance, std::string what)
    { if (distance < tip.clearance) { tip.clearance = distance; tip.limit = what; } };
    for (size_t i = 0; i < mesh->GetNE(BND); i++)
      {
        auto el = mesh->GetElement(ElementId(BND, i));
        ngcore::Array<int> neighbours;
        mesh->GetEdgeElements(el.Edges()[0], neighbours);
        if (neighbours.Size() > 1) continue;            // an inner interface
        auto v = el.Vertices();
        limit(Distance(tip.point, mesh->GetPoint<2>(v[0]), mesh->GetPoint<2>(v[1])), "the boundary of the body");
      }
    LimitByCracks(tip, limit);
    for (auto & other : tips)
      if (&other != &tip) limit(0.5*Norm(Point(other.point-tip.point)), "half the way to the tip at " + ToString(other.point));
  }

  void CrackedMesh :: LimitByCracks (const Tip & tip, const std::function<void(double, std::string)> & limit) const
  {
    limit(tip.curve.CurvatureLimit(), "half of the crack's radius of curvature");
    double own_length = tip.curve.ReachLength();
    for (size_t c = 0; c < cracks.size(); c++)
      for (size_t i = 0; i < cracks[c].NumSegments(); i++)
        {
          auto & crack = cracks[c];
          auto & piece = crack.Piece(i);
          double to_start = std::abs(crack.ArcLength(i)-tip.s), to_end = std::abs(crack.ArcLength(i+1)-tip.s);
          double tolerance = 1e-10*crack.Length();
          if (c != tip.crack)
            limit(Norm(Point(piece.Value(piece.Nearest(tip.point))-tip.point)), "crack " + std::to_string(c));
          else if (std::min(to_start, to_end) >= own_length-tolerance)
            limit(Norm(Point(piece.Value(piece.Nearest(tip.point))-tip.point)), "another segment of the same crack");
          else if (std::max(to_start, to_end) > own_length+tolerance)
            // a piece that turns back
            for (double s : piece.Samples(0.02))
              if (std::abs(crack.ArcLength(i)+s-tip.s) >= own_length-tolerance)
                limit(0.98*Norm(Point(piece.PointAt(s)-tip.point)), "the same crack, which turns back");
        }
  }

  const CutElement * CrackedMesh :: Find (size_t element) const
  {
    auto it = cut_elements.find(element);
    return it == cut_elements.end() ? nullptr : &it->second;
  }

  shared_ptr<ngcore::BitArray> CrackedMesh :: CrackElements (std::optional<size_t> crack) const
  {
    if (crack) Checked(*crack);
    auto elements = make_shared<ngcore::BitArray>(mesh->GetNE(VOL));
    elements->Clear();
    for (auto & [element, cut] : cut_elements)
      if (!crack || cut.Find(*crack)) elements->SetBit(element);
    return elements;
  }

  void CrackedMesh :: RequireTipQuadrature (size_t tip, std::set<double> breaks, int smoothness, double tolerance)
  {
    std::lock_guard guard(rule_mutex);
    auto & quadrature = tip_quadrature.at(tip);
    if (!quadrature) quadrature = TipQuadrature { tips[tip].curve, tips[tip].point, {}, tolerance, smoothness };
    quadrature->breaks.merge(breaks);
    quadrature->tolerance = std::min(quadrature->tolerance, tolerance);
    quadrature->smoothness = std::min(quadrature->smoothness, smoothness);
    rule_tables.clear();
    rule_version++;
  }

  shared_ptr<const RuleTable> CrackedMesh :: Rules (const RuleKind & kind, VorB vb, int order) const
  {
    CheckMesh();
    std::lock_guard guard(rule_mutex);
    auto & table = rule_tables[{ kind, vb, order }];
    if (!table)
      {
        if (vb == BND) table = MakeBoundaryTable(order);
        else if (kind.domain == Domain::Crack) table = MakeCrackTable(kind, order);
        else table = MakeVolumeTable(kind, order);
      }
    return table;
  }

  std::vector<const TipQuadrature*> CrackedMesh :: TipsNear (const Triangle & t) const
  {
    std::vector<const TipQuadrature*> near;
    for (auto & quadrature : tip_quadrature)
      if (quadrature && MeetsDisk(t, quadrature->tip, quadrature->Radius())) near.push_back(&*quadrature);
    return near;
  }

  /// Disks reach at most half the way to other tips: divided along the bisectors, each part meets one disk at most.
  void CrackedMesh :: AppendPart (const Triangle & part, int order, PointRule & rule) const
  {
    auto near = TipsNear(part);
    std::vector<Polygon> polygons { Polygon(part.begin(), part.end()) };
    for (size_t i = 0; i < near.size(); i++)
      for (size_t j = i+1; j < near.size(); j++)
        {
          std::vector<Polygon> divided;
          for (auto & polygon : polygons)
            {
              std::vector<double> d;
              for (auto & p : polygon) d.push_back(Dot(Point(p-Lerp(near[i]->tip, near[j]->tip, 0.5)), Point(near[j]->tip-near[i]->tip)));
              for (auto & half : Split(polygon, d))
                if (half.size() > 2) divided.push_back(half);
            }
          polygons = std::move(divided);
        }
    for (auto & polygon : polygons)
      for (auto & t : Fan(polygon))
        if (auto tip = TipsNear(t); tip.empty()) AppendTriangle(t, order, rule);
        else AppendTriangleNearTip(t, order, **std::min_element(tip.begin(), tip.end(), [&] (auto p, auto q)
          { return Norm(Point(p->tip-Centre(polygon))) < Norm(Point(q->tip-Centre(polygon))); }), rule);
  }

  /// Halved where it meets two disks; then the disk nearer to the crack's part decides.
  void CrackedMesh :: AppendCurvedPart (const Piece & piece, const Crack & crack, int order, PointRule & rule, int depth) const
  {
    auto near = TipsNear(piece.triangle);
    auto [segment, s0, s1] = *piece.curved;
    double middle = 0.5*(s0+s1);
    Point apex = piece.triangle[0], m = crack.PointAt(segment, middle);
    if (near.empty())
      AppendCone(piece, crack, order, rule);
    else if (near.size() > 1 && depth > 0)
      {
        AppendCurvedPart({ { apex, piece.triangle[1], m }, piece.side, Chord { segment, s0, middle } }, crack, order, rule, depth-1);
        AppendCurvedPart({ { apex, m, piece.triangle[2] }, piece.side, Chord { segment, middle, s1 } }, crack, order, rule, depth-1);
      }
    else
      AppendConeNearTip(piece, crack, order, **std::min_element(near.begin(), near.end(), [&] (auto p, auto q)
        { return Norm(Point(p->tip-m)) < Norm(Point(q->tip-m)); }), rule);
  }

  std::unique_ptr<ElementRule> CrackedMesh :: MakeRule (const PointRule & points, const Triangle & t) const
  {
    // x = t[2] + ξ (t[0]-t[2]) + η (t[1]-t[2])
    Point a = t[0]-t[2], b = t[1]-t[2];
    double det = Cross(a, b);
    IntegrationRule ir;
    for (auto & [p, weight] : points)
      {
        Point d = p-t[2];
        ir.Append(IntegrationPoint(Cross(d, b)/det, Cross(a, d)/det, 0, weight/std::abs(det)));
      }
    ir.SetDim(2);
    return std::make_unique<ElementRule>(std::move(ir));
  }

  void CrackedMesh :: AppendPiece (const ElementPart & part, int order, PointRule & rule) const
  {
    if (part.piece.curved) AppendCurvedPart(part.piece, cracks[part.crack], order, rule);
    else AppendPart(part.piece.triangle, order, rule);
  }

  std::unique_ptr<ElementRule> CrackedMesh :: MakeVolumeRule (const RuleKind & kind, size_t element, int order) const
  {
    auto t = VerticesOf(*mesh, element);
    PointRule points;
    if (auto cut = Find(element))
      {
        auto belongs = [&] (const ElementPart & part)
        {
          if (kind.domain == Domain::Bulk) return true;
          for (size_t k = 0; k < cut->cracks.size(); k++)
            if (part.larger[k] && (!kind.crack || cut->cracks[k].crack == *kind.crack)) return true;
          return false;
        };
        for (auto & part : cut->parts)
          if (belongs(part)) AppendPiece(part, order, points);
      }
    else
      AppendPart(t, order, points);
    return MakeRule(points, t);
  }

  shared_ptr<RuleTable> CrackedMesh :: MakeVolumeTable (const RuleKind & kind, int order) const
  {
    auto table = make_shared<RuleTable>(mesh->GetNE(VOL));
    for (size_t element = 0; element < mesh->GetNE(VOL); element++)
      {
        if (cut_elements.count(element))
          {
            table->Add(element, MakeVolumeRule(kind, element, order));
            continue;
          }
        auto t = VerticesOf(*mesh, element);
        auto near = TipsNear(t);
        if (near.empty()) continue;
        if (auto gauss = GaussOrder(t, order, *near[0]); gauss && near.size() == 1)
          table->AddGauss(element, *gauss);
        else
          table->Add(element, MakeVolumeRule(kind, element, order));
      }
    return table;
  }

  void CrackedMesh :: AppendCrack (const ElementLocation & location, const Crack & crack, int order,
                                   const std::vector<double> & nodes, PointRule & rule) const
  {
    auto near = TipsNear(location.triangle);
    double tolerance = geometric_tolerance*location.h;
    for (auto & chord : location.chords)
      {
        std::vector<double> cuts { chord.s0, chord.s1 };
        auto cut = [&] (double s) { if (s > chord.s0+tolerance && s < chord.s1-tolerance) cuts.push_back(s); };
        for (double s : nodes) cut(s);
        if (near.size() > 1) cut(0.5*crack.Length());      // a crack inside one element: a tip at either end
        std::sort(cuts.begin(), cuts.end());
        for (size_t i = 0; i+1 < cuts.size(); i++)
          {
            auto at = [&] (double s) { return crack.PointAt(chord.segment, s); };
            Point a = at(cuts[i]), b = at(cuts[i+1]), middle = Lerp(a, b, 0.5);
            auto nearest = std::min_element(near.begin(), near.end(), [&] (auto p, auto q)
            { return Norm(Point(p->tip-middle)) < Norm(Point(q->tip-middle)); });
            auto tip = nearest == near.end() ? nullptr : *nearest;
            if (crack.IsStraight(chord.segment)) AppendSegment(a, b, order, tip, location.h, rule);
            else AppendCurve(crack, { chord.segment, cuts[i], cuts[i+1] }, order, tip, location.h, rule);
          }
      }
  }

  shared_ptr<RuleTable> CrackedMesh :: MakeCrackTable (const RuleKind & kind, int order) const
  {
    auto table = make_shared<RuleTable>(mesh->GetNE(VOL));
    for (auto & [element, cut] : cut_elements)
      {
        PointRule points;
        for (auto & here : cut.cracks)
          if (!kind.crack || *kind.crack == here.crack)
            AppendCrack(*here.location, cracks[here.crack], order, here.crack < kind.nodes.size() ? kind.nodes[here.crack] : std::vector<double>(), points);
        table->Add(element, MakeRule(points, cut.cracks[0].location->triangle));
      }
    return table;
  }

  std::unique_ptr<ElementRule> CrackedMesh :: MakeBoundaryRule (const std::vector<CutBoundaryEdge> & crossings, int order) const
  {
    auto & [element, a, b, first] = crossings[0];
    // the reference segment runs from the second vertex (0) to the first (1)
    std::vector<double> cuts { 0, 1 };
    for (auto & edge : crossings) cuts.push_back(1 - Norm(Point(edge.crossing-a)) / Norm(Point(b-a)));
    std::sort(cuts.begin(), cuts.end());
    IntegrationRule ir;
    for (size_t i = 0; i+1 < cuts.size(); i++)
      for (auto & ip : ngfem::SelectIntegrationRule(ngfem::ET_SEGM, order))
        ir.Append(IntegrationPoint(cuts[i]+(cuts[i+1]-cuts[i])*ip(0), 0, 0, (cuts[i+1]-cuts[i])*ip.Weight()));
    ir.SetDim(1);
    return std::make_unique<ElementRule>(std::move(ir));
  }

  shared_ptr<RuleTable> CrackedMesh :: MakeBoundaryTable (int order) const
  {
    std::map<size_t, std::vector<CutBoundaryEdge>> crossings;
    for (auto & location : locations)
      for (auto & [element, edge] : location.BoundaryEdges()) crossings[element].push_back(edge);
    auto table = make_shared<RuleTable>(mesh->GetNE(BND));
    for (auto & [element, edges] : crossings) table->Add(element, MakeBoundaryRule(edges, order));
    return table;
  }
}
