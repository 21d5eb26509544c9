#include "forms/cut_integral.hpp"
#include <comp.hpp>

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

    /// A symbolic integrator of NGSolve with the rules of a measure.
    template <typename BASE>
    class WithMeasure : public BASE
    {
    protected:
      CachedRules rules;

      virtual int RuleOrder (const FiniteElement & fel) const = 0;

      const ElementRule * Find (const FiniteElement & fel) const { return rules.Find(RuleOrder(fel), current_element); }

    public:
      WithMeasure (shared_ptr<CoefficientFunction> acf, VorB avb, Measure ameasure)
        : BASE(acf, avb, VOL), rules(std::move(ameasure), avb) { }

      string Name () const override { return "Cut " + BASE::Name(); }

      const IntegrationRule & GetIntegrationRule (const FiniteElement & fel, LocalHeap & lh) const override
      { auto rule = Find(fel); return rule ? rule->ir : BASE::GetIntegrationRule(fel, lh); }
      const SIMD_IntegrationRule & Get_SIMD_IntegrationRule (const FiniteElement & fel, LocalHeap & lh) const override
      { auto rule = Find(fel); return rule ? rule->simd_ir : BASE::Get_SIMD_IntegrationRule(fel, lh); }

      void CalcLinearizedElementMatrix (const FiniteElement & fel, const ElementTransformation & trafo, FlatVector<double> elveclin, FlatMatrix<double> elmat, LocalHeap & lh) const override
      { CurrentElement here(trafo); BASE::CalcLinearizedElementMatrix(fel, trafo, elveclin, elmat, lh); }
      void ApplyElementMatrix (const FiniteElement & fel, const ElementTransformation & trafo, const FlatVector<double> elx, FlatVector<double> ely, void * precomputed, LocalHeap & lh) const override
      { CurrentElement here(trafo); BASE::ApplyElementMatrix(fel, trafo, elx, ely, precomputed, lh); }
    };

    class CutBilinearFormIntegrator : public WithMeasure<SymbolicBilinearFormIntegrator>
    {
      using BASE = WithMeasure<SymbolicBilinearFormIntegrator>;
    public:
      using BASE::BASE;

      void CalcElementMatrix (const FiniteElement & fel, const ElementTransformation & trafo, FlatMatrix<double> elmat, LocalHeap & lh) const override
      { CurrentElement here(trafo); BASE::CalcElementMatrix(fel, trafo, elmat, lh); }
      void CalcElementMatrixAdd (const FiniteElement & fel, const ElementTransformation & trafo, FlatMatrix<double> elmat, bool & symmetric_so_far, LocalHeap & lh) const override
      { CurrentElement here(trafo); BASE::CalcElementMatrixAdd(fel, trafo, elmat, symmetric_so_far, lh); }

    private:
      int RuleOrder (const FiniteElement & fel) const override
      {
        auto mixed = dynamic_cast<const MixedFiniteElement*>(&fel);
        int order = mixed ? mixed->FETrial().Order() + mixed->FETest().Order() : 2*fel.Order();
        return order + bonus_intorder - test_difforder - trial_difforder;
      }
    };

    class CutEnergyIntegrator : public WithMeasure<SymbolicEnergy>
    {
      using BASE = WithMeasure<SymbolicEnergy>;
    public:
      using BASE::BASE;

      double Energy (const FiniteElement & fel, const ElementTransformation & trafo, FlatVector<double> elx, LocalHeap & lh) const override
      { CurrentElement here(trafo); return BASE::Energy(fel, trafo, elx, lh); }

    private:
      int RuleOrder (const FiniteElement & fel) const override
      {
        int difforder = 99;
        for (auto proxy : trial_proxies) difforder = std::min(difforder, proxy->Evaluator()->DiffOrder());
        return 2*(fel.Order()-difforder) + bonus_intorder;
      }
    };

    class CutLinearFormIntegrator : public SymbolicLinearFormIntegrator
    {
      using BASE = SymbolicLinearFormIntegrator;
      CachedRules rules;
    public:
      CutLinearFormIntegrator (shared_ptr<CoefficientFunction> acf, VorB avb, Measure ameasure)
        : BASE(acf, avb, VOL), rules(std::move(ameasure), avb) { }

      string Name () const override { return "Cut " + BASE::Name(); }

      void CalcElementVector (const FiniteElement & fel, const ElementTransformation & trafo, FlatVector<double> elvec, LocalHeap & lh) const override
      {
        auto rule = rules.Find(2*fel.Order()+bonus_intorder, trafo.GetElementNr());
        if (!rule)
          BASE::CalcElementVector(fel, trafo, elvec, lh);
        else if (rule->ir.Size() == 0)                     // NGSolve's mapped rules have at least one point
          elvec = 0;
        else if (!simd_evaluate)
          CalcScalar(fel, trafo, rule->ir, elvec, lh);
        else
          try { CalcSIMD(fel, trafo, rule->simd_ir, elvec, lh); }
          catch (const ngcore::ExceptionNOSIMD &) { CalcScalar(fel, trafo, rule->ir, elvec, lh); }
      }

    private:
      /// Evaluates the form at the points of a mapped rule, calling add(proxy, component, values) for each.
      template <typename MIR, typename F>
      void EvaluateForm (const ElementTransformation & trafo, MIR & mir, size_t points, F && add, LocalHeap & lh) const
      {
        auto save_userdata = trafo.PushUserData();
        ProxyUserData ud(0, gridfunction_cfs.Size(), lh);
        const_cast<ElementTransformation&>(trafo).userdata = &ud;
        for (auto function : gridfunction_cfs)
          ud.AssignMemory(function, points, function->Dimension(), lh, function->IsComplex());
        PrecomputeCacheCF(cache_cfs, mir, lh);
        for (auto proxy : proxies)
          {
            ud.testfunction = proxy;
            add(proxy, ud);
          }
      }

      void CalcSIMD (const FiniteElement & fel, const ElementTransformation & trafo, const SIMD_IntegrationRule & ir, FlatVector<double> elvec, LocalHeap & lh) const
      {
        elvec = 0;
        for (size_t first = 0; first < ir.Size(); first += points_at_once)
          AddSIMD(fel, trafo, ir.Range(first, std::min(first+points_at_once, ir.Size())), elvec, lh);
      }

      void AddSIMD (const FiniteElement & fel, const ElementTransformation & trafo, const SIMD_IntegrationRule & ir, FlatVector<double> elvec, LocalHeap & lh) const
      {
        HeapReset hr(lh);
        auto & mir = trafo(ir, lh);
        EvaluateForm(trafo, mir, ir.GetNIP(), [&] (ProxyFunction * proxy, ProxyUserData & ud)
        {
          FlatMatrix<SIMD<double>> values(proxy->Dimension(), ir.Size(), lh);
          for (size_t k = 0; k < proxy->Dimension(); k++)
            {
              ud.test_comp = k;
              cf->Evaluate(mir, values.Rows(k, k+1));
              for (size_t i = 0; i < ir.Size(); i++) values(k, i) *= mir[i].GetWeight();
            }
          proxy->Evaluator()->AddTrans(fel, mir, values, elvec);
        }, lh);
      }

      void CalcScalar (const FiniteElement & fel, const ElementTransformation & trafo, const IntegrationRule & ir, FlatVector<double> elvec, LocalHeap & lh) const
      {
        elvec = 0;
        for (size_t first = 0; first < ir.Size(); first += points_at_once)
          AddScalar(fel, trafo, ir.Range(first, std::min(first+points_at_once, ir.Size())), elvec, lh);
      }

      void AddScalar (const FiniteElement & fel, const ElementTransformation & trafo, const IntegrationRule & ir, FlatVector<double> elvec, LocalHeap & lh) const
      {
        HeapReset hr(lh);
        auto & mir = trafo(ir, lh);
        EvaluateForm(trafo, mir, ir.Size(), [&] (ProxyFunction * proxy, ProxyUserData & ud)
        {
          HeapReset hr(lh);
          FlatMatrix<double> values(ir.Size(), proxy->Dimension(), lh), value(ir.Size(), 1, lh);
          FlatMatrix<double, ColMajor> operator_matrix(proxy->Dimension(), elvec.Size(), lh);
          for (size_t k = 0; k < proxy->Dimension(); k++)
            {
              ud.test_comp = k;
              cf->Evaluate(mir, value);
              for (size_t i = 0; i < ir.Size(); i++) values(i, k) = mir[i].GetWeight() * value(i, 0);
            }
          for (size_t i = 0; i < ir.Size(); i++)
            {
              proxy->Evaluator()->CalcMatrix(fel, mir[i], operator_matrix, lh);
              elvec += Trans(operator_matrix) * values.Row(i);
            }
        }, lh);
      }
    };
  }

  const ElementRule * CachedRules :: Find (int order, size_t element) const
  {
    order = std::max(0, order);
    if (order >= max_order) return measure.Rules(vb, order)->Find(element);
    auto table = tables[order].load(std::memory_order_acquire);
    if (!table) table = LookUp(order);
    return table->Find(element);
  }

  const RuleTable * CachedRules :: LookUp (int order) const
  {
    std::lock_guard guard(mutex);
    used.push_back(measure.Rules(vb, order));
    tables[order].store(used.back().get(), std::memory_order_release);
    return used.back().get();
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

  namespace
  {
    /// An energy over a measure of a CrackedMesh.
    class CutVariation : public CutIntegral
    {
    public:
      using CutIntegral::CutIntegral;
      shared_ptr<BilinearFormIntegrator> MakeBilinearFormIntegrator () const override
      { return WithOptions<BilinearFormIntegrator>(make_shared<CutEnergyIntegrator>(cf, dx.vb, measure), dx); }
      shared_ptr<Integral> CreateSameIntegralType (shared_ptr<CoefficientFunction> acf) override
      { return make_shared<CutVariation>(acf, dx, measure); }
    };

    /// An energy over a measure of NGSolve.
    class StandardVariation : public Integral
    {
    public:
      using Integral::Integral;
      shared_ptr<BilinearFormIntegrator> MakeBilinearFormIntegrator () const override
      { return WithOptions<BilinearFormIntegrator>(make_shared<SymbolicEnergy>(cf, dx.vb, dx.element_vb), dx); }
      shared_ptr<Integral> CreateSameIntegralType (shared_ptr<CoefficientFunction> acf) override
      { return make_shared<StandardVariation>(acf, dx); }
    };
  }

  shared_ptr<SumOfIntegrals> MakeVariation (const SumOfIntegrals & form)
  {
    auto variation = make_shared<SumOfIntegrals>();
    for (auto & integral : form.icfs)
      {
        shared_ptr<Integral> varied = make_shared<StandardVariation>(integral->cf, integral->dx);
        if (auto cut = dynamic_pointer_cast<CutIntegral>(integral))
          varied = make_shared<CutVariation>(cut->cf, cut->dx, cut->GetMeasure());
        variation->icfs += varied;
      }
    return variation;
  }

  static shared_ptr<Integral> IntegralOn (Integral & integral, const ngcore::BitArray & elements)
  {
    auto restricted = integral.CreateSameIntegralType(integral.cf);
    auto both = make_shared<ngcore::BitArray>(elements);
    if (integral.dx.definedonelements) both->And(*integral.dx.definedonelements);
    restricted->dx.definedonelements = both;
    return restricted;
  }

  shared_ptr<SumOfIntegrals> IntegralsOn (const SumOfIntegrals & form, const ngcore::BitArray & elements, const ngcore::BitArray & boundary_elements)
  {
    auto all = make_shared<SumOfIntegrals>();
    for (auto & integral : form.icfs) all->icfs += IntegralOn(*integral, integral->dx.vb == VOL ? elements : boundary_elements);
    return all;
  }

  shared_ptr<SumOfIntegrals> InnerIntegrals (const SumOfIntegrals & form, const ngcore::BitArray & elements)
  {
    auto inner = make_shared<SumOfIntegrals>();
    for (auto & integral : form.icfs)
      if (integral->dx.vb == VOL) inner->icfs += IntegralOn(*integral, elements);
    return inner;
  }

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
    LocalHeap glh(heap_for_points, "cut integral", true);
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
        auto & ir = rule ? rule->ir : standard;
        for (size_t first = 0; first < ir.Size(); first += points_at_once)
          {
            HeapReset hr(lh);
            auto some = ir.Range(first, std::min(first+points_at_once, ir.Size()));
            auto & mir = trafo(some, lh);
            FlatMatrix<double> values(mir.Size(), 1, lh);
            cf->Evaluate(mir, values);
            for (size_t i = 0; i < mir.Size(); i++) value += mir[i].GetWeight() * values(i, 0);
          }
      };
      auto simd = [&]
      {
        SIMD_IntegrationRule standard(trafo.GetElementType(), order);
        auto & ir = rule ? rule->simd_ir : standard;
        SIMD<double> total(0.);
        for (size_t first = 0; first < ir.Size(); first += points_at_once)
          {
            HeapReset hr(lh);
            auto some = ir.Range(first, std::min(first+points_at_once, ir.Size()));
            auto & mir = trafo(some, lh);
            FlatMatrix<SIMD<double>> values(1, mir.Size(), lh);
            cf->Evaluate(mir, values);
            for (size_t i = 0; i < mir.Size(); i++) total += mir[i].GetWeight() * values(0, i);
          }
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
  { throw ngcore::Exception("Integrate: a measure of a CrackedMesh integrates real functions only; integrate real and imaginary part apart"); }
}
