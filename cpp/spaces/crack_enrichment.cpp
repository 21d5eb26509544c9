// N_H: which functions φ_i of V_h have copies, one for each connected part of their supports but the largest.

#include "spaces/crack_fespace.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  /// A smaller part of a support than this has no copy: the energy of what is missed is the square root of it, relative to the jump.
  constexpr double smallest_part = 1e-14;

  void CrackFESpace :: FindEnrichment ()
  {
    enrichment.clear();
    supports.clear();
    copies.clear();
    std::set<std::pair<int, size_t>> nodes;
    for (auto element : Geometry().CrackedElements())
      {
        auto el = ma->GetElement(ElementId(VOL, element));
        for (auto v : el.Vertices()) nodes.insert({ NT_VERTEX, v });
        for (auto e : el.Edges()) nodes.insert({ NT_EDGE, e });
        nodes.insert({ NT_CELL, element });
      }
    for (auto [type, nr] : nodes)
      EnrichNode(NodeId(NODE_TYPE(type), nr));
  }

  void CrackFESpace :: EnrichNode (NodeId node)
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

  std::optional<size_t> CrackFESpace::Support :: ComponentOf (PartOfElement part) const
  {
    auto here = std::ranges::find(elements, part.element);
    if (here == elements.end()) return std::nullopt;
    return component[first[here-elements.begin()] + part.part];
  }

  /// visit(i, j, edge) for two elements of a support, in the mesh's order, that share an edge.
  template <typename F>
  void CrackFESpace :: VisitNeighbours (const Support & support, F && visit) const
  {
    for (size_t i = 0; i < support.elements.size(); i++)
      for (auto edge : ma->GetElement(ElementId(VOL, support.elements[i])).Edges())
        {
          Array<int> both;
          ma->GetEdgeElements(edge, both);
          if (both.Size() < 2 || size_t(both[0]) != support.elements[i]) continue;
          if (auto other = std::ranges::find(support.elements, size_t(both[1])); other != support.elements.end())
            visit(i, size_t(other-support.elements.begin()), edge);
        }
  }

  CrackFESpace::Support CrackFESpace :: SupportOf (NodeId node) const
  {
    Support support;
    std::vector<double> sizes;
    for (auto element : ElementsOf(node))
      {
        support.elements.push_back(element);
        support.first.push_back(sizes.size());
        if (auto cut = Geometry().Find(element)) sizes.insert(sizes.end(), cut->sizes.begin(), cut->sizes.end());
        else sizes.push_back(Area(VerticesOf(*ma, element)));
      }
    Forest forest(sizes.size());
    VisitNeighbours(support, [&] (size_t i, size_t j, size_t edge)
    { for (auto [here, there] : Geometry().Links(edge)) forest.Join(support.first[i]+here, support.first[j]+there); });
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
  void CrackFESpace :: CheckHinge (NodeId node, const Support & support) const
  {
    if (node.GetType() != NT_VERTEX) return;
    Forest elements(support.elements.size());
    VisitNeighbours(support, [&] (size_t i, size_t j, size_t) { elements.Join(i, j); });
    if (std::ranges::max(elements.Trees()) > 0)
      throw Exception("CrackFESpace: the crack passes through the vertex " + ToString(ma->GetPoint<2>(node.GetNr()))
                      + ", where parts of the body hang together by this point alone; lead it beside the vertex");
  }

  std::vector<CrackFESpace::Border> CrackFESpace :: BordersOf (const Support & support) const
  {
    std::vector<Border> borders;
    for (auto element : support.elements)
      if (auto cut = Geometry().Find(element))
        cut->VisitFacets([&] (const CrackSides & sides, double length)
        {
          auto component = [&] (size_t part)
          { return support.ComponentOf(part < cut->NumParts() ? PartOfElement { element, part } : cut->across[part-cut->NumParts()]); };
          auto plus = component(sides.plus), minus = component(sides.minus);
          if (plus && minus && *plus != *minus) borders.push_back({ *plus, *minus, sides.crack, length });
        });
    return borders;
  }

  CrackFESpace::Copy CrackFESpace :: CopyOn (size_t component, const Support & support, const std::vector<Border> & borders) const
  {
    Copy copy { supports.size(), component, 1, 0 };
    double plus = 0, longest = 0;
    bool beside_base = std::ranges::any_of(borders, [&] (auto & border) { return std::minmax({ border.plus, border.minus }) == std::minmax({ component, support.base }); });
    for (auto & border : borders)
      {
        if (border.plus != component && border.minus != component) continue;
        if (beside_base && border.plus != support.base && border.minus != support.base) continue;
        plus += (border.plus == component ? 1 : -1)*border.length;
        if (border.length > longest) { longest = border.length; copy.crack = border.crack; }
      }
    if (plus < 0) copy.sign = -1;
    return copy;
  }

  /// For each component of the support the lengths of the boundary at the node on which u_x, and u_y, is held.
  std::vector<std::array<double,2>> CrackFESpace :: HeldLengths (NodeId node, const Support & support) const
  {
    std::vector<std::array<double,2>> lengths(support.sizes.size(), { 0, 0 });
    if (node.GetType() == NT_CELL) return lengths;
    bool is_edge = node.GetType() == NT_EDGE;
    for (auto element : ma->GetVertexSurfaceElements(is_edge ? ma->GetEdgePNums(node.GetNr())[0] : node.GetNr()))
      {
        auto el = ma->GetElement(ElementId(BND, element));
        if (is_edge && size_t(el.Edges()[0]) != node.GetNr()) continue;
        auto beside = PartsBeside(element);
        auto parts = Geometry().FindBoundary(element);
        for (size_t i = 0; i < beside.size(); i++)
          for (int k : { 0, 1 })
            if (auto component = support.ComponentOf(beside[i]); component && held[k][el.GetIndex()])
              lengths[*component][k] += parts ? parts->sizes[i] : EdgeMap(*ma, element).Length();
      }
    return lengths;
  }

  /// The largest component, of those on which the boundary is held if it is: a copy has a trace on its own part of the boundary only, so that
  /// what is fixed on one side of a crack does not fix what lies across it. Of equals that on the plus side of the first crack, so that no numbering decides.
  size_t CrackFESpace :: BaseOf (NodeId node, const Support & support, const std::vector<Border> & borders) const
  {
    auto held_lengths = HeldLengths(node, support);
    std::vector<double> size = support.sizes;
    bool x = false, y = false, both = false;
    for (auto [of_x, of_y] : held_lengths)
      {
        x = x || of_x > 0;
        y = y || of_y > 0;
        both = both || (of_x > 0 && of_y > 0);
      }
    if (x && y && !both)
      throw Exception("CrackFESpace: the crack meets the boundary at the vertex " + ToString(ma->GetPoint<2>(node.GetNr()))
                      + ", where u_x is held on one side of it only and u_y on the other side only; end it beside the vertex, or hold both components on one side");
    if (x || y)
      for (size_t i = 0; i < size.size(); i++)
        {
          auto [of_x, of_y] = held_lengths[i];
          bool may = (!x || of_x > 0) && (!y || of_y > 0);
          size[i] = may ? of_x+of_y : 0;
        }
    double largest = std::ranges::max(size);
    auto rank = [&] (size_t component)
    {
      // how often it lies on the minus side, crack by crack
      std::map<size_t, double> below;
      for (auto & border : borders)
        {
          if (border.plus == component) below[border.crack] -= border.length;
          if (border.minus == component) below[border.crack] += border.length;
        }
      std::vector<std::pair<size_t, int>> signs;
      for (auto [crack, length] : below) signs.push_back({ crack, length > 0 ? 1 : -1 });
      return signs;
    };
    std::optional<size_t> best;
    for (size_t i = 0; i < size.size(); i++)
      if (size[i] >= (1-1e-8)*largest && (!best || rank(i) < rank(*best))) best = i;
    return *best;
  }

  std::vector<signed char> CrackFESpace :: HeavisideFactors (size_t j, size_t element) const
  {
    auto & copy = CopyOf(j);
    if (!std::ranges::count(supports[copy.support].elements, element))
      throw Exception("CrackFESpace: element " + ngcore::ToString(element) + " is not in the support of Heaviside function " + ngcore::ToString(j));
    return Factors(copy, ElementId(VOL, element));
  }

  signed char CrackFESpace :: Factor (const Copy & copy, PartOfElement part) const
  {
    auto component = supports[copy.support].ComponentOf(part);
    return component == copy.component ? copy.sign : 0;
  }

  /// Of which parts of neighbours a boundary element and its parts are facets.
  std::vector<PartOfElement> CrackFESpace :: PartsBeside (size_t element) const
  {
    if (auto parts = Geometry().FindBoundary(element)) return parts->beside;
    Array<int> neighbours;
    ma->GetEdgeElements(ma->GetElement(ElementId(BND, element)).Edges()[0], neighbours);
    return { { size_t(neighbours[0]), 0 } };
  }

  std::vector<signed char> CrackFESpace :: Factors (const Copy & copy, ElementId ei) const
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
}
