#include "cut/cracked_solid.hpp"
#include "cut/facets.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception, ngcore::Array;
  using ngfem::ElementId, ngfem::VOL, ngfem::BND;

  namespace
  {
    /// Straight stretches: what their lines leave of the polygon lies inside or outside.
    std::vector<PartTriangle> CellsIn (const SheetCell & cell, const Sheet & sheet, double tolerance)
    {
      std::vector<Polygon> cells { cell.polygon };
      for (auto & [l, chord] : cell.chords)
        {
          auto & loop = sheet.Loops()[l];
          Line line { loop.PointAt(chord.piece, chord.s0), loop.Normal(chord.piece, chord.s0) };
          std::vector<Polygon> divided;
          for (auto & polygon : cells)
            {
              std::vector<double> d;
              for (auto & p : polygon) d.push_back(line.Snapped(p, 0.01*tolerance));
              for (auto & half : Split(polygon, d))
                if (half.size() > 2) divided.push_back(half);
            }
          cells = std::move(divided);
        }
      std::vector<PartTriangle> triangles;
      for (auto & polygon : cells)
        for (auto & t : Fan(polygon)) triangles.push_back({ t, 0, std::nullopt });
      return triangles;
    }

    /// As the element of a plane body.
    std::vector<PartTriangle> DividedByCurves (const SheetCell & cell, const Sheet & sheet, double tolerance)
    {
      std::vector<ElementChord> chords;
      for (size_t l = 0; l < sheet.Loops().size(); l++)
        {
          std::vector<LoopChord> some;
          for (auto & c : cell.chords)
            if (c.loop == l) some.push_back(c);
          // the last before the first, where the curve goes on from its end to its start in here
          if (some.size() > 1 && some.front().chord.s0 == 0 && some.back().chord.s1 == sheet.Loops()[l].Length())
            {
              auto gap = std::ranges::adjacent_find(some, [&] (auto & a, auto & b) { return b.chord.s0-a.chord.s1 > 2*tolerance; });
              if (gap != some.end()) std::ranges::rotate(some, gap+1);
            }
          for (auto & c : some) chords.push_back({ c.loop, &sheet.Loops()[l], c.chord, false, false, false });
        }
      return ElementDivision(cell.polygon, chords, tolerance).Triangles();
    }

    /// A point inside, also of a cone over a curve.
    Point Middle (const PartTriangle & t)
    {
      if (!t.curved) return Centre({ t.triangle.begin(), t.triangle.end() });
      auto & [curve, chord] = *t.curved;
      return Lerp(t.triangle[0], curve->PointAt(chord.piece, 0.5*(chord.s0+chord.s1)), 0.5);
    }

    /// S in a polygon that its curves enter.
    std::vector<PartTriangle> RegionIn (const SheetCell & cell, const Sheet & sheet, double tolerance)
    {
      bool straight = std::ranges::all_of(cell.chords, [&] (auto & c) { return sheet.Loops()[c.loop].IsStraight(c.chord.piece); });
      auto region = straight ? CellsIn(cell, sheet, tolerance) : DividedByCurves(cell, sheet, tolerance);
      std::erase_if(region, [&] (auto & t) { return !sheet.Contains(Middle(t)); });
      return region;
    }
  }

  CutTet :: CutTet (const MeshAccess & mesh, const SheetCell & acell, const Sheet & sheet, size_t number) : cell(acell)
  {
    auto vertices = mesh.GetElement(ElementId(VOL, cell.element)).Vertices();
    for (int i = 0; i < 4; i++)
      heights[i] = cell.heights[std::ranges::find(cell.corners, size_t(vertices[i])) - cell.corners.begin()];
    h = LongestEdge(cell.in_space);
    cracks.push_back({ number, nullptr, cell.kind });
    auto parts = Split(cell.tet, cell.heights);
    std::array<double,2> volumes { 0, 0 };
    for (int side : { 0, 1 })
      for (auto & t : parts[side]) volumes[side] += Volume(t);
    double volume = sheet.IsPlanar() ? 1 : Volume(cell.in_space)/Volume(cell.tet);
    for (double & v : volumes) v *= volume;
    int larger = volumes[0] >= (1-1e-8)*volumes[1] ? 1 : -1;
    if (IsDivided())
      {
        sizes = { volumes[0], volumes[1] };
        sides = { number, 0, 1, larger };
      }
    else
      {
        sizes = { volumes[0]+volumes[1] };
        sides = { number, 0, 0, larger };
      }
    if (cell.kind == ElementKind::Aligned)
      {
        across.push_back({ *cell.neighbour, 0 });
        sides = larger > 0 ? CrackSides { number, 0, 1, larger } : CrackSides { number, 1, 0, larger };
      }
    if (cell.kind == ElementKind::Tip) facet = RegionIn(cell, sheet, geometric_tolerance*h);
    else
      for (auto & t : Fan(cell.polygon)) facet.push_back({ t, 0, std::nullopt });
    for (auto & t : facet) area += Area(t);
    if (sheet.IsPlanar()) return;
    FlatMap map(cell.in_space, cell.tet);
    Point3 normal = map.Gradient(2), along = Cross(map.Gradient(1), normal);
    stretch = Norm(normal);
    normal = 1/stretch * normal;
    along = 1/Norm(along) * along;
    frame = Frame<3> { normal, { along, Cross(normal, along) } };
    area *= volume*stretch;
  }

  double CutTet :: HeightAt (const ngfem::IntegrationPoint & ip) const
  { return ip(0)*heights[0] + ip(1)*heights[1] + ip(2)*heights[2] + (1-ip(0)-ip(1)-ip(2))*heights[3]; }

  CrackedSolid :: CrackedSolid (shared_ptr<MeshAccess> amesh, std::vector<Sheet> asheets) : mesh(amesh), located_in(*amesh), sheets(std::move(asheets))
  {
    if (sheets.empty()) throw Exception("CrackedMesh: give at least one sheet");
    CheckTetrahedra();
    for (size_t i = 0; i < sheets.size(); i++) locations.emplace_back(*mesh, sheets[i], i);
    CheckApart();
    for (size_t i = 0; i < sheets.size(); i++)
      {
        std::ranges::copy(locations[i].Fronts(), std::back_inserter(fronts));
        for (auto & cell : locations[i].Cells()) cut_tets.try_emplace(cell.element, *mesh, cell, sheets[i], i);
      }
    DivideBoundary();
    FindFrontNodes();
  }

  void CrackedSolid :: FindFrontNodes ()
  {
    front_nodes.resize(sheets.size());
    for (size_t sheet = 0; sheet < sheets.size(); sheet++)
      for (auto element : locations[sheet].FrontElements())
        {
          double h = LongestEdge(MeshParts<3>::TetOf(*mesh, element));
          for (auto v : mesh->GetElement(ElementId(VOL, element)).Vertices())
            {
              double & longest = front_nodes[sheet][v];
              longest = std::max(longest, h);
            }
        }
  }

  void CrackedSolid :: CheckTetrahedra () const
  {
    if (mesh->GetDimension() != 3)
      throw Exception("CrackedMesh: the mesh has dimension " + std::to_string(mesh->GetDimension()) + "; a Sheet cracks a body in space, a Crack one in the plane");
    for (size_t i = 0; i < mesh->GetNE(VOL); i++)
      {
        if (mesh->GetElType(ElementId(VOL, i)) != ngfem::ET_TET)
          throw Exception("CrackedMesh: element " + std::to_string(i) + " is not a tetrahedron; only these are cut by sheets");
        if (mesh->GetElement(ElementId(VOL, i)).is_curved)
          throw Exception("CrackedMesh: element " + std::to_string(i) + " is curved; sheets cut straight tetrahedra only: take the mesh before mesh.Curve");
      }
  }

  void CrackedSolid :: CheckApart () const
  {
    std::map<size_t, size_t> met;
    for (size_t i = 0; i < sheets.size(); i++)
      for (auto & cell : locations[i].Cells())
        for (auto element : { std::optional(cell.element), cell.neighbour })
          if (element && met.insert({ *element, i }).first->second != i)
            throw Exception("CrackedMesh: sheets " + std::to_string(met.at(*element)) + " and " + std::to_string(i) + " meet the same element, near "
                            + ToString(sheets[i].PointAt(Centre(cell.polygon))) + "; sheets keep an element apart: move them, or refine the mesh between them");
  }

  Frame<3> CrackedSolid :: FrameAt (size_t sheet, const ElementCracks<3> * element, Point3 x) const
  {
    auto & plane = sheets[sheet].GetPlane();
    if (sheets[sheet].IsPlanar()) return { plane.normal, plane.axes };
    if (auto cut = static_cast<const CutTet *>(element); cut && cut->Sides().crack == sheet) return *cut->OwnFrame();
    auto [normal, first, second] = sheets[sheet].FrameAt(plane.Project(sheets[sheet].Flat(x)));
    return { normal, { first, second } };
  }

  Tet CrackedSolid :: FlatTet (size_t sheet, size_t element, bool for_modes) const
  {
    Tet t = MeshParts<3>::TetOf(*mesh, element), flat = t;
    if (sheets[sheet].IsPlanar()) return t;
    for (auto & x : flat) x = sheets[sheet].Flat(x);
    if (auto cut = Find(element); (!cut || cut->Sides().crack != sheet || for_modes) && !IsFaithful(flat, t))
      throw Exception("CrackedMesh: sheet " + std::to_string(sheet) + " bends too sharply for what surrounds its front, near " + ToString(Centre(t))
                      + "; refine the mesh there, or take a smaller radius of FrontEnrichment");
    return flat;
  }

  std::array<Point3,3> CrackedSolid :: FlatTriangle (size_t sheet, size_t bnd_element) const
  {
    auto t = MeshParts<3>::TriangleOf(*mesh, bnd_element);
    for (auto & x : t) x = sheets[sheet].Flat(x);
    return t;
  }

  size_t CrackedSolid :: CrackAt (const ElementCracks<3> * element, Point3 x) const
  {
    if (element) return element->cracks[0].crack;
    return std::ranges::min_element(sheets, {}, [x] (auto & sheet)
    {
      Point3 flat = sheet.Flat(x);
      Point p = sheet.GetPlane().Project(flat);
      return std::hypot(sheet.GetPlane().Height(flat), sheet.Contains(p) ? 0 : sheet.Loops()[sheet.NearestLoop(p)].Nearest(p).distance);
    }) - sheets.begin();
  }

  void CrackedSolid :: DivideBoundary ()
  {
    for (size_t i = 0; i < mesh->GetNE(BND); i++)
      {
        auto el = mesh->GetElement(ElementId(BND, i));
        Array<int> both;
        mesh->GetFacetElements(el.Faces()[0], both);
        for (size_t element : both)
          {
            auto cut = Find(element);
            if (!cut || !cut->IsDivided()) continue;
            DividedTriangle parts;
            std::array<Point3,3> t;
            for (int k = 0; k < 3; k++)
              {
                parts.heights[k] = Location(cut->Sides().crack).HeightOf(el.Vertices()[k]);
                t[k] = mesh->GetPoint<3>(el.Vertices()[k]);
              }
            auto [lowest, highest] = std::ranges::minmax(parts.heights);
            if (!(lowest < 0 && highest > 0)) continue;
            double area = 0.5*Norm(Cross(Point3(t[1]-t[0]), Point3(t[2]-t[0])));
            Polygon reference { Point(1., 0.), Point(0., 1.), Point(0., 0.) };
            parts.crack = cut->Sides().crack;
            for (auto & side : Split(reference, { parts.heights.begin(), parts.heights.end() }))
              {
                double size = 0;                           // also of a small side, which a difference would round to nothing
                for (auto & part : Fan(side)) size += 2*Area(part)*area;
                parts.sizes.push_back(size);
              }
            parts.beside = { { element, 0 }, { element, 1 } };
            boundary_parts.emplace(i, std::move(parts));
            break;
          }
      }
  }

  /// A side of a face belongs to a part of either element; a sheet along the face parts them.
  std::vector<std::array<size_t,2>> CrackedSolid :: Links (size_t face) const
  {
    Array<int> both;
    mesh->GetFacetElements(face, both);
    if (both.Size() < 2) return { { 0, 0 } };
    std::array<const CutTet*,2> cut { Find(both[0]), Find(both[1]) };
    for (int k : { 0, 1 })
      if (cut[k] && cut[k]->Cell().kind == ElementKind::Aligned && cut[k]->Cell().neighbour == size_t(both[1-k])) return {};
    std::set<std::array<size_t,2>> links;
    for (int side : { 1, -1 })
      {
        std::array<size_t,2> parts { 0, 0 };
        bool has_side = true;
        for (int k : { 0, 1 })
          if (cut[k] && cut[k]->IsDivided())
            {
              parts[k] = side > 0 ? 0 : 1;
              auto & location = Location(cut[k]->Sides().crack);
              bool here = false;
              for (auto v : mesh->GetFacePNums(face)) here = here || side*location.HeightOf(v) > 0;
              has_side = has_side && here;
            }
        if (has_side) links.insert(parts);
      }
    return { links.begin(), links.end() };
  }
}
