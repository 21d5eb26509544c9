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
    if (sides.size() < support.Size())
      throw Exception("CrackFESpace: the crack passes through the vertex " + ToString(ma->GetPoint<2>(node.GetNr()))
                      + ", where parts of the body hang together by this point alone; lead it beside the vertex");
    auto [plus, minus] = SupportAreas(sides, crack);
    if (std::min(plus, minus) < smallest_part*(plus+minus)) return;
    for (auto dof : dofs)
      enrichment.push_back({ dof, supports.size() });
    supports.push_back({ crack, int(LargerSide(plus, minus)), std::move(sides) });
    if (int side = SideOfFixedBoundary(node, supports.back())) supports.back().shift = side;
  }

  /// For each component the length of the boundary at a node on which it is held, on either side of the crack.
  std::array<CrackFESpace::HeldLength,2> CrackFESpace :: HeldLengths (NodeId node, const Support & support) const
  {
    std::array<HeldLength,2> lengths;
    if (node.GetType() == NT_CELL) return lengths;
    bool is_edge = node.GetType() == NT_EDGE;
    for (auto element : ma->GetVertexSurfaceElements(is_edge ? ma->GetEdgePNums(node.GetNr())[0] : node.GetNr()))
      {
        auto el = ma->GetElement(ElementId(BND, element));
        if (is_edge && size_t(el.Edges()[0]) != node.GetNr()) continue;
        auto add = [&] (Point a, Point b, int side)
        {
          for (int k : { 0, 1 })
            if (held[k][el.GetIndex()]) (side > 0 ? lengths[k].plus : lengths[k].minus) += Norm(Point(b-a));
        };
        if (auto cut = body->Location(support.crack).FindBoundaryEdge(element))
          for (Point end : { cut->a, cut->b })
            add(end, cut->crossing, int(body->GetCrack(support.crack).SideOf(Lerp(end, cut->crossing, 0.5))));
        else
          add(ma->GetPoint<2>(el.Vertices()[0]), ma->GetPoint<2>(el.Vertices()[1]), SideOfBoundaryElement(element, support));
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
    auto only = [sign] (HeldLength l) { return l.plus > 0 && l.minus > 0 ? 0 : sign(l.plus - l.minus); };
    int x = only(lengths[0]), y = only(lengths[1]);
    if (x*y < 0)
      throw Exception("CrackFESpace: the crack meets the boundary at the vertex " + ToString(ma->GetPoint<2>(node.GetNr()))
                      + ", where u_x is held on one side of it only and u_y on the other side only; end it beside the vertex, or hold both components on one side");
    if (x+y) return sign(x+y);
    double plus = lengths[0].plus + lengths[1].plus, minus = lengths[0].minus + lengths[1].minus;
    return plus+minus == 0 ? 0 : int(LargerSide(plus, minus));
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
            Point beyond = Lerp(Centre({ t[0], t[1], t[2] }), Lerp(ma->GetPoint<2>(v0), ma->GetPoint<2>(v1), 0.5), 1.001);
            return int(curve.SideOf(ElementMap(*ma, carried->element).Value(beyond)));
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
}
