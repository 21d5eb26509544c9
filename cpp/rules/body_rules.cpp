#include "rules/body_rules.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngfem::IntegrationRule, ngfem::IntegrationPoint;

  TipDemands Merged (TipDemands a, const TipDemands & b)
  {
    for (auto & [tip, demand] : b)
      {
        auto & here = a.insert({ tip, demand }).first->second;
        here.breaks.insert(demand.breaks.begin(), demand.breaks.end());
        here.tolerance = std::min(here.tolerance, demand.tolerance);
        here.smoothness = std::min(here.smoothness, demand.smoothness);
      }
    return a;
  }

  namespace
  {
    class RuleMaker
    {
      const CrackedMesh & body;
      const MeshAccess & mesh;
      const std::vector<TipQuadrature> & tips;
      const BoxTree & disks;       // of the tips, by their boxes
      const RuleKind & kind;
      int order;

    public:
      RuleMaker (const CrackedMesh & abody, const std::vector<TipQuadrature> & atips, const BoxTree & adisks, const RuleKind & akind, int aorder)
        : body(abody), mesh(*body.GetMesh()), tips(atips), disks(adisks), kind(akind), order(aorder) { }

      shared_ptr<RuleTable> Table (VorB vb) const
      { return vb == BND ? BoundaryTable() : kind.domain == Domain::Crack ? CrackTable() : VolumeTable(); }

    private:
      using Tips = std::vector<const TipQuadrature*>;

      /// Those whose disks meet a place in a box: a triangle, or an element of the mesh.
      template <typename... PLACE>
      Tips TipsIn (const Box & box, const PLACE & ... place) const
      {
        Tips near;
        if (tips.size())
          disks.VisitMeeting(box, [&] (size_t i) { if (tips[i].Disk().Meets(place...)) near.push_back(&tips[i]); });
        std::ranges::sort(near);
        return near;
      }

      Tips TipsNear (const Triangle & t) const { return TipsIn(BoxOf(t), t); }

      /// Of a boundary element.
      Tips TipsNearEdge (size_t element) const
      {
        EdgeMap edge(mesh, element);
        return TipsIn(BoxOf(std::array { edge.Value(0), edge.Value(1) }), mesh, ElementId(BND, element));
      }

      /// nullptr if there is none.
      static const TipQuadrature * Nearest (const Tips & some, Point p)
      {
        auto nearest = std::ranges::min_element(some, {}, [p] (auto tip) { return Norm(Point(tip->tip-p)); });
        return nearest == some.end() ? nullptr : *nearest;
      }

      /// Disks reach at most half the way to other tips: divided along the bisectors, each part meets one disk at most.
      void AppendPart (const Triangle & part, PointRule & rule) const
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
            if (auto tip = Nearest(TipsNear(t), Centre(polygon))) AppendTriangleNearTip(t, order, *tip, rule);
            else AppendTriangle(t, order, rule);
      }

      /// Halved where it meets two disks; then the disk nearer to the crack's part decides.
      void AppendCurvedPart (const PartTriangle & part, PointRule & rule, int depth = 3) const
      {
        auto near = TipsNear(part.triangle);
        if (near.empty()) return AppendCone(part, order, rule);
        auto & [curve, chord] = *part.curved;
        auto [piece, s0, s1] = chord;
        double middle = 0.5*(s0+s1);
        Point apex = part.triangle[0], m = curve->PointAt(piece, middle);
        auto half = [&] (Point a, Point b, double from, double to) { return PartTriangle { { apex, a, b }, part.part, PartTriangle::CurvedSide { curve, { piece, from, to } } }; };
        if (near.size() > 1 && depth > 0)
          {
            AppendCurvedPart(half(part.triangle[1], m, s0, middle), rule, depth-1);
            AppendCurvedPart(half(m, part.triangle[2], middle, s1), rule, depth-1);
          }
        else
          AppendConeNearTip(part, order, *Nearest(near, m), rule);
      }

      template <typename F>
      static std::unique_ptr<ElementRule> MakeRule (const PointRule & points, F && in_reference)
      {
        IntegrationRule ir;
        ir.SetAllocSize(points.size());
        for (auto & [p, weight] : points) ir.Append(in_reference(p, weight));
        ir.SetDim(2);
        return std::make_unique<ElementRule>(std::move(ir));
      }

      void AppendPartTriangle (const PartTriangle & part, PointRule & rule) const
      {
        if (part.curved) AppendCurvedPart(part, rule);
        else AppendPart(part.triangle, rule);
      }

      /// For the Jacobian of a curved element, and a crack that is bent in its coordinates.
      RuleMaker Raised () const
      {
        RuleMaker raised(*this);
        raised.order += 2*body.GetMesh()->GetCurveOrder();
        return raised;
      }

      std::unique_ptr<ElementRule> VolumeRule (size_t element) const
      {
        ElementMap map(mesh, element);
        PointRule points;
        points.reserve(2048);                                // near a tip
        if (auto cut = body.Find(element))
          {
            auto maker = map.IsCurved() ? Raised() : *this;
            for (auto & part : cut->Triangles())
              if (kind.domain == Domain::Bulk || cut->IsLarger(part, kind.crack)) maker.AppendPartTriangle(part, points);
          }
        else
          AppendPart(map.Corners(), points);
        return MakeRule(points, [&] (Point p, double weight) { return map.InReference(p, weight); });
      }

      /// Those with parts of Γ_C beside them, or of one crack: what measures on Γ_C and on larger parts are restricted to.
      shared_ptr<ngcore::BitArray> CrackElements () const { return body.CrackElements(kind.crack); }

      shared_ptr<RuleTable> VolumeTable () const
      {
        auto table = make_shared<RuleTable>(ngfem::ET_TRIG, mesh.GetNE(VOL));
        auto needed = CrackElements();
        for (auto & [element, cut] : body.CutElements())
          if (needed->Test(element)) table->Add(element, VolumeRule(element));
        if (kind.domain == Domain::Larger || tips.empty()) return table;
        for (size_t element = 0; element < mesh.GetNE(VOL); element++)
          {
            if (body.Find(element)) continue;
            auto t = VerticesOf(mesh, element);
            auto near = TipsNear(t);
            if (near.empty()) continue;
            if (auto gauss = GaussOrder(t, order, *near[0]); gauss && near.size() == 1)
              table->AddGauss(element, *gauss);
            else
              table->Add(element, VolumeRule(element));
          }
        return table;
      }

      void AppendFacet (const CutElement & cut, const CrackFacet & facet, const std::vector<double> & division, PointRule & rule) const
      {
        auto & crack = body.GetCrack(facet.crack);
        auto near = TipsNear(cut.Corners());
        auto [piece, s0, s1] = facet.chord;
        double tolerance = geometric_tolerance*cut.h;
        std::vector<double> cuts { s0, s1 };
        auto divide = [&] (double s) { if (s > s0+tolerance && s < s1-tolerance) cuts.push_back(s); };
        for (auto s = std::ranges::lower_bound(division, s0); s != division.end() && *s < s1; ++s) divide(*s);
        if (near.size() > 1) divide(0.5*crack.Length());      // a crack inside one element: a tip at either end
        std::sort(cuts.begin(), cuts.end());
        for (size_t i = 0; i+1 < cuts.size(); i++)
          {
            Point a = crack.PointAt(piece, cuts[i]), b = crack.PointAt(piece, cuts[i+1]);
            auto tip = Nearest(near, Lerp(a, b, 0.5));
            if (crack.IsStraight(piece)) AppendSegment(a, b, order, tip, cut.h, rule);
            else AppendCurve(crack, { piece, cuts[i], cuts[i+1] }, order, tip, cut.h, rule);
          }
      }

      shared_ptr<RuleTable> CrackTable () const
      {
        auto table = make_shared<RuleTable>(ngfem::ET_TRIG, mesh.GetNE(VOL));
        ArcLengths none({});
        auto & division = kind.division ? dynamic_cast<const ArcLengths&>(*kind.division) : none;
        auto needed = CrackElements();
        for (auto & [element, cut] : body.CutElements())
          {
            if (!needed->Test(element)) continue;
            ElementMap map(mesh, element);
            auto maker = map.IsCurved() ? Raised() : *this;
            PointRule points;
            for (auto & facet : cut.Facets())
              if (!kind.crack || *kind.crack == facet.crack) maker.AppendFacet(cut, facet, division.On(facet.crack), points);
            table->Add(element, MakeRule(points, [&] (Point x, double weight) { return map.PhysicalInReference(x, weight); }));
          }
        return table;
      }

      /// cuts: where cracks cross the edge, on the reference segment.
      std::unique_ptr<ElementRule> BoundaryRule (size_t element, std::vector<double> cuts) const
      {
        EdgeMap edge(mesh, element);
        auto near = TipsNearEdge(element);
        for (auto tip : near)                             // divided half-way between two tips
          for (auto other : near)
            if (double x = edge.Crossing(Lerp(tip->tip, other->tip, 0.5), Point(other->tip-tip->tip)); x > 0 && x < 1)
              cuts.push_back(x);
        cuts.insert(cuts.end(), { 0, 1 });
        std::sort(cuts.begin(), cuts.end());
        IntegrationRule ir;
        for (size_t i = 0; i+1 < cuts.size(); i++)
          {
            double x0 = cuts[i], length = cuts[i+1]-x0;
            PointRule points;
            Point p = edge.Value(x0), q = edge.Value(cuts[i+1]);
            if (auto tip = Nearest(near, Lerp(p, q, 0.5)); tip && length > 0) AppendSegmentBesideTip(p, q, order, *tip, points);
            for (auto & [x, weight] : points) ir.Append(edge.InReference(x, weight));
            if (near.empty())
              for (auto & ip : ngfem::SelectIntegrationRule(ngfem::ET_SEGM, order))
                ir.Append(IntegrationPoint(x0+length*ip(0), 0, 0, length*ip.Weight()));
          }
        ir.SetDim(1);
        return std::make_unique<ElementRule>(std::move(ir));
      }

      shared_ptr<RuleTable> BoundaryTable () const
      {
        std::map<size_t, std::vector<double>> cuts;
        for (size_t c = 0; c < body.NumCracks(); c++)
          for (auto & [element, edge] : body.Location(c).BoundaryEdges()) cuts[element].push_back(1-edge.along);
        for (size_t element = 0; !tips.empty() && element < mesh.GetNE(BND); element++)
          if (!TipsNearEdge(element).empty()) cuts[element];
        auto table = make_shared<RuleTable>(ngfem::ET_SEGM, mesh.GetNE(BND));
        for (auto & [element, on_edge] : cuts) table->Add(element, BoundaryRule(element, on_edge));
        return table;
      }
    };
  }

  BodyRules :: BodyRules (shared_ptr<const CrackedMesh> abody, TipDemands ademands) : body(std::move(abody)), demands(std::move(ademands))
  {
    std::vector<Box> boxes;
    for (auto & [tip, demand] : demands)
      {
        tips.push_back({ demand, body->Tips().at(tip).curve, body->Tips()[tip].point });
        boxes.push_back(BoxOf(std::array { tips.back().tip }).Grown(tips.back().Radius()));
      }
    disks = BoxTree(boxes);
  }

  shared_ptr<const RuleTable> BodyRules :: Table (const RuleKind & kind, VorB vb, int order) const
  {
    body->CheckMesh();
    std::lock_guard guard(mutex);
    auto & table = tables[{ kind, vb, order }];
    if (!table) table = RuleMaker(*body, tips, disks, kind, order).Table(vb);
    return table;
  }

  namespace
  {
    KeptRules<CrackedMesh, TipDemands, BodyRules> kept_rules;
  }

  shared_ptr<const MeasureRules> BodyRules :: MergedWith (const MeasureRules & other) const
  { return RulesOf(body, Merged(demands, dynamic_cast<const BodyRules&>(other).Demands())); }

  shared_ptr<const BodyRules> RulesOf (shared_ptr<const CrackedMesh> body, const TipDemands & demands) { return kept_rules.Find(std::move(body), demands); }

  size_t NumKeptRules (const CrackedMesh & body) { return kept_rules.Count(body); }
}
