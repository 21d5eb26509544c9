#pragma once
// W_h: the multipliers on Γ_C (docs/method.md, section 4), P_j on the intervals between nodes of the crack, or restrictions
// of mesh functions.

#include "forms/cut_integral.hpp"

namespace ngsxfem_contact
{
  using ngcore::Array, ngcore::Flags, ngcomp::DofId, ngfem::FiniteElement;

  /// The arc lengths at which a crack meets mesh edges, and of its ends; for order ≥ 1 those of its kinks, too.
  std::vector<double> MeshNodes (const CrackedMesh & body, size_t crack, bool kinks);

  /// A function on T∩Γ_C. Shapes depend on the physical point only.
  class TraceElement : public FiniteElement
  {
  public:
    using FiniteElement::FiniteElement;
    ngfem::ELEMENT_TYPE ElementType() const override { return ngfem::ET_TRIG; }
    virtual void CalcShape (const ngfem::IntegrationPoint & ip, Point x, ngbla::BareSliceVector<> shape) const = 0;
  };

  /// The functions of W_h and where they live.
  class TraceBasis
  {
  public:
    virtual ~TraceBasis () = default;
    virtual size_t NDof () const = 0;
    virtual void GetDofNrs (size_t element, Array<DofId> & dnums) const = 0;
    virtual FiniteElement & GetFE (size_t element, ngcore::Allocator & alloc) const = 0;
    /// Where nodal signs are taken, for each crack.
    virtual const CrackNodes & Nodes () const = 0;
  };

  /// Lagrange functions: order 0 one constant for each interval, order j ≥ 1 continuous, at Gauss-Lobatto points.
  class NodalTraceBasis : public TraceBasis
  {
    shared_ptr<CrackedMesh> body;
    int order;
    CrackNodes nodes;
    std::vector<double> lobatto;
    std::vector<size_t> first;            // dof of each crack
  public:
    NodalTraceBasis (shared_ptr<CrackedMesh> abody, int aorder, CrackNodes anodes);
    size_t NDof () const override { return first.back(); }
    void GetDofNrs (size_t element, Array<DofId> & dnums) const override;
    FiniteElement & GetFE (size_t element, ngcore::Allocator & alloc) const override;
    const CrackNodes & Nodes () const override { return nodes; }
    /// The arc length of the point that each function of one crack belongs to.
    std::vector<double> DofPositions (size_t crack) const;
    auto Arguments () const { return std::tuple(body, order, nodes); }
  private:
    /// First and last (excluded) interval of a crack that meets the element.
    std::pair<size_t,size_t> Intervals (const ElementCrack & here) const;
  };

  /// Restrictions to each crack of the P_j functions of the mesh, j ≥ 1; linearly dependent unless some are left out.
  class MeshTraceBasis : public TraceBasis
  {
    shared_ptr<CrackedMesh> body;
    std::set<size_t> left_out;
    shared_ptr<ngcomp::FESpace> scalar;
    CrackNodes nodes;
    std::vector<std::vector<int>> number; // on each crack of each mesh function; -1: not used
    size_t ndof = 0;
  public:
    /// left_out: in the numbering of a basis with nothing left out.
    MeshTraceBasis (shared_ptr<CrackedMesh> abody, int order, CrackNodes anodes, std::set<size_t> aleft_out);
    size_t NDof () const override { return ndof; }
    void GetDofNrs (size_t element, Array<DofId> & dnums) const override;
    FiniteElement & GetFE (size_t element, ngcore::Allocator & alloc) const override;
    const CrackNodes & Nodes () const override { return nodes; }
    auto Arguments () const { return std::tuple(body, scalar->GetOrder(), nodes, left_out); }
  };

  class TraceSpace : public ngcomp::FESpace
  {
    shared_ptr<CrackedMesh> body;
    shared_ptr<TraceBasis> basis;
    shared_ptr<const BodyRules> rules;    // those of measures without a function, kept as long as the space
  public:
    TraceSpace (shared_ptr<CrackedMesh> abody, shared_ptr<TraceBasis> abasis, const Flags & flags);
    string GetClassName () const override { return "TraceSpace"; }
    shared_ptr<CrackedMesh> GetBody() const { return body; }
    shared_ptr<TraceBasis> Basis() const { return basis; }
    CutDifferentialSymbol CrackSymbol () const;
    void Update () override;
    FiniteElement & GetFE (ElementId ei, ngcore::Allocator & alloc) const override;
    void GetDofNrs (ElementId ei, Array<DofId> & dnums) const override;
  };
}
