#pragma once
// W_h: the multipliers on Γ_C (docs/method.md, section 4), P_j on the intervals between nodes of the crack, or restrictions
// of mesh functions.

#include "forms/cut_integral.hpp"
#include "spaces/curve_nodes.hpp"
#include "spaces/trace_operator.hpp"

namespace ngsxfem_contact
{
  using ngcore::Array, ngcore::Flags, ngcomp::DofId, ngfem::FiniteElement;

  /// The arc lengths at which a crack meets mesh edges, and of its ends; for order ≥ 1 those of its kinks, too.
  std::vector<double> MeshNodes (const CrackedMesh & body, size_t crack, bool kinks);

  /// A part of a crack between two places at which it meets others, or ends: its first interval, and the one behind its last.
  struct Arm { size_t crack, lo, hi; };

  /// The functions of W_h and where they live. No function lives on two arms.
  class TraceBasis
  {
  protected:
    shared_ptr<CrackedMesh> body;
    int order;
    shared_ptr<const ArcLengths> division;
    std::vector<Arm> arms;
    Array<double> lobatto, weights;       // the rule on [0,1] whose points are those of the Lagrange functions; order ≥ 1
  public:
    /// adivision: where intervals of the cracks end, arc lengths from 0 to the length of each; they also end where cracks meet, and of order 0 in
    /// the middle of an arm with one interval.
    /// Throws for others, and for an order below 0.
    TraceBasis (shared_ptr<CrackedMesh> abody, int aorder, std::vector<std::vector<double>> adivision);
    virtual ~TraceBasis () = default;
    virtual size_t NDof () const = 0;
    virtual void GetDofNrs (size_t element, Array<DofId> & dnums) const = 0;
    virtual FiniteElement & GetFE (size_t element, ngcore::Allocator & alloc) const = 0;
    shared_ptr<const ArcLengths> Division () const { return division; }
    /// The points of the Lagrange functions of this order on the intervals, and their integrals; of order 0 the middles of the intervals.
    CurveNodes Nodes () const;
    auto Arguments () const { return std::tuple(body, order, division->All()); }

  protected:
    /// Consecutive intervals of an arm that meet an element.
    struct Span { size_t arm, lo, hi; };
    std::map<size_t, std::vector<Span>> spans;          // by element
    /// The functions of an element: what `make` gives for each of some spans.
    template <typename F>
    FiniteElement & MakeElement (size_t element, const std::vector<Span> & spans, ngcore::Allocator & alloc, F && make) const;

  private:
    void CheckDivision (const std::vector<std::vector<double>> & adivision) const;
    void FindSpans ();
    void EndAtMeetings (size_t crack, std::vector<double> & s);
    void AddArm (size_t crack, size_t lo, size_t & hi, std::vector<double> & s);
  };

  /// Lagrange functions: order 0 one constant for each interval, order j ≥ 1 continuous, at Gauss-Lobatto points.
  class NodalTraceBasis : public TraceBasis
  {
    std::vector<size_t> first;            // dof of each arm
  public:
    NodalTraceBasis (shared_ptr<CrackedMesh> abody, int aorder, std::vector<std::vector<double>> adivision);
    size_t NDof () const override { return first.back(); }
    void GetDofNrs (size_t element, Array<DofId> & dnums) const override;
    FiniteElement & GetFE (size_t element, ngcore::Allocator & alloc) const override;
  };

  /// Restrictions to each arm of the P_j functions of the mesh, j ≥ 1; linearly dependent unless some are left out.
  class MeshTraceBasis : public TraceBasis
  {
    std::set<size_t> left_out;
    shared_ptr<ngcomp::FESpace> scalar;
    std::vector<std::vector<int>> number; // on each arm of each mesh function; -1: not used
    size_t ndof = 0;
    std::vector<Span> ArmsIn (size_t element) const;
  public:
    /// left_out: in the numbering of a basis with nothing left out.
    MeshTraceBasis (shared_ptr<CrackedMesh> abody, int aorder, std::vector<std::vector<double>> adivision, std::set<size_t> aleft_out);
    size_t NDof () const override { return ndof; }
    void GetDofNrs (size_t element, Array<DofId> & dnums) const override;
    FiniteElement & GetFE (size_t element, ngcore::Allocator & alloc) const override;
    const std::set<size_t> & LeftOut () const { return left_out; }
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
