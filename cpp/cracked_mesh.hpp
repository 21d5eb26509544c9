#pragma once
// A mesh with its cracks: where they lie, their tips, and the integration rules of its measures.

#include "curved_rule.hpp"
#include "cut_element.hpp"
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>

namespace ngsxfem_contact
{
  using ngfem::ElementId, ngfem::VorB, ngfem::VOL, ngfem::BND;

  /// What a measure integrates over: Ω∖Γ_C (and ∂Ω), the larger part of each element that a crack divides, or Γ_C.
  enum class Domain { Bulk, Larger, Crack };

  /// Arc lengths of points on each crack.
  using CrackNodes = std::vector<std::vector<double>>;

  /// Which rules an integral needs. nodes: where those on Γ_C are divided, beside the mesh edges and kinks. crack: on Γ_C and
  /// on the larger parts of one crack only.
  struct RuleKind
  {
    Domain domain = Domain::Bulk;
    CrackNodes nodes;
    std::optional<size_t> crack;
    auto operator<=> (const RuleKind &) const = default;
  };

  struct Tip
  {
    size_t crack;
    double s;                    // its arc length: 0 or the crack's length
    TipCurve curve;
    Point point, ahead;          // ahead: the direction in which the crack would grow
    int plus_sign;               // the sign of θ on the plus side, θ = 0 ahead
    double clearance;            // to ∂Ω, other cracks, the next kink, half the way to other tips, half of the radius of curvature
    std::string limit;           // what sets the clearance
  };

  /// A rule in reference coordinates: weights times the element's measure give physical lengths and areas.
  struct ElementRule
  {
    ngfem::IntegrationRule ir;
    ngfem::SIMD_IntegrationRule simd_ir;
    ElementRule (ngfem::IntegrationRule && air) : ir(std::move(air)), simd_ir(ir) { }
  };

  /// The elements for which the standard rule is not right, and theirs.
  class RuleTable
  {
    std::vector<int> index;      // by element number; -1: the standard rule
    std::vector<std::unique_ptr<ElementRule>> rules;
    std::map<int, int> gauss;    // the one rule of an order, shared by its elements
  public:
    RuleTable (size_t n) : index(n, -1) { }
    void Add (size_t element, std::unique_ptr<ElementRule> rule)
    { index[element] = int(rules.size()); rules.push_back(std::move(rule)); }
    /// The standard rule of another order.
    void AddGauss (size_t element, int order);
    const ElementRule * Find (size_t element) const
    { return index[element] < 0 ? nullptr : rules[index[element]].get(); }
  };

  class CrackedMesh
  {
    shared_ptr<MeshAccess> mesh;
    size_t num_elements;         // when the cracks were located
    std::vector<Crack> cracks;
    std::vector<CrackLocation> locations;
    std::vector<Tip> tips;
    std::vector<std::optional<TipQuadrature>> tip_quadrature;    // set by the spaces that have functions there
    std::map<size_t, CutElement> cut_elements;

    mutable std::map<std::tuple<RuleKind, VorB, int>, shared_ptr<const RuleTable>> rule_tables;
    mutable std::mutex rule_mutex;
    std::atomic<size_t> rule_version = 0;

  public:
    /// Throws for what Crack, CrackLocation and CutElement refuse, and for cracks that meet.
    CrackedMesh (shared_ptr<MeshAccess> amesh, std::vector<Crack> acracks);

    shared_ptr<MeshAccess> GetMesh() const { return mesh; }
    /// Throws if the mesh was refined after the cracks were located in it.
    void CheckMesh () const;
    size_t NumCracks() const { return cracks.size(); }
    /// These throw for a number that is not below NumCracks().
    const Crack & GetCrack (size_t i) const { return cracks[Checked(i)]; }
    const CrackLocation & Location (size_t i) const { return locations[Checked(i)]; }
    const std::vector<Crack> & Cracks() const { return cracks; }
    const std::vector<Tip> & Tips() const { return tips; }

    /// An element that a crack crosses, ends in, or runs along; nullptr elsewhere.
    const CutElement * Find (size_t element) const;
    /// Elements that carry a part of Γ_C (of one crack, or of all of them).
    shared_ptr<ngcore::BitArray> CrackElements (std::optional<size_t> crack = std::nullopt) const;

    /// Asks for rules that integrate singular functions at a tip; rules that were made before are made again.
    void RequireTipQuadrature (size_t tip, std::set<double> breaks, int smoothness, double tolerance);

    /// The table for rules of the given order.
    shared_ptr<const RuleTable> Rules (const RuleKind & kind, VorB vb, int order) const;
    /// Changes when rules that were made before are no longer right.
    size_t RuleVersion () const { return rule_version; }

  private:
    size_t Checked (size_t crack) const;
    void CheckDistinct () const;
    void FindCutElements ();
    void FindTips ();
    void SetClearance (Tip & tip) const;
    void LimitByCracks (const Tip & tip, const std::function<void(double, std::string)> & limit) const;
    std::vector<const TipQuadrature*> TipsNear (const Triangle & t) const;
    void AppendPart (const Triangle & part, int order, PointRule & rule) const;
    void AppendCurvedPart (const Piece & piece, const Crack & crack, int order, PointRule & rule, int depth = 3) const;
    void AppendPiece (const ElementPart & part, int order, PointRule & rule) const;
    std::unique_ptr<ElementRule> MakeRule (const PointRule & points, const Triangle & t) const;
    std::unique_ptr<ElementRule> MakeVolumeRule (const RuleKind & kind, size_t element, int order) const;
    void AppendCrack (const ElementLocation & location, const Crack & crack, int order, const std::vector<double> & nodes, PointRule & rule) const;
    std::unique_ptr<ElementRule> MakeBoundaryRule (const std::vector<CutBoundaryEdge> & crossings, int order) const;
    shared_ptr<RuleTable> MakeVolumeTable (const RuleKind & kind, int order) const;
    shared_ptr<RuleTable> MakeCrackTable (const RuleKind & kind, int order) const;
    shared_ptr<RuleTable> MakeBoundaryTable (int order) const;
  };
}
