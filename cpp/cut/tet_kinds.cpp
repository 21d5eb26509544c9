// What a sheet is in an element: by the heights of its corners, at faces on the sheet by those of the neighbour, too.

#include "cut/tet_location.hpp"
#include "cut/facets.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Array;
  using ngfem::ElementId, ngfem::VOL;

  void SheetLocation :: LocateElement (size_t element)
  {
    SheetCell cell { element, std::nullopt, ElementKind::Cut, {}, {}, {}, {}, {}, {}, {} };
    auto vertices = mesh.GetElement(ElementId(VOL, element)).Vertices();
    for (int i = 0; i < 4; i++) cell.corners[i] = vertices[i];
    std::ranges::sort(cell.corners);
    std::vector<CutCorner> on_plane;
    for (int i = 0; i < 4; i++)
      {
        cell.tet[i] = flat.at(cell.corners[i]);
        cell.in_space[i] = mesh.GetPoint<3>(cell.corners[i]);
        cell.heights[i] = height.at(cell.corners[i]);
        if (cell.heights[i] == 0) on_plane.push_back({ i, i, cell.tet[i] });
      }
    auto [lowest, highest] = std::ranges::minmax(cell.heights);
    if (on_plane.size() == 4 && !kinks.empty()) return LocateInsideKink(cell, on_plane);
    auto carrier = FaceOnPlane::Here;
    if (on_plane.size() == 3)
      {
        cell.neighbour = Across(cell, on_plane);
        carrier = Carrier(cell, lowest+highest);
        if (carrier == FaceOnPlane::Nowhere) return AddEdges(cell, on_plane);
      }
    if ((lowest*highest < 0 || on_plane.size() > (kinks.empty() ? 1 : 2)) && IsBent(cell))
      {
        if (!IsNear(cell)) return;
        Refuse(kinks.empty() ? "bends too sharply for the elements there; refine the mesh until its radius of curvature is some elements"
                             : "bends or has kinks too sharply for the elements there; refine the mesh until radii of curvature and distances between kinks are some elements", Centre(cell.in_space));
      }
    if (on_plane.size() == 4) Refuse("meets a flat element, whose four corners lie on its plane; mesh the body anew", Centre(cell.in_space));
    if (auto corners = CutPolygon(cell.tet, cell.heights); !corners.empty())
      AddCell(std::move(cell), corners);
    else if (on_plane.size() == 2)
      AddSegment(element, NodeOf(cell, on_plane[0]), NodeOf(cell, on_plane[1]));
    else if (on_plane.size() == 3 && carrier == FaceOnPlane::Here)
      AddCell(std::move(cell), on_plane);
  }

  /// The element behind the face with three corners.
  std::optional<size_t> SheetLocation :: Across (const SheetCell & cell, const std::vector<CutCorner> & on_plane) const
  {
    for (auto face : mesh.GetElement(ElementId(VOL, cell.element)).Faces())
      {
        std::set<size_t> of_face;
        for (auto v : mesh.GetFacePNums(face)) of_face.insert(v);
        if (!std::ranges::all_of(on_plane, [&] (auto & corner) { return of_face.contains(cell.corners[corner.i]); })) continue;
        Array<int> both;
        mesh.GetFacetElements(face, both);
        for (size_t other : both)
          if (other != cell.element) return other;
      }
    return std::nullopt;
  }

  /// All corners are on the sheet, two at least on the edge of a kink: neighbours carry the faces that the sheet runs along.
  void SheetLocation :: LocateInsideKink (const SheetCell & cell, const std::vector<CutCorner> & corners)
  {
    double here = HeightAt(Centre(cell.in_space));
    for (int i = 0; i < 4; i++)
      {
        auto face = corners;
        face.erase(face.begin()+i);
        auto other = Across(cell, face);
        if (!other) continue;
        Tet t = MeshParts<3>::TetOf(mesh, *other);
        double farthest = 0;
        for (auto & x : t) farthest = std::max(farthest, std::abs(HeightAt(x)));
        if (farthest <= geometric_tolerance*LongestEdge(t) && here*HeightAt(Centre(t)) < 0)
          Refuse("runs along a face between two elements whose corners all lie on it; mesh the body anew, or refine the mesh there", Centre(t));
      }
    AddEdges(cell, corners);
  }

  /// Those of an element that lie on the sheet, which it does not carry.
  void SheetLocation :: AddEdges (const SheetCell & cell, const std::vector<CutCorner> & corners)
  {
    for (size_t i = 0; i < corners.size(); i++)
      for (size_t j = 0; j < i; j++)
        {
          Point3 a = cell.in_space[corners[i].i], b = cell.in_space[corners[j].i];
          if (std::abs(HeightAt(Lerp(a, b, 0.5))) <= geometric_tolerance*Norm(Point3(b-a))) AddSegment(cell.element, NodeOf(cell, corners[i]), NodeOf(cell, corners[j]));
        }
  }

  SheetLocation::FaceOnPlane SheetLocation :: Carrier (const SheetCell & cell, double own_height) const
  {
    if (!cell.neighbour)
      {
        // a face of the boundary with corners on both sides of a kink is no part of the sheet
        Point3 centre(0., 0., 0.);
        for (int i = 0; i < 4; i++)
          if (cell.heights[i] == 0) centre += 1./3 * cell.in_space[i];
        return !kinks.empty() && std::abs(HeightAt(centre)) > geometric_tolerance*LongestEdge(cell.in_space) ? FaceOnPlane::Nowhere : FaceOnPlane::Here;
      }
    Tet t = MeshParts<3>::TetOf(mesh, *cell.neighbour);
    auto vertices = mesh.GetElement(ElementId(VOL, *cell.neighbour)).Vertices();
    double there = 0;
    for (int i = 0; i < 4; i++)
      {
        auto known = height.find(vertices[i]);
        double here = known != height.end() ? known->second : HeightAt(t[i]);
        if (std::abs(here) > std::abs(there)) there = here;
      }
    bool inside_kink = there == 0;                         // between faces on the sheet
    if (inside_kink) there = HeightAt(Centre(t));
    if (own_height*there > 0) return FaceOnPlane::Nowhere;
    if (inside_kink) return FaceOnPlane::Here;
    double own = Volume(cell.in_space), other = Volume(t);
    bool equal = std::abs(own-other) <= 1e-8*(own+other);
    return (equal ? own_height > 0 : own > other) ? FaceOnPlane::Here : FaceOnPlane::There;
  }

  /// Whether the flat coordinates of the corners make another element than their points in space: the surface bends at the scale of the element, or the nearest points lie apart.
  bool SheetLocation :: IsBent (const SheetCell & cell) const
  { return !sheet.IsPlanar() && !sheet.GetSurface()->Represents(cell.in_space, cell.tet); }

  double SheetLocation :: HeightAt (Point3 x) const { return sheet.GetPlane().Height(sheet.Flat(x)); }

  /// Whether a corner is near to the sheet.
  bool SheetLocation :: IsNear (const SheetCell & cell) const
  {
    double h = LongestEdge(cell.in_space);
    return std::ranges::any_of(cell.tet, [&] (Point3 x)
    {
      Point p = sheet.GetPlane().Project(x);
      return std::abs(sheet.GetPlane().Height(x)) <= h && (sheet.Contains(p) || sheet.Loops()[sheet.NearestLoop(p)].Nearest(p).distance <= h);
    });
  }
}
