#include "forms/measure.hpp"
#include <comp.hpp>

namespace ngsxfem_contact
{
  using namespace ngfem;
  using ngcomp::Region;

  Measure Measure :: With (const ngcomp::FESpace & space) const
  {
    Measure with(*this);
    space.TraverseTree([&] (const ngcomp::FESpace & part)
    {
      auto asking = dynamic_cast<const AsksForRules*>(&part);
      if (asking && &asking->Rules().Body() == body.get()) with.rules = with.rules->MergedWith(asking->Rules());
    });
    return with;
  }

  Measure Measure :: With (CoefficientFunction & integrand) const
  {
    Measure with(*this);
    integrand.TraverseDAG([&] (CoefficientFunction & node)
    {
      if (auto proxy = dynamic_cast<ProxyFunction*>(&node))
        with = with.With(*proxy->GetFESpace());
      else if (auto function = dynamic_cast<ngcomp::GridFunctionCoefficientFunction*>(&node))
        with = with.With(*function->GetGridFunction().GetFESpace());
    });
    return with;
  }

  CutDifferentialSymbol CutDifferentialSymbol :: OnCracks (Measure measure)
  {
    CutDifferentialSymbol dx(measure, VOL);
    dx.definedonelements = measure.body->CrackElements();
    return dx;
  }

  CutDifferentialSymbol CutDifferentialSymbol :: For (const shared_ptr<ngcomp::FESpace> & space) const
  {
    CutDifferentialSymbol dx(*this);
    if (space) dx.measure = dx.measure.With(*space);
    return dx;
  }

  CutDifferentialSymbol CutDifferentialSymbol :: Restricted (const Restriction & to) const
  {
    CutDifferentialSymbol dx = For(to.space);
    dx.bonus_intorder = to.bonus_intorder;
    for (const auto & elements : { to.definedonelements, to.crack ? measure.body->CrackElements(to.crack) : nullptr })
      if (elements)
        {
          auto both = make_shared<ngcore::BitArray>(*elements);
          if (dx.definedonelements) both->And(*dx.definedonelements);
          dx.definedonelements = both;
        }
    if (to.fronts)
      {
        auto solid = dynamic_pointer_cast<const CrackedSolid>(measure.body);
        if (!solid) throw ngcore::Exception("this measure is one of a plane body, which has tips and no fronts; give space=V, whose functions at tips the rules serve then");
        dx.measure.rules = dx.measure.rules->MergedWith(*RulesOf(solid, to.fronts));
      }
    if (to.nodes && measure.body->GetMesh()->GetDimension() != 2)
      throw ngcore::Exception("this measure is one of a solid; nodes are arc lengths on the cracks of a plane body");
    if (to.nodes) dx.measure.kind.division = make_shared<ArcLengths>(*to.nodes);
    if (to.crack && dx.measure.kind.domain != Domain::Bulk) dx.measure.kind.crack = to.crack;
    if (!to.definedon) return dx;
    auto region = get_if<Region>(&*to.definedon);
    Region on = region ? *region : Region(measure.body->GetMesh(), vb, get<string>(*to.definedon));
    if (on.Mask().NumSet() == 0)
      throw ngcore::Exception("this measure is restricted to " + (region ? string("an empty region") : "'" + get<string>(*to.definedon) + "'")
                              + ", which matches no " + (vb == VOL ? "material" : "boundary") + " of the mesh; mesh.GetMaterials() and mesh.GetBoundaries() list the names");
    if (on.VB() != vb) throw ngcore::Exception("this measure cannot be restricted to a region of another dimension; body.dx takes materials, body.ds boundaries");
    dx.definedon = on.Mask();
    return dx;
  }

  MeasurePoints RulePoints (const CutDifferentialSymbol & symbol, int order)
  {
    MeasurePoints points;
    auto & mesh = *symbol.measure.body->GetMesh();
    size_t dimension = mesh.GetDimension();
    points.reference.resize(dimension);
    points.place.resize(dimension);
    auto table = symbol.measure.Rules(symbol.vb, order);
    LocalHeap lh(heap_for_points, "points of a measure");
    for (auto el : mesh.Elements(symbol.vb))
      {
        if (symbol.definedonelements && !symbol.definedonelements->Test(el.Nr())) continue;
        HeapReset hr(lh);
        auto & trafo = mesh.GetTrafo(el, lh);
        IntegrationRule standard(trafo.GetElementType(), order);
        auto rule = table->Find(el.Nr());
        auto & ir = rule ? rule->ir : standard;
        for (size_t first = 0; first < ir.Size(); first += points_at_once)
          {
            HeapReset some_points(lh);
            auto some = ir.Range(first, std::min(first+points_at_once, ir.Size()));
            auto & mir = trafo(some, lh);
            for (size_t i = 0; i < mir.Size(); i++)
              {
                points.element.push_back(el.Nr());
                points.weight.push_back(mir[i].GetWeight());
                for (size_t k = 0; k < dimension; k++)
                  {
                    points.reference[k].push_back(mir[i].IP()(k));
                    points.place[k].push_back(mir[i].GetPoint()(k));
                  }
              }
          }
      }
    return points;
  }
}
