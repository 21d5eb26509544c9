// N_H: which functions φ_i of V_h the cracks cut, and on which side of a crack each element of their supports lies.

#include "spaces/crack_fespace.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  /// Supports of which less than this part lies on one side are not enriched: the energy of what they miss is
  /// the square root of it, relative to the jump.
  constexpr double smallest_part = 1e-14;

  void CrackFESpace :: FindEnrichment ()
  {
    enrichment.clear();
    supports.clear();
    for (size_t c = 0; c < Geometry().NumCracks(); c++)
      {
        std::set<std::pair<int, size_t>> nodes;
        for (auto element : Geometry().ElementsOf(c))
          {
            auto el = ma->GetElement(ElementId(VOL, element));
            for (auto v : el.Vertices()) nodes.insert({ NT_VERTEX, v });
            for (auto e : el.Edges()) nodes.insert({ NT_EDGE, e });
            nodes.insert({ NT_CELL, element });
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
    if (Geometry().EndsIn(crack, node, support) || !IsCrossed(node, support, crack)) return;
    auto sides = SupportSides(node, support, crack);
    if (sides.size() < support.Size())
      throw Exception("CrackFESpace: the crack passes through the vertex " + ToString(ma->GetPoint<2>(node.GetNr()))
                      + ", where parts of the body hang together by this point alone; lead it beside the vertex");
    auto areas = SupportAreas(sides, crack);
    if (std::min(areas.plus, areas.minus) < smallest_part*(areas.plus+areas.minus)) return;
    for (auto dof : dofs)
      enrichment.push_back({ dof, supports.size() });
    supports.push_back({ crack, int(areas.Larger()), std::move(sides) });
    if (int side = SideOfFixedBoundary(node, supports.back())) supports.back().shift = side;
  }

  /// For each component the length of the boundary at a node on which it is held, on either side of the crack.
  std::array<Measures,2> CrackFESpace :: HeldLengths (NodeId node, const Support & support) const
  {
    std::array<Measures,2> lengths;
    if (node.GetType() == NT_CELL) return lengths;
    bool is_edge = node.GetType() == NT_EDGE;
    for (auto element : ma->GetVertexSurfaceElements(is_edge ? ma->GetEdgePNums(node.GetNr())[0] : node.GetNr()))
      {
        auto el = ma->GetElement(ElementId(BND, element));
        if (is_edge && size_t(el.Edges()[0]) != node.GetNr()) continue;
        Measures sizes;
        if (auto cut = Geometry().BoundarySizes(support.crack, element)) sizes = *cut;
        else sizes[Side(SideOfBoundaryElement(element, support))] = EdgeMap(*ma, element).Length();
        for (int k : { 0, 1 })
          if (held[k][el.GetIndex()]) lengths[k] += sizes;
      }
    return lengths;
  }

  /// The side on which the boundary at a node is held; 0 if it is not. With s_i on this side the function's trace is on the other part only:
  /// else it would depend on φ_i there, and fixing both would fix what lies across the crack. A component that is held on both sides may
  /// have either; if both have, the longer part decides.
  int CrackFESpace :: SideOfFixedBoundary (NodeId node, const Support & support) const
  {
    auto lengths = HeldLengths(node, support);
    auto sign = [] (double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; };
    auto only = [sign] (Measures l) { return l.plus > 0 && l.minus > 0 ? 0 : sign(l.plus - l.minus); };
    int x = only(lengths[0]), y = only(lengths[1]);
    if (x*y < 0)
      throw Exception("CrackFESpace: the crack meets the boundary at the vertex " + ToString(ma->GetPoint<2>(node.GetNr()))
                      + ", where u_x is held on one side of it only and u_y on the other side only; end it beside the vertex, or hold both components on one side");
    if (x+y) return sign(x+y);
    lengths[0] += lengths[1];
    return lengths[0].plus+lengths[0].minus == 0 ? 0 : int(lengths[0].Larger());
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

  bool CrackFESpace :: IsCrossed (NodeId node, FlatArray<int> support, size_t crack) const
  {
    for (auto element : support)
      if (auto here = MetBy(crack, element); here && here->kind == ElementKind::Cut) return true;
    return Geometry().RunsAlong(crack, node);
  }

  /// The crack gives the side of what it touches; from there sides spread over the edges that it does not run along.
  /// (The straight extension of the crack beyond a mouth may run through the body again, so distances will not do.)
  std::map<size_t, int> CrackFESpace :: SupportSides (NodeId node, FlatArray<int> support, size_t crack) const
  {
    std::map<size_t, int> sides;
    std::vector<std::pair<size_t, int>> queue;
    auto place = [&] (size_t element, int side)
    {
      if (support.Contains(int(element)) && !MetBy(crack, element) && sides.insert({ element, side }).second)
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
      if (MetBy(crack, element))
        {
          sides[element] = 0;
          spread(element, [&] (size_t edge) { return int(Geometry().SideBeyond(crack, element, edge)); });
        }
    while (!queue.empty())
      {
        auto [element, side] = queue.back();
        queue.pop_back();
        spread(element, [side=side] (size_t) { return side; });
      }
    return sides;
  }

  Measures CrackFESpace :: SupportAreas (const std::map<size_t, int> & sides, size_t crack) const
  {
    Measures areas;
    for (auto [element, side] : sides)
      if (side == 0) areas += MetBy(crack, element)->sizes;
      else areas[Side(side)] += Area(VerticesOf(*ma, element));
    return areas;
  }

  const ElementCrack * CrackFESpace :: MetBy (size_t crack, size_t element) const
  {
    auto cut = Geometry().Find(element);
    return cut ? cut->Find(crack) : nullptr;
  }
}
