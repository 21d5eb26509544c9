#include "rules/solid_rules.hpp"
#include "cut/facets.hpp"
#include "rules/curved_rule.hpp"
#include "rules/front_rule.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngfem::IntegrationRule, ngfem::IntegrationPoint, ngfem::ElementId;

  std::optional<FrontDemand> Merged (std::optional<FrontDemand> a, const std::optional<FrontDemand> & b)
  {
    if (!a || !b) return a ? a : b;
    return FrontDemand { std::max(a->radius, b->radius), std::max(a->along, b->along), std::max(a->angular, b->angular), std::max(a->radial, b->radial),
                         std::max(a->order, b->order), std::max(a->beta, b->beta) };
  }

  namespace
  {
    /// Points of an element with weights for what they are on, in NGSolve's reference element.
    std::unique_ptr<ElementRule> InTet (const Tet & t, const PointRule3 & points)
    {
      Point3 a = t[0]-t[3], b = t[1]-t[3], c = t[2]-t[3];
      double jacobian = Dot(a, Cross(b, c));
      IntegrationRule ir;
      ir.SetAllocSize(points.size());
      for (auto & [p, weight] : points)
        {
          if (!(weight > 0)) continue;             // of a part without a volume
          Point3 d = p-t[3];
          ir.Append(IntegrationPoint(Dot(d, Cross(b, c))/jacobian, Dot(a, Cross(d, c))/jacobian, Dot(a, Cross(b, d))/jacobian, weight/std::abs(jacobian)));
        }
      ir.SetDim(3);
      return std::make_unique<ElementRule>(std::move(ir));
    }

    std::unique_ptr<ElementRule> InTriangle (const Triangle3 & t, const PointRule3 & points)
    {
      Point3 a = t[0]-t[2], b = t[1]-t[2], n = Cross(a, b);
      double square = Dot(n, n);
      IntegrationRule ir;
      ir.SetAllocSize(points.size());
      for (auto & [p, weight] : points)
        {
          Point3 d = p-t[2];
          ir.Append(IntegrationPoint(Dot(Cross(d, b), n)/square, Dot(Cross(a, d), n)/square, 0, weight/sqrt(square)));
        }
      ir.SetDim(2);
      return std::make_unique<ElementRule>(std::move(ir));
    }

    class SolidRuleMaker
    {
      const CrackedSolid & body;
      const MeshAccess & mesh;
      const std::optional<FrontDemand> & demand;
      const RuleKind & kind;
      int order;

    public:
      SolidRuleMaker (const CrackedSolid & abody, const std::optional<FrontDemand> & ademand, const RuleKind & akind, int aorder)
        : body(abody), mesh(*body.GetMesh()), demand(ademand), kind(akind), order(aorder) { }

      shared_ptr<RuleTable> Table (VorB vb) const
      { return vb == BND ? BoundaryTable() : kind.domain == Domain::Crack ? CrackTable() : VolumeTable(); }

    private:
      /// With Gauss points that integrate polynomials of the order beside the singular functions.
      FrontDemand Raised () const
      {
        FrontDemand raised = *demand;
        int least = order/2+1;
        for (int * n : { &raised.along, &raised.angular, &raised.radial }) *n = std::max(*n, least);
        raised.order = std::max(raised.order, order);
        return raised;
      }

      /// Those that a body around a centre, an element or a boundary element with these vertices, needs rules for.
      template <typename VERTICES>
      std::vector<const Front*> FrontsNear (Point3 centre, double size, const VERTICES & vertices) const
      {
        std::vector<const Front*> near;
        if (demand)
          for (auto & front : body.Fronts())
            {
              double reach = demand->radius;
              auto & nodes = body.FrontNodes(front.SheetNumber());
              for (auto v : vertices)
                if (auto node = nodes.find(v); node != nodes.end()) reach = std::max(reach, (1+1e-9)*node->second);
              if (reach > 0 && front.Distance(centre) < reach + size) near.push_back(&front);
            }
        return near;
      }

      std::vector<const Front*> FrontsNear (size_t element, const Tet & t) const
      {
        Point3 centre = Centre(t);
        double size = 0;
        for (auto & x : t) size = std::max(size, Norm(Point3(x-centre)));
        return FrontsNear(centre, size, mesh.GetElement(ElementId(VOL, element)).Vertices());
      }

      /// The sheet in whose coordinates a rule around fronts is made. Throws where fronts have no common ones.
      size_t CommonSheet (const std::vector<const Front*> & near, Point3 centre) const
      {
        for (auto front : near)
          if (front->SheetNumber() != near[0]->SheetNumber() && !(front->IsPlanar() && near[0]->IsPlanar()))
            throw ngcore::Exception("CrackedMesh: sheets " + std::to_string(near[0]->SheetNumber()) + " and " + std::to_string(front->SheetNumber())
                                    + ", one of them curved, have fronts too near to each other for rules around both, near " + ToString(centre) + "; refine the mesh there");
        return near[0]->SheetNumber();
      }

      bool Wanted (const CutTet * cut, int side) const
      { return kind.domain == Domain::Bulk || (cut && cut->IsLarger(side) && (!kind.crack || *kind.crack == cut->Sides().crack)); }

      /// t in the coordinates of the fronts.
      void AppendSingular (size_t element, const Tet & t, const CutTet * cut, const FrontRule & around, PointRule3 & points) const
      {
        auto & nearest = around.Nearest(Centre(t));
        auto keep = [&] (const Plane & plane, PointRule3 && some)
        { for (auto & point : some) if (Wanted(cut, plane.Height(point.p) >= 0 ? 1 : -1)) points.push_back(point); };
        PointRule3 some;
        if (!cut || (cut->Sides().crack == nearest.SheetNumber() && around.IsClose(t, nearest)))
          {
            around.AppendTet(t, some, false);
            return keep(nearest.GetPlane(), std::move(some));
          }
        auto parts = Split(cut->Cell().tet, cut->Cell().heights);
        size_t sheet = cut->Sides().crack;
        bool same = sheet == nearest.SheetNumber() || (body.Sheets()[sheet].IsPlanar() && nearest.IsPlanar());
        std::optional<FlatMap> moved;
        if (!same) moved.emplace(body.FlatTet(sheet, element), t);
        for (int side : { 1, -1 })
          if (Wanted(cut, side))
            for (auto part : parts[side > 0 ? 0 : 1])
              {
                if (moved) for (auto & x : part) x = moved->Value(x);
                around.AppendTet(part, points, false);
              }
      }

      std::unique_ptr<ElementRule> VolumeRule (size_t element, const Tet & t, const std::vector<const Front*> & near) const
      {
        auto cut = body.Find(element);
        PointRule3 points;
        if (!near.empty())
          {
            Tet flat = body.FlatTet(CommonSheet(near, Centre(t)), element);
            AppendSingular(element, flat, cut, FrontRule(near, Raised()), points);
            return InTet(flat, points);
          }
        Tet flat = body.FlatTet(cut->Sides().crack, element);
        auto parts = Split(cut->Cell().tet, cut->Cell().heights);
        for (int side : { 1, -1 })
          if (Wanted(cut, side))
            for (auto & part : parts[side > 0 ? 0 : 1]) AppendTet(part, order, points);
        return InTet(flat, points);
      }

      shared_ptr<RuleTable> VolumeTable () const
      {
        auto table = make_shared<RuleTable>(ngfem::ET_TET, mesh.GetNE(VOL));
        for (size_t element = 0; element < mesh.GetNE(VOL); element++)
          if (auto t = MeshParts<3>::TetOf(mesh, element); body.Find(element)) table->Add(element, VolumeRule(element, t, FrontsNear(element, t)));
          else if (auto near = FrontsNear(element, t); !near.empty()) table->Add(element, VolumeRule(element, t, near));
        return table;
      }

      void AppendFacet (const CutTet & cut, const std::vector<const Front*> & near, PointRule & rule) const
      {
        std::vector<const Front*> own;
        std::ranges::copy_if(near, std::back_inserter(own), [&] (auto front) { return front->SheetNumber() == cut.Sides().crack; });
        auto & cell = cut.Cell();
        if (!own.empty())
          FrontRule(own, Raised()).AppendPolygon(cell.polygon, body.Sheets()[cut.Sides().crack], rule);
        else
          for (auto & part : cut.Facet())
            if (part.curved) AppendCone(part, order, rule);
            else AppendTriangle(part.triangle, order, rule);
      }

      shared_ptr<RuleTable> CrackTable () const
      {
        if (kind.division) throw ngcore::Exception("CrackedMesh: rules on sheets cannot be divided");
        auto table = make_shared<RuleTable>(ngfem::ET_TET, mesh.GetNE(VOL));
        for (auto & [element, cut] : body.CutTets())
          {
            auto t = MeshParts<3>::TetOf(mesh, element);
            PointRule in_plane;
            if (!kind.crack || *kind.crack == cut.Sides().crack) AppendFacet(cut, FrontsNear(element, t), in_plane);
            PointRule3 points;
            for (auto & [p, weight] : in_plane) points.push_back({ body.Sheets()[cut.Sides().crack].GetPlane().Value(p), weight*cut.Stretch() });
            table->Add(element, InTet(body.FlatTet(cut.Sides().crack, element), points));
          }
        return table;
      }

      shared_ptr<RuleTable> BoundaryTable () const
      {
        auto table = make_shared<RuleTable>(ngfem::ET_TRIG, mesh.GetNE(BND));
        for (size_t i = 0; i < mesh.GetNE(BND); i++)
          {
            auto v = mesh.GetElement(ElementId(BND, i)).Vertices();
            Triangle3 t = MeshParts<3>::TriangleOf(mesh, i);
            auto divided = body.FindBoundary(i);
            Point3 centre = 1./3*(t[0]+t[1]+t[2]);
            double size = 0;
            for (auto & x : t) size = std::max(size, Norm(Point3(x-centre)));
            auto near = FrontsNear(centre, size, v);
            if (!divided && near.empty()) continue;
            if (!near.empty()) t = body.FlatTriangle(CommonSheet(near, centre), i);
            std::vector<Triangle> parts { { Point(1., 0.), Point(0., 1.), Point(0., 0.) } };
            if (divided)
              {
                auto halves = Split(Polygon(parts[0].begin(), parts[0].end()), { divided->heights.begin(), divided->heights.end() });
                parts.clear();
                for (auto & half : halves) std::ranges::copy(Fan(half), std::back_inserter(parts));
              }
            PointRule3 points;
            auto value = [&] (Point p) { return Point3(t[2] + p(0)*(t[0]-t[2]) + p(1)*(t[1]-t[2])); };
            for (auto & part : parts)
              if (Triangle3 here { value(part[0]), value(part[1]), value(part[2]) }; near.empty()) AppendTriangle(here, order, points);
              else FrontRule(near, Raised()).AppendBoundary(here, points);
            table->Add(i, InTriangle(t, points));
          }
        return table;
      }
    };

    KeptRules<CrackedSolid, std::optional<FrontDemand>, SolidRules> kept_rules;
  }

  SolidRules :: SolidRules (shared_ptr<const CrackedSolid> abody, std::optional<FrontDemand> ademand) : body(std::move(abody)), demand(ademand)
  {
    if (!demand) return;
    auto refuse = [] (const string & what) { throw ngcore::Exception("FrontDemand: " + what); };
    if (!(demand->radius >= 0 && std::isfinite(demand->radius))) refuse("radius=" + Digits(demand->radius) + " must be 0 or positive, and finite");
    if (!(demand->beta > 0 && demand->beta <= 1)) refuse("beta=" + Digits(demand->beta) + " must lie between 0 and 1");
    for (int n : { demand->along, demand->angular, demand->radial, demand->order })
      if (n < 1 || n > 40) refuse("numbers of points and the order lie between 1 and 40, got " + std::to_string(n));
  }

  shared_ptr<const RuleTable> SolidRules :: Table (const RuleKind & kind, VorB vb, int order) const
  {
    body->CheckMesh();
    std::lock_guard guard(mutex);
    auto & table = tables[{ kind, vb, order }];
    if (!table) table = SolidRuleMaker(*body, demand, kind, order).Table(vb);
    return table;
  }

  shared_ptr<const MeasureRules> SolidRules :: MergedWith (const MeasureRules & other) const
  { return RulesOf(body, Merged(demand, dynamic_cast<const SolidRules&>(other).demand)); }

  shared_ptr<const SolidRules> RulesOf (shared_ptr<const CrackedSolid> body, const std::optional<FrontDemand> & demand)
  { return kept_rules.Find(std::move(body), demand); }
}
