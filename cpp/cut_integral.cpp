#include "cut_integral.hpp"

namespace ngsxfem_contact
{
  using namespace ngfem;
  using ngcomp::Ngs_Element, ngcomp::Region;

  namespace
  {
    /// The element that the calling thread integrates over: NGSolve's integrators ask for a rule by finite element only.
    thread_local size_t current_element = 0;

    class CurrentElement
    {
      size_t previous;
    public:
      explicit CurrentElement (const ElementTransformation & trafo) : previous(current_element)
      { current_element = trafo.GetElementNr(); }
      ~CurrentElement () { current_element = previous; }
    };

    template <typename RULE> const RULE & Select (const ElementRule & rule);
    template <> const IntegrationRule & Select (const ElementRule & rule) { return rule.ir; }
    template <> const SIMD_IntegrationRule & Select (const ElementRule & rule) { return rule.simd_ir; }

    class CutBilinearFormIntegrator : public SymbolicBilinearFormIntegrator
    {
      using BASE = SymbolicBilinearFormIntegrator;
      Measure measure;
    public:
      CutBilinearFormIntegrator (shared_ptr<CoefficientFunction> acf, VorB avb, Measure ameasure)
        : BASE(acf, avb, VOL), measure(std::move(ameasure)) { }

      string Name () const override { return "Cut " + BASE::Name(); }

      const IntegrationRule & GetIntegrationRule (const FiniteElement & fel, LocalHeap & lh) const override
      { return Rule<IntegrationRule>(fel, [&] () -> auto & { return BASE::GetIntegrationRule(fel, lh); }); }
      const SIMD_IntegrationRule & Get_SIMD_IntegrationRule (const FiniteElement & fel, LocalHeap & lh) const override
      { return Rule<SIMD_IntegrationRule>(fel, [&] () -> auto & { return BASE::Get_SIMD_IntegrationRule(fel, lh); }); }

      void CalcElementMatrix (const FiniteElement & fel, const ElementTransformation & trafo, FlatMatrix<double> elmat, LocalHeap & lh) const override
      { CurrentElement here(trafo); BASE::CalcElementMatrix(fel, trafo, elmat, lh); }
      void CalcElementMatrixAdd (const FiniteElement & fel, const ElementTransformation & trafo, FlatMatrix<double> elmat, bool & symmetric_so_far, LocalHeap & lh) const override
      { CurrentElement here(trafo); BASE::CalcElementMatrixAdd(fel, trafo, elmat, symmetric_so_far, lh); }
      void CalcLinearizedElementMatrix (const FiniteElement & fel, const ElementTransformation & trafo, FlatVector<double> elveclin, FlatMatrix<double> elmat, LocalHeap & lh) const override
      { CurrentElement here(trafo); BASE::CalcLinearizedElementMatrix(fel, trafo, elveclin, elmat, lh); }
      void ApplyElementMatrix (const FiniteElement & fel, const ElementTransformation & trafo, const FlatVector<double> elx, FlatVector<double> ely, void * precomputed, LocalHeap & lh) const override
      { CurrentElement here(trafo); BASE::ApplyElementMatrix(fel, trafo, elx, ely, precomputed, lh); }

    private:
      template <typename RULE, typename STANDARD>
      const RULE & Rule (const FiniteElement & fel, STANDARD && standard) const
      {
        if (auto rule = measure.Rules(vb, Order(fel))->Find(current_element)) return Select<RULE>(*rule);
        return standard();
      }

      int Order (const FiniteElement & fel) const
      {
        auto mixed = dynamic_cast<const MixedFiniteElement*>(&fel);
        int order = mixed ? mixed->FETrial().Order() + mixed->FETest().Order() : 2*fel.Order();
        return std::max(0, order + bonus_intorder - test_difforder - trial_difforder);
      }
    };

    class CutLinearFormIntegrator : public SymbolicLinearFormIntegrator
    {
      using BASE = SymbolicLinearFormIntegrator;
      Measure measure;
    public:
      CutLinearFormIntegrator (shared_ptr<CoefficientFunction> acf, VorB avb, Measure ameasure)
        : BASE(acf, avb, VOL), measure(std::move(ameasure)) { }

      string Name () const override { return "Cut " + BASE::Name(); }

      void CalcElementVector (const FiniteElement & fel, const ElementTransformation & trafo, FlatVector<double> elvec, LocalHeap & lh) const override
      {
        auto table = measure.Rules(vb, 2*fel.Order()+bonus_intorder);
        auto rule = table->Find(trafo.GetElementNr());
        if (!rule)
          BASE::CalcElementVector(fel, trafo, elvec, lh);
        else
          CalcWithRule(fel, trafo, rule->simd_ir, elvec, lh);
      }

    private:
      void CalcWithRule (const FiniteElement & fel, const ElementTransformation & trafo, const SIMD_IntegrationRule & ir, FlatVector<double> elvec, LocalHeap & lh) const
      {
        HeapReset hr(lh);
        auto save_userdata = trafo.PushUserData();
        auto & mir = trafo(ir, lh);
        ProxyUserData ud(0, gridfunction_cfs.Size(), lh);
        const_cast<ElementTransformation&>(trafo).userdata = &ud;
        for (auto function : gridfunction_cfs)
          ud.AssignMemory(function, ir.GetNIP(), function->Dimension(), lh, function->IsComplex());
        PrecomputeCacheCF(cache_cfs, mir, lh);

        elvec = 0;
        for (auto proxy : proxies)
          {
            FlatMatrix<SIMD<double>> values(proxy->Dimension(), ir.Size(), lh);
            ud.testfunction = proxy;
            for (size_t k = 0; k < proxy->Dimension(); k++)
              {
                ud.test_comp = k;
                cf->Evaluate(mir, values.Rows(k, k+1));
              }
            for (size_t k = 0; k < proxy->Dimension(); k++)
              for (size_t i = 0; i < ir.Size(); i++) values(k, i) *= mir[i].GetWeight();
            proxy->Evaluator()->AddTrans(fel, mir, values, elvec);
          }
      }
    };

    template <typename INTEGRATOR>
    shared_ptr<INTEGRATOR> WithOptions (shared_ptr<INTEGRATOR> integrator, const DifferentialSymbol & dx)
    {
      if (dx.definedon)
        if (auto regions = get_if<ngcore::BitArray>(&*dx.definedon)) integrator->SetDefinedOn(*regions);
      integrator->SetBonusIntegrationOrder(dx.bonus_intorder);
      if (dx.definedonelements) integrator->SetDefinedOnElements(dx.definedonelements);
      return integrator;
    }
  }

  shared_ptr<Integral> CutDifferentialSymbol :: MakeIntegral (shared_ptr<CoefficientFunction> cf) const
  { return make_shared<CutIntegral>(cf, *this, measure); }

  shared_ptr<BilinearFormIntegrator> CutIntegral :: MakeBilinearFormIntegrator () const
  {
    auto bfi = make_shared<CutBilinearFormIntegrator>(cf, dx.vb, measure);
    if (linearization) bfi->SetLinearization(linearization->MakeBilinearFormIntegrator());
    return WithOptions<BilinearFormIntegrator>(bfi, dx);
  }

  shared_ptr<LinearFormIntegrator> CutIntegral :: MakeLinearFormIntegrator () const
  { return WithOptions<LinearFormIntegrator>(make_shared<CutLinearFormIntegrator>(cf, dx.vb, measure), dx); }

  std::optional<ngcore::BitArray> CutIntegral :: DefinedOn (const ngcomp::MeshAccess & ma) const
  {
    if (!dx.definedon) return std::nullopt;
    if (auto regions = get_if<ngcore::BitArray>(&*dx.definedon)) return *regions;
    shared_ptr<ngcomp::MeshAccess> mesh(const_cast<ngcomp::MeshAccess*>(&ma), NOOP_Deleter);
    return Region(mesh, dx.vb, get<string>(*dx.definedon)).Mask();
  }

  double CutIntegral :: Integrate (const ngcomp::MeshAccess & ma, FlatVector<double> element_wise)
  {
    if (&ma != measure.body->GetMesh().get())
      throw ngcore::Exception("Integrate: this measure belongs to another mesh; pass the mesh of its CrackedMesh");
    int order = 5 + dx.bonus_intorder;
    auto table = measure.Rules(dx.vb, order);
    auto regions = DefinedOn(ma);
    std::atomic<bool> use_simd = true;
    std::atomic<double> sum = 0.0;
    LocalHeap glh(10000000, "cut integral", true);
    ma.IterateElements(dx.vb, glh, [&] (Ngs_Element el, LocalHeap & lh)
    {
      if (dx.definedonelements && !dx.definedonelements->Test(el.Nr())) return;
      if (regions && !regions->Test(el.GetIndex())) return;
      auto & trafo = ma.GetTrafo(el, lh);
      auto rule = table->Find(el.Nr());
      double value = 0;
      auto scalar = [&]
      {
        IntegrationRule standard(trafo.GetElementType(), order);
        auto & mir = trafo(rule ? rule->ir : standard, lh);
        FlatMatrix<double> values(mir.Size(), 1, lh);
        cf->Evaluate(mir, values);
        for (size_t i = 0; i < mir.Size(); i++) value += mir[i].GetWeight() * values(i, 0);
      };
      auto simd = [&]
      {
        SIMD_IntegrationRule standard(trafo.GetElementType(), order);
        auto & mir = trafo(rule ? rule->simd_ir : standard, lh);
        FlatMatrix<SIMD<double>> values(1, mir.Size(), lh);
        cf->Evaluate(mir, values);
        SIMD<double> total(0.);
        for (size_t i = 0; i < mir.Size(); i++) total += mir[i].GetWeight() * values(0, i);
        value = HSum(total);
      };
      if (use_simd)
        try { simd(); }
        catch (const ngcore::ExceptionNOSIMD &) { use_simd = false; value = 0; }
      if (!use_simd) scalar();
      if (element_wise.Size()) element_wise(el.Nr()) += value;
      sum += value;
    });
    return sum;
  }

  ngcore::Complex CutIntegral :: Integrate (const ngcomp::MeshAccess &, FlatVector<ngcore::Complex>)
  { throw ngcore::Exception("Integrate: a measure of a CrackedMesh integrates real functions only"); }
}
