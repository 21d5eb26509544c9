#include "spaces/linear_sheet_trace_space.hpp"
#include "cut/forest.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using namespace ngcomp;

  constexpr double least_side = 1e-6;                      // of a polygon between two nodes, relative to the element
  constexpr double least_area = 1e-15;                     // of S in an element that has a constant of its own, relative to its square

  namespace
  {
    class HatElement : public TraceElement<3>
    {
      const Plane & plane;
      const Polygon & polygon;
      const std::vector<int> & local;
    public:
      HatElement (const Plane & aplane, const Polygon & apolygon, const std::vector<int> & alocal, size_t nd)
        : TraceElement<3>(int(nd), 1), plane(aplane), polygon(apolygon), local(alocal) { }

      void CalcShape (const IntegrationPoint &, Point3 x, BareSliceVector<> shape) const override
      {
        shape.Range(0, ndof) = 0;
        Point p = plane.Project(x);
        auto [i, j] = TriangleAt(p);
        auto area = [] (Point a, Point b, Point c) { return Cross(Point(b-a), Point(c-a)); };
        Point a = polygon[0], b = polygon[i], c = polygon[j];
        double whole = area(a, b, c), first = area(p, b, c)/whole, second = area(a, p, c)/whole;
        shape(local[0]) += first;
        shape(local[i]) += second;
        shape(local[j]) += 1-first-second;
      }

    private:
      /// That of the Fan of the polygon, whose triangles the rules have, too: of a quadrilateral by the side of its diagonal, the larger one if the other is a needle.
      std::array<size_t,2> TriangleAt (Point p) const
      {
        if (polygon.size() == 3) return { 1, 2 };
        Point diagonal = polygon[2]-polygon[0];
        double here = Cross(diagonal, Point(polygon[1]-polygon[0])), there = Cross(diagonal, Point(polygon[3]-polygon[0]));
        bool first = Cross(diagonal, Point(p-polygon[0])) * here >= 0;
        if (std::abs(here) < 1e-12*std::abs(there)) first = false;
        if (std::abs(there) < 1e-12*std::abs(here)) first = true;
        return first ? std::array<size_t,2> { 1, 2 } : std::array<size_t,2> { 2, 3 };
      }
    };
  }

  namespace
  {
    /// For each corner of the polygon of an element the one whose value a function has there: itself, beyond a front the nearest one on S. Empty where none is on S.
    std::vector<size_t> NodesBeforeFront (const SheetCell & cell, const Sheet & sheet)
    {
      std::vector<size_t> on_sheet, of_corner;
      for (size_t i = 0; i < cell.polygon.size(); i++)
        if (cell.kind != ElementKind::Tip || sheet.Contains(cell.polygon[i])) on_sheet.push_back(i);
      if (on_sheet.empty()) return of_corner;
      for (auto & corner : cell.polygon)
        of_corner.push_back(*std::ranges::min_element(on_sheet, {}, [&] (size_t i) { return Norm(Point(cell.polygon[i]-corner)); }));
      return of_corner;
    }

    /// Whether more of S is in an element than round-off.
    bool HasTrace (const CutTet & cut) { return cut.FacetArea() > least_area*sqr(cut.h); }

    /// A point of S in an element, the centre of the largest triangle there.
    Point MiddleOf (const CutTet & cut)
    {
      auto & triangle = std::ranges::max_element(cut.Facet(), {}, [] (auto & t) { return Area(t); })->triangle;
      return Centre({ triangle.begin(), triangle.end() });
    }
  }

  LinearSheetTraceSpace :: LinearSheetTraceSpace (shared_ptr<CrackedSolid> abody) : FESpace(abody->GetMesh(), Flags().SetFlag("order", 1).SetFlag("autoupdate", false)), body(abody)
  {
    type = "linearsheettracespace";
    evaluator[VOL] = make_shared<TraceOperator<3>>();
    std::map<std::pair<size_t,TraceNode>, size_t> number;
    std::vector<std::pair<size_t,Point>> places;
    std::vector<std::array<size_t,2>> sides;
    std::map<size_t, std::vector<size_t>> of_element;
    std::vector<size_t> without_trace;                     // elements that hold no more than round-off of S: they get the nearest node
    Forest forest;
    for (auto & [element, cut] : body->CutTets())
      {
        auto & cell = cut.Cell();
        size_t sheet = cut.Sides().crack, n = cell.nodes.size();
        auto & here = of_element[element];
        auto add = [&] (Point place)
        {
          places.push_back({ sheet, place });
          return forest.Add();
        };
        auto node_before = NodesBeforeFront(cell, body->Sheets()[sheet]);
        if (node_before.empty())
          {
            if (HasTrace(cut)) here.assign(n, add(MiddleOf(cut)));
            else without_trace.push_back(element);
          }
        for (size_t i : node_before)
          {
            auto known = number.find({ sheet, cell.nodes[i] });
            if (known == number.end()) known = number.insert({ { sheet, cell.nodes[i] }, add(cell.polygon[i]) }).first;
            here.push_back(known->second);
          }
        for (size_t i = 0; i < node_before.size(); i++)
          {
            size_t j = (i+1) % n;
            if (node_before[i] != i || node_before[j] != j) continue;
            if (Norm(Point(cell.polygon[j]-cell.polygon[i])) < least_side*cut.h) forest.Join(here[i], here[j]);
            else sides.push_back({ here[i], here[j] });
          }
      }
    for (size_t element : without_trace)
      {
        auto & cut = *body->Find(element);
        Point centre = Centre(cut.Cell().polygon);
        auto distance = [&] (auto & place) { return place.first == cut.Sides().crack ? Norm(Point(place.second-centre)) : std::numeric_limits<double>::infinity(); };
        of_element[element].assign(cut.Cell().nodes.size(), std::ranges::min_element(places, {}, distance)-places.begin());
      }
    auto trees = forest.Trees();
    for (size_t i = 0; i < places.size(); i++)
      if (trees[i] == nodes.positions.size())
        {
          nodes.sheets.push_back(places[i].first);
          nodes.positions.push_back(body->Sheets()[places[i].first].GetPlane().Value(places[i].second));
        }
    std::set<std::array<size_t,2>> pairs;
    for (auto & [i, j] : sides)
      if (trees[i] != trees[j]) pairs.insert({ std::min(trees[i], trees[j]), std::max(trees[i], trees[j]) });
    nodes.neighbours.assign(pairs.begin(), pairs.end());
    for (auto & [element, here] : of_element)
      {
        auto & [dofs, local] = corners[element];
        for (size_t i : here)
          {
            auto known = std::ranges::find(dofs, DofId(trees[i]));
            local.push_back(int(known-dofs.begin()));
            if (known == dofs.end()) dofs.push_back(DofId(trees[i]));
          }
      }
  }

  void LinearSheetTraceSpace :: Update ()
  {
    body->CheckMesh();
    FESpace::Update();
    SetNDof(nodes.positions.size());
    ctofdof.SetSize(ndof);
    ctofdof = WIREBASKET_DOF;
  }

  FiniteElement & LinearSheetTraceSpace :: GetFE (ElementId ei, Allocator & alloc) const
  {
    body->CheckMesh();
    if (ei.VB() == BND) return *new (alloc) DummyFE<ET_TRIG>();
    if (ei.VB() != VOL) return *new (alloc) DummyFE<ET_SEGM>();
    auto here = FindIn(corners, ei.Nr());
    if (!here) return *new (alloc) DummyFE<ET_TET>();
    auto & cut = *body->Find(ei.Nr());
    return *new (alloc) HatElement (body->Sheets()[cut.Sides().crack].GetPlane(), cut.Cell().polygon, here->local, here->dofs.size());
  }

  void LinearSheetTraceSpace :: GetDofNrs (ElementId ei, Array<DofId> & dnums) const
  {
    body->CheckMesh();
    dnums.SetSize0();
    if (ei.VB() != VOL) return;
    if (auto here = FindIn(corners, ei.Nr()))
      for (auto dof : here->dofs) dnums.Append(dof);
  }
}
