#include "rules/body_rules.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngfem::IntegrationRule, ngfem::IntegrationPoint;

  void RuleTable :: AddGauss (size_t element, int order)
  {
    auto [it, is_new] = gauss.insert({ order, int(rules.size()) });
    if (is_new) rules.push_back(std::make_unique<ElementRule>(ngfem::SelectIntegrationRule(ngfem::ET_TRIG, order).Copy()));
    index[element] = it->second;
  }

  bool RuleKind :: operator< (const RuleKind & other) const
  {
    auto rest = [] (const RuleKind & kind) { return std::tuple(kind.domain, kind.crack, bool(kind.division)); };
    if (rest(*this) != rest(other) || !division) return rest(*this) < rest(other);
    return division->Compare(*other.division) < 0;
  }

  TipDisks Merged (TipDisks a, const TipDisks & b)
  {
    for (auto & [tip, disk] : b)
      {
        auto & here = a.insert({ tip, disk }).first->second;
        here.breaks.insert(disk.breaks.begin(), disk.breaks.end());
        here.tolerance = std::min(here.tolerance, disk.tolerance);
        here.smoothness = std::min(here.smoothness, disk.smoothness);
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
      const RuleKind & kind;
      int order;

    public:
      RuleMaker (const CrackedMesh & abody, const std::vector<TipQuadrature> & atips, const RuleKind & akind, int aorder)
        : body(abody), mesh(*body.GetMesh()), tips(atips), kind(akind), order(aorder) { }

      shared_ptr<RuleTable> Table (VorB vb) const
      { return vb == BND ? BoundaryTable() : kind.domain == Domain::Crack ? CrackTable() : VolumeTable(); }

    private:
      std::vector<const TipQuadrature*> TipsNear (const Triangle & t) const
      {
        std::vector<const TipQuadrature*> near;
        for (auto & tip : tips)
          if (MeetsDisk(t, tip.tip, tip.Radius())) near.push_back(&tip);
        return near;
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
            if (auto tip = TipsNear(t); tip.empty()) AppendTriangle(t, order, rule);
            else AppendTriangleNearTip(t, order, **std::min_element(tip.begin(), tip.end(), [&] (auto p, auto q)
              { return Norm(Point(p->tip-Centre(polygon))) < Norm(Point(q->tip-Centre(polygon))); }), rule);
      }

      /// Halved where it meets two disks; then the disk nearer to the crack's part decides.
      void AppendCurvedPart (const Piece & piece, const Crack & crack, PointRule & rule, int depth = 3) const
      {
        auto near = TipsNear(piece.triangle);
        auto [segment, s0, s1] = *piece.curved;
        if (near.empty()) return AppendCone(piece, crack, order, rule);
        double middle = 0.5*(s0+s1);
        Point apex = piece.triangle[0], m = crack.PointAt(segment, middle);
        if (near.size() > 1 && depth > 0)
          {
            AppendCurvedPart({ { apex, piece.triangle[1], m }, piece.side, Chord { segment, s0, middle } }, crack, rule, depth-1);
            AppendCurvedPart({ { apex, m, piece.triangle[2] }, piece.side, Chord { segment, middle, s1 } }, crack, rule, depth-1);
          }
        else
          AppendConeNearTip(piece, crack, order, **std::min_element(near.begin(), near.end(), [&] (auto p, auto q)
            { return Norm(Point(p->tip-m)) < Norm(Point(q->tip-m)); }), rule);
      }

      /// points: in the straight triangle of the element.
      std::unique_ptr<ElementRule> MakeRule (const PointRule & points, const ElementMap & map) const
      {
        double det = 2*Area(map.Corners());
        IntegrationRule ir;
        for (auto & [p, weight] : points)
          {
            Point reference = map.Reference(p);
            ir.Append(IntegrationPoint(reference(0), reference(1), 0, weight/det));
          }
        ir.SetDim(2);
        return std::make_unique<ElementRule>(std::move(ir));
      }

      void AppendPiece (const CutElement & cut, const ElementPart & part, PointRule & rule) const
      {
        if (part.piece.curved) AppendCurvedPart(part.piece, cut.CrackOf(body.Cracks(), part), rule);
        else AppendPart(part.piece.triangle, rule);
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
        if (auto cut = body.Find(element))
          {
            auto belongs = [&] (const ElementPart & part)
            {
              if (kind.domain == Domain::Bulk) return true;
              for (size_t k = 0; k < cut->cracks.size(); k++)
                if (part.larger[k] && (!kind.crack || cut->cracks[k].crack == *kind.crack)) return true;
              return false;
            };
            auto maker = map.IsCurved() ? Raised() : *this;
            for (auto & part : cut->parts)
              if (belongs(part)) maker.AppendPiece(*cut, part, points);
          }
        else
          AppendPart(map.Corners(), points);
        return MakeRule(points, map);
      }

      shared_ptr<RuleTable> VolumeTable () const
      {
        auto table = make_shared<RuleTable>(mesh.GetNE(VOL));
        for (size_t element = 0; element < mesh.GetNE(VOL); element++)
          {
            if (body.Find(element))
              {
                table->Add(element, VolumeRule(element));
                continue;
              }
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

      void AppendCrack (const ElementLocation & location, const Crack & crack, const std::vector<double> & division, PointRule & rule) const
      {
        auto near = TipsNear(location.triangle);
        double tolerance = geometric_tolerance*location.h;
        for (auto & chord : location.chords)
          {
            std::vector<double> cuts { chord.s0, chord.s1 };
            auto cut = [&] (double s) { if (s > chord.s0+tolerance && s < chord.s1-tolerance) cuts.push_back(s); };
            for (auto s = std::ranges::lower_bound(division, chord.s0); s != division.end() && *s < chord.s1; ++s) cut(*s);
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

      shared_ptr<RuleTable> CrackTable () const
      {
        auto table = make_shared<RuleTable>(mesh.GetNE(VOL));
        ArcLengths none({});
        auto & division = kind.division ? dynamic_cast<const ArcLengths&>(*kind.division) : none;
        for (auto & [element, cut] : body.CutElements())
          {
            ElementMap map(mesh, element);
            auto maker = map.IsCurved() ? Raised() : *this;
            PointRule points;
            for (auto & here : cut.cracks)
              if (!kind.crack || *kind.crack == here.crack)
                maker.AppendCrack(*here.location, body.GetCrack(here.crack), division.On(here.crack), points);
            if (map.IsCurved()) Straighten(points, map);
            table->Add(element, MakeRule(points, map));
          }
        return table;
      }

      /// Points on Γ_C in the straight triangle, with weights for NGSolve, which multiplies by the Jacobian there.
      static void Straighten (PointRule & points, const ElementMap & map)
      {
        for (auto & [p, weight] : points)
          {
            p = map.Inverse(p).value();
            auto [value, d0, d1] = map.At(p);
            weight /= Cross(d0, d1);
          }
      }

      std::vector<const TipQuadrature*> TipsNearEdge (size_t element) const
      {
        auto v = mesh.GetElement(ElementId(BND, element)).Vertices();
        std::vector<const TipQuadrature*> near;
        for (auto & tip : tips)
          if (Distance(tip.tip, mesh.GetPoint<2>(v[0]), mesh.GetPoint<2>(v[1])) < (1-1e-9)*tip.Radius() && IsInterface(mesh, element)) near.push_back(&tip);
        return near;
      }

      /// The part of an edge from p to q, that lies in disks of tips: in that of the nearest.
      void AppendEdge (Point p, Point q, const std::vector<const TipQuadrature*> & near, PointRule & points) const
      {
        Point middle = Lerp(p, q, 0.5);
        AppendSegmentBesideTip(p, q, order, **std::min_element(near.begin(), near.end(), [&] (auto s, auto t)
          { return Norm(Point(s->tip-middle)) < Norm(Point(t->tip-middle)); }), points);
      }

      /// cuts: where cracks cross the edge, on the reference segment, which runs from the second vertex (0) to the first (1).
      std::unique_ptr<ElementRule> BoundaryRule (size_t element, std::vector<double> cuts) const
      {
        auto v = mesh.GetElement(ElementId(BND, element)).Vertices();
        Point a = mesh.GetPoint<2>(v[1]), ab = mesh.GetPoint<2>(v[0])-a;
        auto near = TipsNearEdge(element);
        for (auto tip : near)                             // divided half-way between two tips
          for (auto other : near)
            if (double x = Dot(Point(Lerp(tip->tip, other->tip, 0.5)-a), Point(other->tip-tip->tip)) / Dot(ab, Point(other->tip-tip->tip)); x > 0 && x < 1)
              cuts.push_back(x);
        cuts.insert(cuts.end(), { 0, 1 });
        std::sort(cuts.begin(), cuts.end());
        IntegrationRule ir;
        for (size_t i = 0; i+1 < cuts.size(); i++)
          {
            double x0 = cuts[i], length = cuts[i+1]-x0;
            PointRule points;
            if (!near.empty() && length > 0) AppendEdge(Point(a+x0*ab), Point(a+cuts[i+1]*ab), near, points);
            for (auto & [x, weight] : points)
              ir.Append(IntegrationPoint(Dot(Point(x-a), ab)/Dot(ab, ab), 0, 0, weight/Norm(ab)));
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
        auto table = make_shared<RuleTable>(mesh.GetNE(BND));
        for (auto & [element, on_edge] : cuts) table->Add(element, BoundaryRule(element, on_edge));
        return table;
      }
    };
  }

  BodyRules :: BodyRules (shared_ptr<const CrackedMesh> abody, TipDisks adisks) : body(std::move(abody)), disks(std::move(adisks))
  {
    for (auto & [tip, disk] : disks)
      tips.push_back({ body->Tips().at(tip).curve, body->Tips()[tip].point, disk.breaks, disk.tolerance, disk.smoothness });
  }

  shared_ptr<const RuleTable> BodyRules :: Table (const RuleKind & kind, VorB vb, int order) const
  {
    body->CheckMesh();
    std::lock_guard guard(mutex);
    auto & table = tables[{ kind, vb, order }];
    if (!table) table = RuleMaker(*body, tips, kind, order).Table(vb);
    return table;
  }

  shared_ptr<const BodyRules> RulesOf (shared_ptr<const CrackedMesh> body, const TipDisks & disks)
  {
    static std::mutex mutex;
    static std::map<std::pair<const CrackedMesh*, TipDisks>, std::weak_ptr<const BodyRules>> known;
    std::lock_guard guard(mutex);
    std::erase_if(known, [] (auto & item) { return item.second.expired(); });
    auto & kept = known[{ body.get(), disks }];
    auto rules = kept.lock();
    if (!rules) kept = rules = make_shared<BodyRules>(body, disks);
    return rules;
  }
}
