// N_H: which functions φ_i of V_h have copies, one for each connected part of their supports but the largest.

#include "spaces/enriched_space.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  namespace
  {
    string ComponentName (int component) { return "u_" + HeldFlag(component).substr(9); }

    /// The boundary elements that have a node.
    std::vector<size_t> BoundaryAt (const MeshAccess & mesh, NodeId node)
    {
      std::vector<size_t> elements;
      size_t vertex = node.GetType() == NT_VERTEX ? node.GetNr() : node.GetType() == NT_EDGE ? mesh.GetEdgePNums(node.GetNr())[0] : mesh.GetFacePNums(node.GetNr())[0];
      for (auto element : mesh.GetVertexSurfaceElements(vertex))
        {
          auto el = mesh.GetElement(ElementId(BND, element));
          auto has = [&] (auto && nodes)
          {
            bool found = false;
            for (auto nr : nodes) found = found || size_t(nr) == node.GetNr();
            return found;
          };
          if (node.GetType() == NT_VERTEX || (node.GetType() == NT_EDGE ? has(el.Edges()) : has(el.Faces()))) elements.push_back(element);
        }
      return elements;
    }
  }

  namespace
  {
    /// The middle of a boundary element in the reference coordinates of a neighbour.
    ngfem::IntegrationPoint MiddleIn (const MeshAccess & mesh, size_t neighbour, size_t boundary_element)
    {
      auto el = mesh.GetElement(ElementId(VOL, neighbour));
      auto on_boundary = mesh.GetElement(ElementId(BND, boundary_element)).Vertices();
      auto reference = ngfem::ElementTopology::GetVertices(el.GetType());
      ngfem::IntegrationPoint middle(0, 0, 0, 0);
      for (size_t i = 0; i < el.Vertices().Size(); i++)
        if (on_boundary.Contains(el.Vertices()[i]))
          for (int d = 0; d < 3; d++) middle(d) += reference[i][d] / on_boundary.Size();
      return middle;
    }
  }

  /// A smaller part of a support than this has no copy: the energy of what is missed is the square root of it, relative to the jump.
  constexpr double smallest_part = 1e-14;

  template <int D>
  void EnrichedSpace<D> :: FindEnrichment ()
  {
    enrichment.clear();
    supports.clear();
    copies.clear();
    std::set<std::pair<int, size_t>> nodes;
    for (auto element : Geometry().CrackedElements())
      {
        auto el = ma->GetElement(ElementId(VOL, element));
        for (auto v : el.Vertices()) nodes.insert({ NT_VERTEX, v });
        for (auto type : MeshParts<D>::between)
          for (auto nr : type == NT_EDGE ? el.Edges() : el.Faces()) nodes.insert({ type, nr });
        nodes.insert({ NT_CELL, element });
      }
    for (auto [type, nr] : nodes)
      EnrichNode(NodeId(NODE_TYPE(type), nr));
  }

  template <int D>
  void EnrichedSpace<D> :: EnrichNode (NodeId node)
  {
    Array<DofId> dofs;
    scalar->GetDofNrs(node, dofs);
    if (dofs.Size() == 0) return;
    auto support = SupportOf(node);
    if (support.sizes.size() == 1) return;
    CheckHinge(node, support);
    auto borders = BordersOf(support);
    support.base = BaseOf(node, support, borders);
    double whole = std::accumulate(support.sizes.begin(), support.sizes.end(), 0.);
    for (size_t component = 0; component < support.sizes.size(); component++)
      {
        if (component == support.base || support.sizes[component] < smallest_part*whole) continue;
        for (auto dof : dofs) enrichment.push_back({ dof, copies.size() });
        copies.push_back(CopyOn(component, support, borders));
      }
    supports.push_back(std::move(support));
  }

  template <int D>
  Array<int> EnrichedSpace<D> :: ElementsOf (NodeId node) const
  {
    Array<int> elements;
    if (node.GetType() == NT_VERTEX)
      for (auto el : ma->GetVertexElements(node.GetNr())) elements.Append(el);
    else if (node.GetType() == NT_EDGE)
      ma->GetEdgeElements(node.GetNr(), elements);
    else if (node.GetType() == NT_FACE)
      ma->GetFaceElements(node.GetNr(), elements);
    else
      elements.Append(node.GetNr());
    return elements;
  }

  template <int D>
  std::optional<size_t> EnrichedSpace<D>::Support :: ComponentOf (PartOfElement part) const
  {
    auto here = std::ranges::find(elements, part.element);
    if (here == elements.end()) return std::nullopt;
    return component[first[here-elements.begin()] + part.part];
  }

  /// visit(i, j, facet) for two elements of a support, in the mesh's order, that share a facet.
  template <int D>
  template <typename F>
  void EnrichedSpace<D> :: VisitNeighbours (const Support & support, F && visit) const
  {
    for (size_t i = 0; i < support.elements.size(); i++)
      for (auto facet : ma->GetElement(ElementId(VOL, support.elements[i])).Facets())
        {
          Array<int> both;
          ma->GetFacetElements(facet, both);
          if (both.Size() < 2 || size_t(both[0]) != support.elements[i]) continue;
          if (auto other = std::ranges::find(support.elements, size_t(both[1])); other != support.elements.end())
            visit(i, size_t(other-support.elements.begin()), facet);
        }
  }

  template <int D>
  auto EnrichedSpace<D> :: SupportOf (NodeId node) const -> Support
  {
    Support support;
    std::vector<double> sizes;
    for (auto element : ElementsOf(node))
      {
        support.elements.push_back(element);
        support.first.push_back(sizes.size());
        if (auto cut = Geometry().Find(element)) sizes.insert(sizes.end(), cut->sizes.begin(), cut->sizes.end());
        else sizes.push_back(MeshParts<D>::ElementSize(*ma, element));
      }
    Forest forest(sizes.size());
    VisitNeighbours(support, [&] (size_t i, size_t j, size_t facet)
    { for (auto [here, there] : Geometry().Links(facet)) forest.Join(support.first[i]+here, support.first[j]+there); });
    support.component = forest.Trees();
    for (size_t part = 0; part < sizes.size(); part++)
      {
        support.sizes.resize(std::max(support.sizes.size(), support.component[part]+1), 0.);
        support.sizes[support.component[part]] += sizes[part];
      }
    return support;
  }

  /// Where the body hangs together by a vertex alone, its parts have one function without cracks; a crack through the vertex would have to
  /// decide whether they still do.
  template <int D>
  void EnrichedSpace<D> :: CheckHinge (NodeId node, const Support & support) const
  {
    if (node.GetType() != NT_VERTEX) return;
    Forest elements(support.elements.size());
    VisitNeighbours(support, [&] (size_t i, size_t j, size_t) { elements.Join(i, j); });
    if (std::ranges::max(elements.Trees()) > 0)
      throw Exception("CrackFESpace: the crack passes through the vertex " + ToString(ma->template GetPoint<D>(node.GetNr()))
                      + ", where parts of the body hang together by this point alone; lead it beside the vertex");
  }

  template <int D>
  auto EnrichedSpace<D> :: BordersOf (const Support & support) const -> std::vector<Border>
  {
    std::vector<Border> borders;
    for (auto element : support.elements)
      if (auto cut = Geometry().Find(element))
        cut->VisitFacets([&] (const CrackSides & sides, double size)
        {
          auto component = [&] (size_t part)
          { return support.ComponentOf(part < cut->NumParts() ? PartOfElement { element, part } : cut->across[part-cut->NumParts()]); };
          auto plus = component(sides.plus), minus = component(sides.minus);
          if (plus && minus && *plus != *minus) borders.push_back({ *plus, *minus, sides.crack, size });
        });
    return borders;
  }

  template <int D>
  auto EnrichedSpace<D> :: CopyOn (size_t component, const Support & support, const std::vector<Border> & borders) const -> Copy
  {
    Copy copy { supports.size(), component, 1, 0 };
    double plus = 0, largest = 0;
    bool beside_base = std::ranges::any_of(borders, [&] (auto & border) { return std::minmax({ border.plus, border.minus }) == std::minmax({ component, support.base }); });
    for (auto & border : borders)
      {
        if (border.plus != component && border.minus != component) continue;
        if (beside_base && border.plus != support.base && border.minus != support.base) continue;
        plus += (border.plus == component ? 1 : -1)*border.size;
        if (border.size > largest) { largest = border.size; copy.crack = border.crack; }
      }
    if (plus < 0) copy.sign = -1;
    return copy;
  }

  /// For each component of the support the sizes of the boundary at the node on which each component of u is held.
  template <int D>
  auto EnrichedSpace<D> :: HeldSizesOf (NodeId node, const Support & support) const -> HeldSizes
  {
    HeldSizes held_sizes(support.sizes.size());
    for (auto & sizes : held_sizes) sizes.fill(0);
    if (node.GetType() == NT_CELL) return held_sizes;
    for (auto element : BoundaryAt(*ma, node))
      {
        auto el = ma->GetElement(ElementId(BND, element));
        auto beside = PartsBeside(element);
        auto parts = Geometry().FindBoundary(element);
        for (size_t i = 0; i < beside.size(); i++)
          for (int k = 0; k < D; k++)
            if (auto component = support.ComponentOf(beside[i]); component && held[k][el.GetIndex()])
              held_sizes[*component][k] += parts ? parts->sizes[i] : MeshParts<D>::BoundarySize(*ma, element);
      }
    return held_sizes;
  }

  /// Throws unless some component of a support has all that is held.
  template <int D>
  void EnrichedSpace<D> :: CheckHeld (NodeId node, const HeldSizes & held_sizes) const
  {
    auto holds = [] (auto & sizes, int k) { return sizes[k] > 0; };
    std::vector<int> somewhere;
    for (int k = 0; k < D; k++)
      if (std::ranges::any_of(held_sizes, [&] (auto & sizes) { return holds(sizes, k); })) somewhere.push_back(k);
    for (auto & sizes : held_sizes)
      if (std::ranges::all_of(somewhere, [&] (int k) { return holds(sizes, k); })) return;
    throw Exception("CrackFESpace: the crack meets the boundary at the vertex " + ToString(ma->template GetPoint<D>(node.GetNr()))
                    + ", where " + ComponentName(somewhere.front()) + " is held on one side of it only and " + ComponentName(somewhere.back())
                    + " on the other side only; end it beside the vertex, or hold both components on one side");
  }

  /// The largest component, of those on which the boundary is held if it is: a copy has a trace on its own part of the boundary only, so that
  /// what is fixed on one side of a crack does not fix what lies across it. Of equals that on the plus side of the first crack, so that no numbering decides.
  template <int D>
  size_t EnrichedSpace<D> :: BaseOf (NodeId node, const Support & support, const std::vector<Border> & borders) const
  {
    auto held_sizes = HeldSizesOf(node, support);
    CheckHeld(node, held_sizes);
    std::vector<double> size = support.sizes;
    std::array<bool,D> anywhere {};
    for (auto & sizes : held_sizes)
      for (int k = 0; k < D; k++) anywhere[k] = anywhere[k] || sizes[k] > 0;
    if (std::ranges::count(anywhere, true))
      for (size_t i = 0; i < size.size(); i++)
        {
          bool may = true;
          for (int k = 0; k < D; k++) may = may && (!anywhere[k] || held_sizes[i][k] > 0);
          size[i] = may ? std::accumulate(held_sizes[i].begin(), held_sizes[i].end(), 0.) : 0;
        }
    double largest = std::ranges::max(size);
    auto rank = [&] (size_t component)
    {
      // how often it lies on the minus side, crack by crack
      std::map<size_t, double> below;
      for (auto & border : borders)
        {
          if (border.plus == component) below[border.crack] -= border.size;
          if (border.minus == component) below[border.crack] += border.size;
        }
      std::vector<std::pair<size_t, int>> signs;
      for (auto [crack, size] : below) signs.push_back({ crack, size > 0 ? 1 : -1 });
      return signs;
    };
    std::optional<size_t> best;
    for (size_t i = 0; i < size.size(); i++)
      if (size[i] >= (1-1e-8)*largest && (!best || rank(i) < rank(*best))) best = i;
    return *best;
  }

  template <int D>
  std::vector<signed char> EnrichedSpace<D> :: HeavisideFactors (size_t j, size_t element) const
  {
    auto & copy = CopyOf(j);
    if (!std::ranges::count(supports[copy.support].elements, element))
      throw Exception("CrackFESpace: element " + ngcore::ToString(element) + " is not in the support of Heaviside function " + ngcore::ToString(j));
    return Factors(copy, ElementId(VOL, element));
  }

  template <int D>
  signed char EnrichedSpace<D> :: Factor (const Copy & copy, PartOfElement part) const
  {
    auto component = supports[copy.support].ComponentOf(part);
    return component == copy.component ? copy.sign : 0;
  }

  /// Of which parts of neighbours a boundary element and its parts are facets.
  template <int D>
  std::vector<PartOfElement> EnrichedSpace<D> :: PartsBeside (size_t element) const
  {
    if (auto parts = Geometry().FindBoundary(element)) return parts->beside;
    Array<int> neighbours;
    ma->GetFacetElements(MeshParts<D>::FacetOf(*ma, element), neighbours);
    size_t neighbour = neighbours[0];
    auto cut = Geometry().Find(neighbour);
    return { { neighbour, cut && cut->NumParts() > 1 ? cut->PartAt(MiddleIn(*ma, neighbour, element)) : 0 } };
  }

  template <int D>
  std::vector<signed char> EnrichedSpace<D> :: Factors (const Copy & copy, ElementId ei) const
  {
    std::vector<PartOfElement> parts;
    if (ei.VB() == BND) parts = PartsBeside(ei.Nr());
    else
      {
        auto cut = Geometry().Find(ei.Nr());
        for (size_t i = 0; i < (cut ? cut->NumParts() : 1); i++) parts.push_back({ ei.Nr(), i });
        if (cut) parts.insert(parts.end(), cut->across.begin(), cut->across.end());
      }
    std::vector<signed char> factors;
    for (auto & part : parts) factors.push_back(Factor(copy, part));
    return factors;
  }

  template class EnrichedSpace<2>;
  template class EnrichedSpace<3>;
}
