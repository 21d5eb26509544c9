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
      if (asking && &asking->Rules().Body() == body.get()) with.rules = RulesOf(body, Merged(with.rules->Demands(), asking->Rules().Demands()));
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

  CutDifferentialSymbol CutDifferentialSymbol :: OnCracks (shared_ptr<const CrackedMesh> body, RuleKind kind)
  {
    CutDifferentialSymbol dx(Measure { body, std::move(kind) }, VOL);
    dx.definedonelements = body->CrackElements();
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

  size_t HeapFor (const RuleTable & table, size_t num_elements)
  {
    size_t points = 0;
    for (size_t i = 0; i < num_elements; i++)
      if (auto rule = table.Find(i)) points = std::max<size_t>(points, rule->ir.Size());
    return 10000000 + 8000*points;
  }

  MeasurePoints RulePoints (const CutDifferentialSymbol & symbol, int order)
  {
    MeasurePoints points;
    auto & mesh = *symbol.measure.body->GetMesh();
    auto table = symbol.measure.Rules(symbol.vb, order);
    LocalHeap lh(HeapFor(*table, mesh.GetNE(symbol.vb)), "points of a measure");
    for (auto el : mesh.Elements(symbol.vb))
      {
        if (symbol.definedonelements && !symbol.definedonelements->Test(el.Nr())) continue;
        HeapReset hr(lh);
        auto & trafo = mesh.GetTrafo(el, lh);
        IntegrationRule standard(trafo.GetElementType(), order);
        auto rule = table->Find(el.Nr());
        auto & mir = trafo(rule ? rule->ir : standard, lh);
        for (size_t i = 0; i < mir.Size(); i++)
          {
            points.element.push_back(el.Nr());
            points.xi.push_back(mir[i].IP()(0));
            points.eta.push_back(mir[i].IP()(1));
            points.weight.push_back(mir[i].GetWeight());
            points.x.push_back(mir[i].GetPoint()(0));
            points.y.push_back(mir[i].GetPoint()(1));
          }
      }
    return points;
  }
}
