#pragma once
// W_h of order 1 on sheets in space (docs/method.md, section 15): hats of the points in which a sheet cuts edges of the mesh, linear on triangles of the
// polygons in the elements that carry S. Where a front is inside, corners beyond it have the value of the nearest corner on S; without such a corner
// there is one constant.

#include "cut/cracked_solid.hpp"
#include "forms/cut_integral.hpp"
#include "spaces/trace_operator.hpp"

namespace ngsxfem_contact
{
  using ngcore::Array, ngcomp::DofId;

  /// Of the nodes of a LinearSheetTraceSpace: numbers of sheets, points, and pairs that a side of a polygon joins, each once.
  struct LinearSheetNodes
  {
    std::vector<size_t> sheets;
    std::vector<Point3> positions;
    std::vector<std::array<size_t,2>> neighbours;
  };

  class LinearSheetTraceSpace : public ngcomp::FESpace
  {
    shared_ptr<CrackedSolid> body;
    LinearSheetNodes nodes;
    struct Corners { std::vector<DofId> dofs; std::vector<int> local; };   // dofs of an element, each once; of each corner which of them
    std::map<size_t, Corners> corners;                                    // by element

  public:
    /// Nodes between which a side of a polygon is shorter than 1e-6 of its element are one: no displacement tells the signs of two apart.
    explicit LinearSheetTraceSpace (shared_ptr<CrackedSolid> abody);
    string GetClassName () const override { return "LinearSheetTraceSpace"; }
    shared_ptr<CrackedSolid> GetBody () const { return body; }
    const LinearSheetNodes & Nodes () const { return nodes; }
    void Update () override;
    ngfem::FiniteElement & GetFE (ngfem::ElementId ei, ngcore::Allocator & alloc) const override;
    void GetDofNrs (ngfem::ElementId ei, Array<DofId> & dnums) const override;
  };
}
