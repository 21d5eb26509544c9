#pragma once
// A mesh of tetrahedra with sheets: where they lie, which elements they meet, and their fronts.

#include "cut/flat_map.hpp"
#include "cut/mesh_state.hpp"
#include "cut/tet_location.hpp"
#include <deque>

namespace ngsxfem_contact
{
  /// An element that a sheet meets: two parts, plus (0) and minus (1), where it is cut; one where a front is inside, or where the sheet runs along a face.
  /// A curved sheet is plane in it, by its flat coordinates in the corners.
  class CutTet final : public ElementCracks<3>
  {
    const SheetCell & cell;
    std::array<double,4> heights;                 // in NGSolve's order of the corners
    std::vector<PartTriangle> facet;              // of S, in its plane
    double area = 0, stretch = 1;                 // stretch: of heights, in flat coordinates over those in space
    std::optional<Frame<3>> frame;                // nullopt: that of the sheet
    CrackSides sides;

  public:
    /// loops: of the sheet with a number.
    CutTet (const MeshAccess & mesh, const SheetCell & acell, const Sheet & sheet, size_t number);

    size_t PartAt (const ngfem::IntegrationPoint & ip) const override { return IsDivided() && HeightAt(ip) < 0 ? 1 : 0; }
    CrackSides SidesAt (Point3) const override { return sides; }
    bool HasOneFacet () const override { return true; }
    void VisitFacets (const std::function<void(const CrackSides &, double)> & visit) const override { visit(sides, area); }

    const SheetCell & Cell () const { return cell; }
    const CrackSides & Sides () const { return sides; }
    bool IsDivided () const { return cell.kind == ElementKind::Cut; }
    /// The triangles that S in this element is made of.
    const std::vector<PartTriangle> & Facet () const { return facet; }
    double FacetArea () const { return area; }
    /// |∇(flat height)|: area × this in space is the volume of a prism in flat coordinates over its one in space.
    double Stretch () const { return stretch; }
    const std::optional<Frame<3>> & OwnFrame () const { return frame; }
    /// Whether a side, ±1, is the larger one, of a Tip that of the plane.
    bool IsLarger (int side) const { return cell.kind == ElementKind::Aligned || side == sides.larger_side; }

  private:
    double HeightAt (const ngfem::IntegrationPoint & ip) const;
  };

  /// A boundary triangle that S divides: plus (0) and minus (1). heights: of its corners in NGSolve's order.
  class DividedTriangle final : public BoundaryParts
  {
  public:
    std::array<double,3> heights;
    size_t crack;
    size_t PartAt (const ngfem::IntegrationPoint & ip) const override
    { return ip(0)*heights[0] + ip(1)*heights[1] + (1-ip(0)-ip(1))*heights[2] >= 0 ? 0 : 1; }
  };

  /// The CutGeometry of space: says where things are, and never changes.
  class CrackedSolid final : public CutGeometry<3>
  {
    shared_ptr<MeshAccess> mesh;
    MeshState located_in;
    std::vector<Sheet> sheets;
    std::deque<SheetLocation> locations;
    std::vector<Front> fronts;
    std::map<size_t, CutTet> cut_tets;
    std::map<size_t, DividedTriangle> boundary_parts;
    std::vector<std::map<size_t, double>> front_nodes;

  public:
    /// Throws for a mesh that is not straight tetrahedra, for what SheetLocation refuses, and for two sheets in one element.
    CrackedSolid (shared_ptr<MeshAccess> amesh, std::vector<Sheet> asheets);

    shared_ptr<MeshAccess> GetMesh () const override { return mesh; }
    void CheckMesh () const override { located_in.Check(*mesh); }
    size_t NumCracks () const override { return sheets.size(); }
    Frame<3> FrameAt (size_t sheet, const ElementCracks<3> * element, Point3 x) const override;
    size_t CrackAt (const ElementCracks<3> * element, Point3 x) const override;
    const CutTet * Find (size_t element) const override { return FindIn(cut_tets, element); }
    std::vector<size_t> CrackedElements () const override { return ElementsOf(cut_tets); }
    const DividedTriangle * FindBoundary (size_t bnd_element) const override { return FindIn(boundary_parts, bnd_element); }
    std::vector<std::array<size_t,2>> Links (size_t face) const override;

    const std::vector<Sheet> & Sheets () const { return sheets; }
    /// The corners of an element, or of a boundary element, in the flat coordinates of a sheet, in NGSolve's order.
    /// Throws where these make another element: where a curved sheet is far away, or bends too sharply.
    /// An element that a kink of the sheet passes has some, but none for modes.
    Tet FlatTet (size_t sheet, size_t element, bool for_modes = false) const;
    std::array<Point3,3> FlatTriangle (size_t sheet, size_t bnd_element) const;
    const std::vector<Front> & Fronts () const { return fronts; }
    /// Throws for a number that is not below NumCracks().
    const SheetLocation & Location (size_t sheet) const { return locations[Checked(sheet)]; }
    /// The vertices of the elements whose closure holds a stretch of a front of a sheet, each with the longest edge of these elements at it.
    const std::map<size_t, double> & FrontNodes (size_t sheet) const { return front_nodes[Checked(sheet)]; }
    const std::map<size_t, CutTet> & CutTets () const { return cut_tets; }
    const std::map<size_t, DividedTriangle> & DividedBoundary () const { return boundary_parts; }

  private:
    void CheckTetrahedra () const;
    void CheckApart () const;
    void DivideBoundary ();
    void FindFrontNodes ();
  };
}
