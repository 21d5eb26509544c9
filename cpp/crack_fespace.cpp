#include "crack_fespace.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  /// Supports of which less than this part lies on one side are not enriched: the energy of what they miss is
  /// the square root of it, relative to the jump.
  constexpr double smallest_part = 1e-14;

  namespace
  {
    /// The cracks are located in one mesh: a space on them does not follow its refinement.
    Flags Fixed (Flags flags) { return flags.SetFlag("autoupdate", false); }
  }

  CrackFESpace :: CrackFESpace (shared_ptr<CrackedMesh> abody, std::vector<std::optional<TipSpec>> atips, double atolerance, const Flags & flags)
    : FESpace(abody->GetMesh(), Fixed(flags)), body(abody), tolerance(atolerance)
  {
    type = "crackfespace";
    if (iscomplex) throw Exception("CrackFESpace: complex=True is not supported; the space is real");
    Flags scalar_flags = Fixed(flags);
    scalar_flags.SetFlag("dim", 1);
    scalar = CreateFESpace("h1ho", ma, scalar_flags);
    SetTips(atips);
    for (auto trace : { Trace::Position, Trace::Plus, Trace::Minus, Trace::Jump, Trace::Larger })
      for (int diff_order : { 0, 1 })
        {
          auto op = make_shared<CrackDiffOp>(diff_order, trace, VOL);
          if (trace == Trace::Position) (diff_order ? flux_evaluator : evaluator)[VOL] = op;
          else additional_evaluators.Set(op->Name(), op);
        }
    evaluator[BND] = make_shared<CrackDiffOp>(0, Trace::Position, BND);
    additional_evaluators.Set("Grad", flux_evaluator[VOL]);
  }

  void CrackFESpace :: SetTips (const std::vector<std::optional<TipSpec>> & specs)
  {
    auto & places = body->Tips();
    tips.resize(places.size());
    if (specs.empty()) return;
    if (specs.size() != places.size())
      throw Exception("CrackFESpace: " + ngcore::ToString(specs.size()) + " tip enrichments for " + ngcore::ToString(places.size()) + " tips; give one for each (body.tips)");
    for (size_t i = 0; i < places.size(); i++)
      if (auto & spec = specs[i])
        {
          auto & tip = places[i];
          if (!(spec->r0 >= 0 && spec->r0 < spec->r1))
            throw Exception("CrackFESpace: the cut-off of the tip at " + ToString(tip.point) + " needs 0 <= r0 < r1, got r0 = " + ngcore::ToString(spec->r0) + ", r1 = " + ngcore::ToString(spec->r1));
          if (spec->r1 > (1+1e-10)*tip.clearance)
            throw Exception("CrackFESpace: the disk r1 = " + ngcore::ToString(spec->r1) + " of the tip at " + ToString(tip.point) + " reaches "
                            + tip.limit + ", at " + ngcore::ToString(tip.clearance) + "; choose r1 below that");
          tips[i].emplace(tip.point, tip.ahead, tip.plus_sign, *spec);
          body->RequireTipQuadrature(i, { spec->r0, spec->r1 }, tolerance);
        }
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
    scalar->FinalizeUpdate();
    FindEnrichment();
    first_tip_dof.assign(tips.size(), 0);
    size_t dofs = 2*(NumScalar() + NumHeaviside());
    for (size_t i = 0; i < tips.size(); i++)
      {
        first_tip_dof[i] = dofs;
        if (tips[i]) dofs += tips[i]->Size();
      }
    SetNDof(dofs);

    functions[VOL].clear();
    functions[BND].clear();
    CollectHeaviside(VOL);
    CollectHeaviside(BND);
    CollectTips();
    // every element of a disk has the tip's functions: atomic, so that they do not serialise the assembly
    is_atomic_dof = BitArray(dofs);
    is_atomic_dof.Clear();
    for (size_t dof = 2*(NumScalar() + NumHeaviside()); dof < dofs; dof++) is_atomic_dof.SetBit(dof);
    UpdateCouplingDofArray();
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

  /// The base class fixes all functions of a Dirichlet vertex or edge; those that vanish on the boundary beside it are free.
  void CrackFESpace :: UpdateFreeDofs ()
  {
    FESpace::UpdateFreeDofs();
    BitArray traced(ndof);
    traced.Clear();
    Array<DofId> dofs;
    for (size_t i = 0; i < ma->GetNE(BND); i++)
      if (dirichlet_boundaries.Size() && dirichlet_boundaries[ma->GetElement(ElementId(BND, i)).GetIndex()])
        {
          GetDofNrs(ElementId(BND, i), dofs);
          for (auto dof : dofs) traced.SetBit(dof);
        }
    for (size_t j = 0; j < NumHeaviside(); j++)
      for (int k : { 0, 1 })
        if (auto dof = HeavisideDof(j, k); !traced.Test(dof))
          {
            dirichlet_dofs.Clear(dof);
            free_dofs->SetBit(dof);
            if (GetDofCouplingType(dof) != LOCAL_DOF) external_free_dofs->SetBit(dof);
          }
  }

  void CrackFESpace :: FindEnrichment ()
  {
    enrichment.clear();
    supports.clear();
    for (size_t c = 0; c < body->NumCracks(); c++)
      {
        std::set<std::pair<int, size_t>> nodes;
        for (auto & location : body->Location(c).Elements())
          {
            auto el = ma->GetElement(ElementId(VOL, location.element));
            for (auto v : el.Vertices()) nodes.insert({ NT_VERTEX, v });
            for (auto e : el.Edges()) nodes.insert({ NT_EDGE, e });
            nodes.insert({ NT_CELL, location.element });
          }
        for (auto [type, nr] : nodes)
          EnrichNode(NodeId(NODE_TYPE(type), nr), c);
      }
  }

  void CrackFESpace :: EnrichNode (NodeId node, size_t crack)
  {
    Array<DofId> dofs;
    scalar->GetDofNrs(node, dofs);
    if (dofs.Size() == 0) return;
    auto support = ElementsOf(node);
    if (HoldsTip(node, support, crack) || !IsCrossed(node, support, crack)) return;
    auto sides = SupportSides(node, support, crack);
    auto [plus, minus] = SupportAreas(sides, crack);
    if (std::min(plus, minus) < smallest_part*(plus+minus)) return;
    for (auto dof : dofs)
      enrichment.push_back({ dof, supports.size() });
    supports.push_back({ crack, plus >= minus ? 1 : -1, std::move(sides) });
  }

  Array<int> CrackFESpace :: ElementsOf (NodeId node) const
  {
    Array<int> elements;
    if (node.GetType() == NT_VERTEX)
      for (auto el : ma->GetVertexElements(node.GetNr())) elements.Append(el);
    else if (node.GetType() == NT_EDGE)
      ma->GetEdgeElements(node.GetNr(), elements);
    else
      elements.Append(node.GetNr());
    return elements;
  }

  /// Whether the crack ends inside the open support of the functions of a node.
  bool CrackFESpace :: HoldsTip (NodeId node, FlatArray<int> support, size_t crack) const
  {
    for (auto & end : body->Location(crack).Ends())
      {
        if (end.kind != EndKind::Tip) continue;
        if (end.node == node) return true;
        if (end.node.GetType() == NT_CELL && support.Contains(int(end.node.GetNr()))) return true;
        if (end.node.GetType() == NT_EDGE && node.GetType() == NT_VERTEX)
          {
            auto [v0, v1] = ma->GetEdgePNums(end.node.GetNr());
            if (v0 == int(node.GetNr()) || v1 == int(node.GetNr())) return true;
          }
      }
    return false;
  }

  bool CrackFESpace :: IsCrossed (NodeId node, FlatArray<int> support, size_t crack) const
  {
    auto & location = body->Location(crack);
    for (auto element : support)
      if (auto place = location.Find(element); place && place->kind == ElementKind::Cut) return true;
    for (auto edge : location.AlignedEdges())
      {
        auto [v0, v1] = ma->GetEdgePNums(edge);
        if (node == NodeId(NT_EDGE, edge) || node == NodeId(NT_VERTEX, v0) || node == NodeId(NT_VERTEX, v1)) return true;
      }
    return false;
  }

  /// The crack gives the side of what it touches; from there sides spread over the edges that it does not run along.
  /// (The straight extension of the crack beyond a mouth may run through the body again, so distances will not do.)
  std::map<size_t, int> CrackFESpace :: SupportSides (NodeId node, FlatArray<int> support, size_t crack) const
  {
    auto & location = body->Location(crack);
    auto & curve = body->GetCrack(crack);
    std::map<size_t, int> sides;
    std::vector<std::pair<size_t, int>> queue;
    auto place = [&] (size_t element, int side)
    {
      if (support.Contains(int(element)) && !location.Find(element) && sides.insert({ element, side }).second)
        queue.push_back({ element, side });
    };
    auto spread = [&] (size_t element, auto side_of_edge)
    {
      for (auto edge : ma->GetElement(ElementId(VOL, element)).Edges())
        {
          Array<int> neighbours;
          ma->GetEdgeElements(edge, neighbours);
          for (auto neighbour : neighbours)
            if (size_t(neighbour) != element) place(neighbour, side_of_edge(edge));
        }
    };
    for (auto element : support)
      if (auto carried = location.Find(element))
        {
          sides[element] = 0;
          spread(element, [&] (size_t edge)
          {
            // just beyond the edge: the crack may run along it
            auto [v0, v1] = ma->GetEdgePNums(edge);
            auto & t = carried->triangle;
            return int(curve.SideOf(Lerp(Centre({ t[0], t[1], t[2] }), Lerp(ma->GetPoint<2>(v0), ma->GetPoint<2>(v1), 0.5), 1.001)));
          });
        }
    while (!queue.empty())
      {
        auto [element, side] = queue.back();
        queue.pop_back();
        spread(element, [side=side] (size_t) { return side; });
      }
    return sides;
  }

  std::pair<double,double> CrackFESpace :: SupportAreas (const std::map<size_t, int> & sides, size_t crack) const
  {
    double plus = 0, minus = 0;
    for (auto [element, side] : sides)
      if (side == 0)
        {
          auto location = body->Location(crack).Find(element);
          plus += location->area_plus;
          minus += location->area_minus;
        }
      else
        (side > 0 ? plus : minus) += Area(VerticesOf(*ma, element));
    return { plus, minus };
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
    if (component != 0 && component != 1)
      throw Exception("CrackFESpace: component " + ngcore::ToString(component) + " is neither 0 (x) nor 1 (y)");
    return 2*NumScalar() + component*NumHeaviside() + j;
  }

  int CrackFESpace :: HeavisideSide (size_t j, size_t element) const
  {
    auto & sides = SupportOf(j).sides;
    auto it = sides.find(element);
    if (it == sides.end()) throw Exception("CrackFESpace: element " + ngcore::ToString(element) + " is not in the support of Heaviside function " + ngcore::ToString(j));
    return it->second;
  }

  int CrackFESpace :: SideOfBoundaryElement (size_t element, const Support & support) const
  {
    if (body->Location(support.crack).FindBoundaryEdge(element)) return 0;
    auto el = ma->GetElement(ElementId(BND, element));
    Array<int> neighbours;
    ma->GetEdgeElements(el.Edges()[0], neighbours);
    for (auto neighbour : neighbours)
      if (auto it = support.sides.find(neighbour); it != support.sides.end() && it->second != 0) return it->second;
    auto v = el.Vertices();
    return int(body->GetCrack(support.crack).SideOf(Lerp(ma->GetPoint<2>(v[0]), ma->GetPoint<2>(v[1]), 0.5)));
  }

  void CrackFESpace :: CollectHeaviside (VorB vb)
  {
    std::multimap<DofId, size_t> of_dof;
    for (size_t j = 0; j < enrichment.size(); j++) of_dof.insert({ enrichment[j].dof, j });
    BitArray enriched(NumScalar());
    enriched.Clear();
    for (auto [dof, j] : of_dof) enriched.SetBit(dof);

    Array<DofId> dofs;
    for (size_t i = 0; i < ma->GetNE(vb); i++)
      {
        scalar->GetDofNrs(ElementId(vb, i), dofs);
        for (size_t local = 0; local < dofs.Size(); local++)
          if (IsRegularDof(dofs[local]) && enriched.Test(dofs[local]))
            for (auto [it, last] = of_dof.equal_range(dofs[local]); it != last; ++it)
              {
                auto & support = SupportOf(it->second);
                int side = vb == VOL ? HeavisideSide(it->second, i) : SideOfBoundaryElement(i, support);
                HeavisideFunction function { int(local), support.shift, support.crack, side };
                // without a trace on a boundary element it is no unknown of it: a Dirichlet condition must not fix it
                if (vb == BND && side && function.Value(side) == 0) continue;
                auto & f = functions[vb][i];
                f.heaviside.push_back(function);
                f.global.push_back(it->second);
              }
      }
  }

  void CrackFESpace :: CollectTips ()
  {
    for (size_t t = 0; t < tips.size(); t++)
      if (tips[t])
        for (size_t i = 0; i < ma->GetNE(VOL); i++)
          if (DistanceToTriangle(tips[t]->Tip(), VerticesOf(*ma, i)) < tips[t]->Spec().r1)
            {
              auto & f = functions[VOL][i];
              f.tips.push_back(&*tips[t]);
              for (auto dof : TipDofs(t)) f.tip_dofs.push_back(dof);
            }
  }

  std::vector<DofId> CrackFESpace :: TipDofs (size_t tip) const
  {
    std::vector<DofId> dofs;
    for (int m = 0; tips.at(tip) && m < tips[tip]->Size(); m++) dofs.push_back(first_tip_dof[tip]+m);
    return dofs;
  }

  FiniteElement & CrackFESpace :: GetFE (ElementId ei, Allocator & alloc) const
  {
    auto & fe = scalar->GetFE(ei, alloc);
    if (ei.VB() > BND) return fe;
    auto & base = static_cast<BaseScalarFiniteElement&>(fe);
    auto it = functions[ei.VB()].find(ei.Nr());
    if (it == functions[ei.VB()].end())
      return *new (alloc) CrackFiniteElement(base, {}, {}, *body, nullptr);
    auto & f = it->second;
    return *new (alloc) CrackFiniteElement
      (base, FlatArray<HeavisideFunction>(f.heaviside.size(), const_cast<HeavisideFunction*>(f.heaviside.data())),
       FlatArray<const TipFunctions*>(f.tips.size(), const_cast<const TipFunctions**>(f.tips.data())),
       *body, ei.VB() == VOL ? body->Find(ei.Nr()) : nullptr);
  }

  void CrackFESpace :: GetDofNrs (ElementId ei, Array<DofId> & dnums) const
  {
    ArrayMem<DofId, 50> dofs;
    scalar->GetDofNrs(ei, dofs);
    dnums.SetSize0();
    const ElementFunctions * f = nullptr;
    if (ei.VB() <= BND)
      if (auto it = functions[ei.VB()].find(ei.Nr()); it != functions[ei.VB()].end()) f = &it->second;
    for (int k = 0; k < 2; k++)
      {
        for (auto dof : dofs) dnums.Append(IsRegularDof(dof) ? DofId(k*NumScalar()+dof) : dof);
        if (f) for (auto j : f->global) dnums.Append(HeavisideDof(j, k));
      }
    if (f) for (auto dof : f->tip_dofs) dnums.Append(dof);
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
