#include "forms/form_terms.hpp"

namespace ngsxfem_contact
{
  using namespace ngfem;

  static void CollectFunctions (const shared_ptr<CoefficientFunction> & cf, FormTerm & term)
  {
    auto add = [] (auto & proxies, const shared_ptr<ProxyFunction> & proxy)
    { if (std::find(proxies.begin(), proxies.end(), proxy) == proxies.end()) proxies.push_back(proxy); };
    cf->TraverseDAG([&] (CoefficientFunction & node)
    {
      if (auto proxy = dynamic_pointer_cast<ProxyFunction>(node.shared_from_this()))
        add(proxy->IsTrialFunction() ? term.trial : term.test, proxy);
      if (node.GetDescription() == "normal vector") term.element_normal = true;
    });
  }

  static FormTerm TermOf (const shared_ptr<Integral> & integral)
  {
    auto & dx = integral->dx;
    FormTerm term { integral, nullptr, Domain::Bulk, dx.vb, std::nullopt, dx.definedonelements, nullptr, {}, {}, false };
    if (auto cut = dynamic_pointer_cast<CutIntegral>(integral))
      {
        auto & measure = cut->GetMeasure();
        term.body = measure.body;
        term.domain = measure.kind.domain;
        term.crack = measure.kind.crack;
      }
    if (dx.definedon)
      if (auto regions = get_if<ngcore::BitArray>(&*dx.definedon)) term.regions = make_shared<ngcore::BitArray>(*regions);
    CollectFunctions(integral->cf, term);
    return term;
  }

  std::vector<FormTerm> TermsOf (const SumOfIntegrals & form)
  {
    std::vector<FormTerm> terms;
    for (auto & integral : form.icfs) terms.push_back(TermOf(integral));
    return terms;
  }

  TermPlace PlaceOf (const FormTerm & term)
  {
    auto cut = dynamic_pointer_cast<CutIntegral>(term.integral);
    if (!cut) throw ngcore::Exception("a term over a measure of NGSolve is none of a body");
    auto solid = dynamic_pointer_cast<const SolidRules>(cut->GetMeasure().rules);
    return { term.body, cut->GetMeasure().kind, term.vb, term.integral->dx.bonus_intorder, term.elements, term.regions, solid ? solid->Demand() : std::nullopt };
  }

  FormTerm TermAt (const TermPlace & place, shared_ptr<CoefficientFunction> integrand)
  {
    auto plane = dynamic_pointer_cast<const CrackedMesh>(place.body);
    auto solid = dynamic_pointer_cast<const CrackedSolid>(place.body);
    CutDifferentialSymbol dx(plane ? Measure { plane, place.kind } : Measure { solid, place.kind, place.fronts }, place.vb);
    dx.bonus_intorder = place.bonus_intorder;
    dx.definedonelements = place.elements;
    if (place.regions) dx.definedon = *place.regions;
    return TermOf(dx.MakeIntegral(integrand));
  }

  string OperatorName (const ProxyFunction & proxy) { return proxy.Evaluator()->Name(); }
}
