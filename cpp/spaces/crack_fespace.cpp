#include "spaces/crack_fespace.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  namespace
  {
    /// The cracks are located in one mesh: a space on them does not follow its refinement.
    Flags Fixed (Flags flags) { return flags.SetFlag("autoupdate", false); }

    void CheckComponent (int component)
    {
      if (component != 0 && component != 1)
        throw Exception("CrackFESpace: component " + ngcore::ToString(component) + " is neither 0 (x) nor 1 (y)");
    }
  }

  CrackFESpace :: CrackFESpace (shared_ptr<const CrackedMesh> abody, std::vector<std::optional<TipSpec>> atips, double atolerance, const Flags & flags)
    : FESpace(abody->GetMesh(), Fixed(flags)), body(abody), tolerance(atolerance)
  {
    type = "crackfespace";
    if (iscomplex) throw Exception("CrackFESpace: complex=True is not supported; the space is real");
    Flags scalar_flags = Fixed(flags);
    scalar_flags.SetFlag("dim", 1);
    scalar = CreateFESpace("h1ho", ma, scalar_flags);
    for (auto [component, name] : { std::pair(0, "dirichletx"), std::pair(1, "dirichlety") })
      {
        held[component] = dirichlet_boundaries;
        if (flags.StringFlagDefined(name)) held[component] |= Region(ma, BND, flags.GetStringFlag(name)).Mask();
      }
    SetTips(atips);
    for (auto trace : { Trace::Position, Trace::Plus, Trace::Minus, Trace::Jump, Trace::Larger })
      for (int diff_order : { 0, 1 })
        {
          auto op = make_shared<CrackDiffOp>(diff_order, trace, VOL);
          if (trace == Trace::Position) (diff_order ? flux_evaluator : evaluator)[VOL] = op;
          else additional_evaluators.Set(op->Name(), op);
        }
    if (order > 1)
      for (auto trace : { Trace::Position, Trace::Plus, Trace::Minus, Trace::Larger })
        for (auto kind : { Dilatation::Projected, Dilatation::Singular })
          {
            auto op = make_shared<DilatationOp>(kind, trace, rules);
            additional_evaluators.Set(op->Name(), op);
          }
    evaluator[BND] = make_shared<CrackDiffOp>(0, Trace::Position, BND);
    additional_evaluators.Set("Grad", flux_evaluator[VOL]);
  }

  void CrackFESpace :: SetTips (const std::vector<std::optional<TipSpec>> & specs)
  {
    auto & places = body->Tips();
    tips.resize(places.size());
    rules = standard_rules = RulesOf(body, {});
    if (specs.empty()) return;
    if (specs.size() != places.size())
      throw Exception("CrackFESpace: " + ngcore::ToString(specs.size()) + " tip enrichments for " + ngcore::ToString(places.size()) + " tips; give one for each (body.tips)");
    TipDemands demands;
    for (size_t i = 0; i < places.size(); i++)
      if (auto & spec = specs[i])
        {
          auto & tip = places[i];
          if (!(spec->r0 >= 0 && spec->r0 < spec->r1))
            throw Exception("CrackFESpace: the cut-off of the tip at " + ToString(tip.point) + " needs 0 <= r0 < r1, got r0 = " + ngcore::ToString(spec->r0) + ", r1 = " + ngcore::ToString(spec->r1));
          if (spec->r1 > (1+1e-10)*tip.clearance)
            throw Exception("CrackFESpace: the disk r1 = " + ngcore::ToString(spec->r1) + " of the tip at " + ToString(tip.point) + " reaches "
                            + tip.limit + ", at " + ngcore::ToString(tip.clearance) + "; choose r1 below that");
          tips[i].emplace(tip.crack, tip.curve, tip.plus_sign, *spec);
          demands[i] = { { spec->r0, spec->r1 }, tolerance, spec->cutoff == CutOff::Cubic ? 1 : 2 };
        }
    rules = RulesOf(body, demands);
  }

  void CrackFESpace :: SetTipMaterial (size_t tip, double kappa, double mu)
  {
    if (!NumTipDofs(tip)) throw Exception("CrackFESpace: there are no functions at tip " + ngcore::ToString(tip));
    auto spec = tips[tip]->Spec();
    spec.kappa = kappa;
    spec.mu = mu;
    auto & place = body->Tips()[tip];
    tips[tip].emplace(place.crack, place.curve, place.plus_sign, spec);
  }

  std::vector<std::optional<TipSpec>> CrackFESpace :: TipSpecs () const
  {
    std::vector<std::optional<TipSpec>> specs;
    for (auto & tip : tips)
      specs.push_back(tip ? std::optional(tip->Spec()) : std::nullopt);
    return specs;
  }

  void CrackFESpace :: Update ()
  {
    body->CheckMesh();
    FESpace::Update();
    scalar->Update();
    FindEnrichment();
    first_tip_dof.assign(tips.size(), 0);
    size_t dofs = FirstTipDof();
    for (size_t i = 0; i < tips.size(); i++)
      {
        first_tip_dof[i] = dofs;
        if (tips[i]) dofs += tips[i]->Size();
      }
    SetNDof(dofs);

    CollectHeaviside(VOL);
    CollectHeaviside(BND);
    CollectTips();
    // every element of a disk has the tip's functions: atomic, so that they do not serialise the assembly
    is_atomic_dof = BitArray(dofs > size_t(FirstTipDof()) ? dofs : 0);
    is_atomic_dof.Clear();
    for (size_t dof = FirstTipDof(); dof < dofs; dof++) is_atomic_dof.SetBit(dof);
    UpdateCouplingDofArray();
  }

  /// Elements share functions, those of the tips aside, only where they share φ_i: the colours of P_k are right.
  void CrackFESpace :: FinalizeUpdate ()
  {
    low_order_space = scalar;                         // whose colours the base class takes
    FESpace::FinalizeUpdate();
    low_order_space = nullptr;
  }

  void CrackFESpace :: UpdateCouplingDofArray ()
  {
    ctofdof.SetSize(ndof);
    ctofdof = WIREBASKET_DOF;
    for (size_t k = 0; k < 2; k++)
      {
        for (size_t i = 0; i < NumScalar(); i++)
          ctofdof[k*NumScalar()+i] = scalar->GetDofCouplingType(i);
        for (size_t j = 0; j < NumHeaviside(); j++)
          ctofdof[HeavisideDof(j, k)] = scalar->GetDofCouplingType(enrichment[j].dof);
      }
  }

  const BitArray & CrackFESpace :: HeldRegions (int component) const
  {
    CheckComponent(component);
    return held[component];
  }

  std::vector<std::array<std::vector<DofId>,2>> CrackFESpace :: BoundaryDofs () const
  {
    std::vector<std::array<std::vector<DofId>,2>> found(ma->GetNRegions(BND));
    Array<DofId> dofs;
    for (size_t i = 0; i < ma->GetNE(BND); i++)
      {
        ElementId element(BND, i);
        GetDofNrs(element, dofs);
        size_t n = (dofs.Size()-TipsOf(element).dofs.size())/2;
        for (size_t k : { 0, 1 })
          for (auto dof : dofs.Range(k*n, (k+1)*n))
            if (IsRegularDof(dof)) found[ma->GetElement(element).GetIndex()][k].push_back(dof);
      }
    for (auto & region : found)
      for (auto & some : region)
        {
          std::ranges::sort(some);
          some.erase(std::ranges::unique(some).begin(), some.end());
        }
    return found;
  }

  /// Fixed are the functions of a component with a trace on the boundary where it is held. (The base class fixes all functions of a Dirichlet
  /// vertex or edge, in both components, also those that vanish on the boundary beside it.)
  void CrackFESpace :: UpdateFreeDofs ()
  {
    FESpace::UpdateFreeDofs();
    dirichlet_dofs.Clear();
    auto of_region = BoundaryDofs();
    for (size_t region = 0; region < of_region.size(); region++)
      for (size_t k : { 0, 1 })
        if (held[k][region])
          for (auto dof : of_region[region][k]) dirichlet_dofs.SetBit(dof);
    *free_dofs = dirichlet_dofs;
    free_dofs->Invert();
    for (auto dof : Range(ctofdof))
      if (!(ctofdof[dof] & VISIBLE_DOF)) free_dofs->Clear(dof);
    *external_free_dofs = *free_dofs;
    for (auto dof : Range(ctofdof))
      if (ctofdof[dof] & CONDENSABLE_DOF) external_free_dofs->Clear(dof);
  }

  const CrackFESpace::Enrichment & CrackFESpace :: At (size_t j) const
  {
    if (j >= enrichment.size())
      throw Exception("CrackFESpace: there is no Heaviside function " + ngcore::ToString(j) + "; the space has " + ngcore::ToString(enrichment.size()));
    return enrichment[j];
  }

  DofId CrackFESpace :: HeavisideDof (size_t j, int component) const
  {
    At(j);
    CheckComponent(component);
    return 2*NumScalar() + component*NumHeaviside() + j;
  }

  void CrackFESpace :: CollectHeaviside (VorB vb)
  {
    std::multimap<DofId, size_t> of_dof;
    for (size_t j = 0; j < enrichment.size(); j++) of_dof.insert({ enrichment[j].dof, j });
    heaviside_of[vb].SetSize(ma->GetNE(vb));
    heaviside_of[vb] = 0;
    heaviside[vb].assign(1, {});

    Array<DofId> dofs;
    auto collect = [&] (size_t element)
    {
      HeavisideFunctions found;
      scalar->GetDofNrs(ElementId(vb, element), dofs);
      for (size_t local = 0; local < dofs.Size(); local++)
        for (auto [it, last] = of_dof.equal_range(dofs[local]); it != last; ++it)
          {
            HeavisideFunction function { int(local), Factors(CopyOf(it->second), ElementId(vb, element)) };
            // without a trace on a boundary element it is no unknown of it: a Dirichlet condition must not fix it
            if (vb == BND && std::ranges::none_of(function.factors, [] (int factor) { return factor; })) continue;
            found.functions.push_back(std::move(function));
            found.global.push_back(it->second);
          }
      if (found.functions.empty()) return;
      heaviside_of[vb][element] = heaviside[vb].size();
      heaviside[vb].push_back(std::move(found));
    };
    if (vb == BND)
      for (size_t element = 0; element < ma->GetNE(BND); element++) collect(element);
    else
      {
        std::set<size_t> elements;
        for (auto & support : supports)
          elements.insert(support.elements.begin(), support.elements.end());
        for (auto element : elements) collect(element);
      }
  }

  void CrackFESpace :: CollectTips ()
  {
    for (auto vb : { VOL, BND })
      {
        tips_of[vb].SetSize(ma->GetNE(vb));
        tips_of[vb] = 0;
      }
    tip_sets.assign(1, {});
    for (size_t t = 0; t < tips.size(); t++)
      if (tips[t])
        {
          for (size_t i = 0; i < ma->GetNE(VOL); i++)
            if (tips[t]->Disk().Meets(*ma, ElementId(VOL, i))) AddTip(ElementId(VOL, i), t);
          AddToInterfaces(t);
        }
  }

  void CrackFESpace :: AddTip (ElementId ei, size_t tip)
  {
    auto & set = tips_of[ei.VB()][ei.Nr()];
    auto with = tip_sets[set].tips;
    with.push_back(tip);
    set = TipSetOf(with);
  }

  /// ∂Ω is outside of all disks, inner interfaces need not be.
  void CrackFESpace :: AddToInterfaces (size_t t)
  {
    auto disk = tips[t]->Disk();
    double to_fixed = disk.radius;
    string fixed;
    for (size_t i = 0; i < ma->GetNE(BND); i++)
      {
        if (!disk.Meets(*ma, ElementId(BND, i))) continue;
        AddTip(ElementId(BND, i), t);
        int region = ma->GetElement(ElementId(BND, i)).GetIndex();
        double distance = EdgeMap(*ma, i).DistanceTo(disk.centre);
        if ((held[0][region] || held[1][region]) && distance < to_fixed)
          {
            to_fixed = distance;
            fixed = ma->GetMaterial(BND, region);
          }
      }
    if (to_fixed < disk.radius)
      throw Exception("CrackFESpace: the fixed inner boundary '" + fixed + "' runs through the disk r1 = " + ngcore::ToString(disk.radius) + " of the tip at " + ToString(disk.centre)
                      + ", whose functions do not vanish on it; choose r1 below its distance " + ngcore::ToString(to_fixed) + ", or no functions at this tip (tip=None)");
  }

  int CrackFESpace :: TipSetOf (const std::vector<size_t> & numbers)
  {
    for (size_t i = tip_sets.size(); i-- > 0; )
      if (tip_sets[i].tips == numbers) return i;
    TipSet set { numbers, {}, {} };
    for (auto t : numbers)
      {
        set.functions.push_back(&*tips[t]);
        for (auto dof : TipDofs(t)) set.dofs.push_back(dof);
      }
    tip_sets.push_back(std::move(set));
    return tip_sets.size()-1;
  }

  std::vector<DofId> CrackFESpace :: TipDofs (size_t tip) const
  {
    if (tip >= tips.size())
      throw Exception("CrackFESpace: there is no tip " + ngcore::ToString(tip) + "; the body has " + ngcore::ToString(tips.size()));
    std::vector<DofId> dofs;
    for (int m = 0; tips[tip] && m < tips[tip]->Size(); m++) dofs.push_back(first_tip_dof[tip]+m);
    return dofs;
  }

  namespace
  {
    template <typename T>
    FlatArray<T> View (const std::vector<T> & v) { return FlatArray<T>(v.size(), const_cast<T*>(v.data())); }
  }

  FiniteElement & CrackFESpace :: GetFE (ElementId ei, Allocator & alloc) const
  {
    body->CheckMesh();
    auto & fe = scalar->GetFE(ei, alloc);
    if (ei.VB() > BND) return fe;
    auto & jumps = HeavisideOf(ei).functions;
    auto & singular = TipsOf(ei).functions;
    bool jumps_here = !(jumps.empty() && singular.empty());
    auto cut = jumps_here && ei.VB() == VOL ? body->Find(ei.Nr()) : nullptr;
    const ElementParts * parts = jumps_here && ei.VB() == BND ? static_cast<const ElementParts*>(body->FindBoundary(ei.Nr())) : cut;
    return *new (alloc) CrackFiniteElement (static_cast<BaseScalarFiniteElement&>(fe), View(jumps), View(singular), parts, cut);
  }

  void CrackFESpace :: GetComponent (ElementId ei, Array<DofId> & functions) const
  {
    body->CheckMesh();
    scalar->GetDofNrs(ei, functions);
    if (ei.VB() <= BND)
      for (auto j : HeavisideOf(ei).global) functions.Append(NumScalar()+j);
  }

  void CrackFESpace :: GetDofNrs (ElementId ei, Array<DofId> & dnums) const
  {
    GetComponent(ei, dnums);
    size_t n = dnums.Size(), ns = NumScalar(), nh = NumHeaviside();
    const TipSet & set = TipsOf(ei);
    dnums.SetSize(2*n + set.dofs.size());
    for (size_t i = 0; i < n; i++)
      {
        DofId f = dnums[i];
        if (!IsRegularDof(f))
          dnums[n+i] = f;
        else
          {
            dnums[i] = size_t(f) < ns ? f : f+ns;
            dnums[n+i] = size_t(f) < ns ? f+ns : f+ns+nh;
          }
      }
    for (size_t m = 0; m < set.dofs.size(); m++) dnums[2*n+m] = set.dofs[m];
  }

  void CrackFESpace :: GetDofNrs (NodeId ni, Array<DofId> & dnums) const
  {
    ArrayMem<DofId, 20> dofs;
    scalar->GetDofNrs(ni, dofs);
    dnums.SetSize0();
    for (int k = 0; k < 2; k++)
      {
        for (auto dof : dofs) dnums.Append(k*NumScalar()+dof);
        for (size_t j = 0; j < enrichment.size(); j++)
          if (dofs.Contains(enrichment[j].dof)) dnums.Append(HeavisideDof(j, k));
      }
  }
}
