#include "spaces/enriched_space.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  namespace
  {
    /// The cracks are located in one mesh: a space on them does not follow its refinement.
    Flags Fixed (Flags flags) { return flags.SetFlag("autoupdate", false); }

    constexpr const char * axes[] { "x", "y", "z" };

    void CheckComponent (int component, int number)
    {
      if (component < 0 || component >= number)
        throw Exception("CrackFESpace: there is no component " + ngcore::ToString(component) + "; they are 0 (x) to " + ngcore::ToString(number-1) + " (" + axes[number-1] + ")");
    }
  }

  string HeldFlag (int component) { return string("dirichlet") + axes[component]; }

  template <int D>
  EnrichedSpace<D> :: EnrichedSpace (shared_ptr<const CutGeometry<D>> ageometry, const Flags & flags)
    : FESpace(ageometry->GetMesh(), Fixed(flags)), geometry(ageometry)
  {
    if (iscomplex) throw Exception("CrackFESpace: complex=True is not supported; the space is real");
    Flags scalar_flags = Fixed(flags);
    scalar_flags.SetFlag("dim", 1);
    scalar = CreateFESpace("h1ho", ma, scalar_flags);
    for (int component = 0; component < D; component++)
      {
        held[component] = dirichlet_boundaries;
        if (auto name = HeldFlag(component); flags.StringFlagDefined(name)) held[component] |= Region(ma, BND, flags.GetStringFlag(name)).Mask();
      }
    for (auto trace : { Trace::Position, Trace::Plus, Trace::Minus, Trace::Jump, Trace::Larger })
      for (int diff_order : { 0, 1 })
        {
          auto op = make_shared<CrackDiffOp<D>>(diff_order, trace, VOL);
          if (trace == Trace::Position) (diff_order ? flux_evaluator : evaluator)[VOL] = op;
          else additional_evaluators.Set(op->Name(), op);
        }
    evaluator[BND] = make_shared<CrackDiffOp<D>>(0, Trace::Position, BND);
    additional_evaluators.Set("Grad", flux_evaluator[VOL]);
  }

  template <int D>
  void EnrichedSpace<D> :: Update ()
  {
    geometry->CheckMesh();
    FESpace::Update();
    scalar->Update();
    FindEnrichment();
    CollectHeaviside(VOL);
    CollectHeaviside(BND);
    SetNDof(FirstSingularDof() + CollectSingular());
    UpdateCouplingDofArray();
  }

  /// Elements share functions, those of tips aside, only where they share φ_i: the colours of P_k are right.
  template <int D>
  void EnrichedSpace<D> :: FinalizeUpdate ()
  {
    low_order_space = scalar;                         // whose colours the base class takes
    FESpace::FinalizeUpdate();
    low_order_space = nullptr;
  }

  template <int D>
  void EnrichedSpace<D> :: UpdateCouplingDofArray ()
  {
    ctofdof.SetSize(ndof);
    ctofdof = WIREBASKET_DOF;
    for (size_t k = 0; k < D; k++)
      {
        for (size_t i = 0; i < NumScalar(); i++)
          ctofdof[k*NumScalar()+i] = scalar->GetDofCouplingType(i);
        for (size_t j = 0; j < NumHeaviside(); j++)
          ctofdof[HeavisideDof(j, k)] = scalar->GetDofCouplingType(enrichment[j].dof);
      }
  }

  template <int D>
  const BitArray & EnrichedSpace<D> :: HeldRegions (int component) const
  {
    CheckComponent(component, D);
    return held[component];
  }

  template <int D>
  std::vector<std::array<std::vector<DofId>,D>> EnrichedSpace<D> :: BoundaryDofs () const
  {
    std::vector<std::array<std::vector<DofId>,D>> found(ma->GetNRegions(BND));
    Array<DofId> dofs;
    for (size_t i = 0; i < ma->GetNE(BND); i++)
      {
        ElementId element(BND, i);
        GetDofNrs(element, dofs);
        size_t n = (dofs.Size()-SingularDofs(element).Size())/D;
        int region = ma->GetElement(element).GetIndex();
        for (size_t k = 0; k < D; k++)
          {
            for (auto dof : dofs.Range(k*n, (k+1)*n))
              if (IsRegularDof(dof)) found[region][k].push_back(dof);
            for (auto dof : dofs.Range(D*n, dofs.Size()))
              if (IsWhollyHeld(region) || (held[k][region] && HasOnly(dof, k))) found[region][k].push_back(dof);
          }
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
  /// vertex or edge, in all components, also those that vanish on the boundary beside it.)
  template <int D>
  void EnrichedSpace<D> :: UpdateFreeDofs ()
  {
    FESpace::UpdateFreeDofs();
    dirichlet_dofs.Clear();
    auto of_region = BoundaryDofs();
    for (size_t region = 0; region < of_region.size(); region++)
      for (size_t k = 0; k < D; k++)
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

  template <int D>
  auto EnrichedSpace<D> :: At (size_t j) const -> const Enrichment &
  {
    if (j >= enrichment.size())
      throw Exception("CrackFESpace: there is no Heaviside function " + ngcore::ToString(j) + "; the space has " + ngcore::ToString(enrichment.size()));
    return enrichment[j];
  }

  template <int D>
  DofId EnrichedSpace<D> :: HeavisideDof (size_t j, int component) const
  {
    At(j);
    CheckComponent(component, D);
    return D*NumScalar() + component*NumHeaviside() + j;
  }

  template <int D>
  void EnrichedSpace<D> :: CollectHeaviside (VorB vb)
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

  template <int D>
  FiniteElement & EnrichedSpace<D> :: GetFE (ElementId ei, Allocator & alloc) const
  {
    geometry->CheckMesh();
    auto & fe = scalar->GetFE(ei, alloc);
    if (ei.VB() > BND) return fe;
    auto & jumps = HeavisideOf(ei).functions;
    auto singular = SingularOf(ei);
    bool jumps_here = !(jumps.empty() && singular.Empty());
    auto cut = jumps_here && ei.VB() == VOL ? geometry->Find(ei.Nr()) : nullptr;
    const ElementParts * parts = jumps_here && ei.VB() == BND ? static_cast<const ElementParts*>(geometry->FindBoundary(ei.Nr())) : cut;
    return *new (alloc) CrackFiniteElement<D> (static_cast<BaseScalarFiniteElement&>(fe), View(jumps), singular, parts, cut);
  }

  template <int D>
  void EnrichedSpace<D> :: GetComponent (ElementId ei, Array<DofId> & functions) const
  {
    geometry->CheckMesh();
    scalar->GetDofNrs(ei, functions);
    if (ei.VB() <= BND)
      for (auto j : HeavisideOf(ei).global) functions.Append(NumScalar()+j);
  }

  template <int D>
  void EnrichedSpace<D> :: GetDofNrs (ElementId ei, Array<DofId> & dnums) const
  {
    GetComponent(ei, dnums);
    size_t n = dnums.Size(), ns = NumScalar(), nh = NumHeaviside();
    auto singular = SingularDofs(ei);
    dnums.SetSize(D*n + singular.Size());
    for (size_t k = D; k-- > 0; )
      for (size_t i = 0; i < n; i++)
        {
          DofId f = dnums[i];
          dnums[k*n+i] = !IsRegularDof(f) ? f : size_t(f) < ns ? k*ns+f : D*ns+k*nh+f-ns;
        }
    dnums.Range(D*n, dnums.Size()) = singular;
  }

  template <int D>
  void EnrichedSpace<D> :: GetDofNrs (NodeId ni, Array<DofId> & dnums) const
  {
    ArrayMem<DofId, 20> dofs;
    scalar->GetDofNrs(ni, dofs);
    dnums.SetSize0();
    for (int k = 0; k < D; k++)
      {
        for (auto dof : dofs) dnums.Append(k*NumScalar()+dof);
        for (size_t j = 0; j < enrichment.size(); j++)
          if (dofs.Contains(enrichment[j].dof)) dnums.Append(HeavisideDof(j, k));
      }
  }

  template class EnrichedSpace<2>;
  template class EnrichedSpace<3>;
}
