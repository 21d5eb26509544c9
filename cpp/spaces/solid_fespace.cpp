#include "spaces/solid_fespace.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  constexpr double least_cosine = 0.2;             // of the angle by which e₁ may turn in a support: where the normals of a front meet its modes jump

  SolidFESpace :: SolidFESpace (shared_ptr<const CrackedSolid> abody, std::optional<FrontSpec> spec, const Flags & flags)
    : EnrichedSpace<3>(abody, flags), body(abody)
  {
    type = "solidfespace";
    if (spec)
      {
        if (spec->material.size() != body->Fronts().size())
          throw Exception("CrackFESpace: " + ngcore::ToString(spec->material.size()) + " materials for " + ngcore::ToString(body->Fronts().size()) + " fronts; give one for each (body.fronts)");
        for (size_t i = 0; i < body->Fronts().size(); i++) modes.push_back({ body->Fronts()[i], spec->material[i] });
        demand = spec->rules;
      }
    rules = RulesOf(body, modes.empty() ? std::nullopt : std::optional(demand));
  }

  std::optional<FrontSpec> SolidFESpace :: Spec () const
  {
    if (modes.empty()) return std::nullopt;
    FrontSpec spec { {}, demand };
    for (auto & mode : modes) spec.material.push_back(mode.Material());
    return spec;
  }

  void SolidFESpace :: SetFrontMaterial (size_t front, ModeMaterial material)
  {
    if (front >= modes.size()) throw Exception("CrackFESpace: there are no modes of front " + ngcore::ToString(front));
    modes[front].SetMaterial(material);
  }

  size_t SolidFESpace :: CollectSingular ()
  {
    FindNodes();
    for (auto vb : { VOL, BND }) AddModes(vb);
    return FrontFunctions::size*nodes.size();
  }

  std::map<size_t, int> SolidFESpace :: PartlyHeldVertices () const
  {
    std::map<size_t, int> vertices;
    for (auto el : ma->Elements(BND))
      if (int region = el.GetIndex(); IsHeld(region) && !IsWhollyHeld(region))
        {
          auto [a, b, c] = MeshParts<3>::TriangleOf(*ma, el.Nr());
          Point3 normal = Cross(Point3(b-a), Point3(c-a));
          int axis = -1, number = 0;
          for (int k = 0; k < 3; k++)
            if (HeldRegions(k)[region] && ++number && std::abs(normal(k)) > (1-1e-12)*L2Norm(normal)) axis = k;
          if (number > 1) axis = -1;
          for (auto v : el.Vertices())
            if (auto [it, isnew] = vertices.insert({ v, axis }); !isnew && it->second != axis) it->second = -1;
        }
    return vertices;
  }

  bool SolidFESpace :: HasOnly (DofId dof, int component) const
  {
    size_t number = dof-FirstSingularDof();
    return number % FrontFunctions::size == 2 && nodes[number / FrontFunctions::size].along == component;
  }

  size_t SolidFESpace :: NearestFront (size_t sheet, Point3 x) const
  {
    auto & fronts = body->Fronts();
    size_t nearest = fronts.size();
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < fronts.size(); i++)
      if (fronts[i].SheetNumber() == sheet)
        if (double distance = fronts[i].Distance(x); distance < least)
          {
            least = distance;
            nearest = i;
          }
    return nearest;
  }

  /// Whether the modes are smooth around a node but for the sheet: all of its support is nearest to one smooth stretch of its front, which does not turn away.
  bool SolidFESpace :: IsAlone (FrontNode node) const
  {
    auto & front = body->Fronts()[node.front];
    auto foot_of = [&] (size_t vertex) { return front.Tube(ma->GetPoint<3>(vertex)).s; };
    double foot = foot_of(node.vertex);
    auto own = front.StretchAt(foot);
    if (!own) return false;
    Point3 ahead = front.FrameAt(foot)[0];
    auto belongs = [&] (size_t vertex)
    {
      double s = foot_of(vertex);
      return front.StretchAt(s) == own && Dot(front.FrameAt(s)[0], ahead) > least_cosine && NearestFront(front.SheetNumber(), ma->GetPoint<3>(vertex)) == node.front;
    };
    for (auto element : ma->GetVertexElements(node.vertex))
      for (auto v : ma->GetElement(ElementId(VOL, element)).Vertices())
        if (!belongs(v)) return false;
    return true;
  }

  /// Whether what is held at a node is a component along the front there, or nothing.
  bool SolidFESpace :: LeavesAlong (FrontNode node) const
  {
    if (!node.along) return true;
    auto & front = body->Fronts()[node.front];
    return *node.along >= 0 && std::abs(front.FrameAt(front.Tube(ma->GetPoint<3>(node.vertex)).s)[2](*node.along)) > 1-1e-10;
  }

  void SolidFESpace :: FindNodes ()
  {
    nodes.clear();
    num_left_out = 0;
    if (modes.empty()) return;
    auto partly_held = PartlyHeldVertices();
    for (size_t sheet = 0; sheet < body->NumCracks(); sheet++)
      {
        std::set<size_t> around;
        for (auto & [v, longest] : body->FrontNodes(sheet)) around.insert(v);
        if (demand.radius > 0)
          for (size_t v = 0; v < ma->GetNV(); v++)
            for (auto & front : body->Fronts())
              if (front.SheetNumber() == sheet && front.Distance(ma->GetPoint<3>(v)) < demand.radius) around.insert(v);
        for (auto v : around)
          {
            FrontNode node { v, NearestFront(sheet, ma->GetPoint<3>(v)), std::nullopt };
            if (auto it = partly_held.find(v); it != partly_held.end()) node.along = it->second;
            if (IsAlone(node) && LeavesAlong(node)) nodes.push_back(node);
            else if (body->FrontNodes(sheet).contains(v)) num_left_out++;
          }
      }
  }

  void SolidFESpace :: AddModes (VorB vb)
  {
    modes_of[vb].SetSize(ma->GetNE(vb));
    modes_of[vb] = 0;
    modes_in[vb].assign(1, {});
    flat_maps[vb].clear();
    std::map<std::pair<size_t,size_t>, const FlatMap*> map_of;                  // by element and sheet
    std::vector<size_t> by_front(nodes.size());
    std::iota(by_front.begin(), by_front.end(), 0);
    std::ranges::stable_sort(by_front, {}, [&] (size_t j) { return nodes[j].front; });
    auto flat_map = [&] (size_t element, size_t sheet) -> const FlatMap *
    {
      if (body->Sheets()[sheet].IsPlanar()) return nullptr;
      auto & map = map_of[{ element, sheet }];
      if (!map)
        map = &(vb == VOL ? flat_maps[vb].emplace_back(MeshParts<3>::TetOf(*ma, element), body->FlatTet(sheet, element, true))
                          : flat_maps[vb].emplace_back(MeshParts<3>::TriangleOf(*ma, element), body->FlatTriangle(sheet, element)));
      return map;
    };
    auto add = [&] (size_t element, size_t j, Vec<4> hat)
    {
      size_t sheet = body->Fronts()[nodes[j].front].SheetNumber();
      auto & number = modes_of[vb][element];
      if (number == 0)
        {
          number = modes_in[vb].size();
          modes_in[vb].push_back({});
        }
      auto & here = modes_in[vb][number];
      auto cut = vb == VOL ? body->Find(element) : nullptr;
      here.nodes.push_back({ hat, &modes[nodes[j].front], !cut || cut->Sides().crack == sheet, flat_map(element, sheet) });
      for (int m = 0; m < FrontFunctions::size; m++) here.dofs.push_back(FrontDof(j, m));
    };
    auto corner = [&] (size_t element, size_t v)
    {
      size_t number = 0;
      auto vertices = ma->GetElement(ElementId(vb, element)).Vertices();
      while (size_t(vertices[number]) != v) number++;
      return number;
    };
    for (size_t j : by_front)
      if (size_t v = nodes[j].vertex; vb == VOL)
        for (auto element : ma->GetVertexElements(v)) add(element, j, Hats(MeshParts<3>::TetOf(*ma, element))[corner(element, v)]);
      else
        for (auto element : ma->GetVertexSurfaceElements(v)) add(element, j, Hats(MeshParts<3>::TriangleOf(*ma, element))[corner(element, v)]);
  }
}
