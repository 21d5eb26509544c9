#pragma once
// A mesh with its cracks: where they lie, their tips, and the integration rules of its measures.

#include "crack_ends.hpp"
#include "curved_rule.hpp"
#include "cut_element.hpp"
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

  /// What the functions of a space at one tip ask of the rules around it: see TipQuadrature.
  struct TipDisk
  {
    std::set<double> breaks;
    double tolerance;
    int smoothness;
    auto operator<=> (const TipDisk &) const = default;
  };

  /// By the number of the tip. Where several spaces meet in one integral, rules serve all of them.
  using TipDisks = std::map<size_t, TipDisk>;
  TipDisks Merged (TipDisks a, const TipDisks & b);

  class CrackedMesh;

  /// The rules of a body for functions that are singular in some disks: made when they are first asked for, and kept.
  class BodyRules
  {
    const CrackedMesh & body;
    TipDisks disks;
    std::vector<TipQuadrature> tips;
    mutable std::map<std::tuple<RuleKind, VorB, int>, shared_ptr<const RuleTable>> tables;
    mutable std::mutex mutex;

  public:
    BodyRules (const CrackedMesh & abody, TipDisks adisks);
    const TipDisks & Disks() const { return disks; }
    /// The table for rules of the given order.
    shared_ptr<const RuleTable> Table (const RuleKind & kind, VorB vb, int order) const;
  };

  /// What a mesh was when cracks were located in it.
  struct MeshState
  {
    size_t num_elements, num_vertices;
    int curve_order;
    bool deformed;
    explicit MeshState (MeshAccess & mesh);
    auto operator<=> (const MeshState &) const = default;
  };

  /// Nothing that is built on a body changes it.
  class CrackedMesh
  {
    shared_ptr<MeshAccess> mesh;
    MeshState located_in;
    std::vector<Crack> cracks;
    std::vector<std::string> notes;
    std::vector<CrackLocation> locations;
    std::vector<Tip> tips;
    std::map<size_t, CutElement> cut_elements;

    shared_ptr<const BodyRules> standard_rules;                            // without disks
    mutable std::map<TipDisks, std::weak_ptr<const BodyRules>> rules;      // kept by the spaces and forms that use them
    mutable std::mutex rules_mutex;

  public:
    /// The cracks are fitted to the body first: see FittedToBody.
    /// Throws for a mesh that is not plane triangles, for what FittedToBody, CrackLocation and CutElement refuse, for cracks that meet, and for a
    /// mesh with a deformation.
    CrackedMesh (shared_ptr<MeshAccess> amesh, std::vector<Crack> acracks);

    shared_ptr<MeshAccess> GetMesh() const { return mesh; }
    /// Throws if the mesh was refined, curved or deformed after the cracks were located in it.
    void CheckMesh () const;
    size_t NumCracks() const { return cracks.size(); }
    /// These throw for a number that is not below NumCracks().
    const Crack & GetCrack (size_t i) const { return cracks[Checked(i)]; }
    const CrackLocation & Location (size_t i) const { return locations[Checked(i)]; }
    const std::vector<Crack> & Cracks() const { return cracks; }
    const std::vector<Tip> & Tips() const { return tips; }
    /// What was changed at the ends of the cracks, in words.
    const std::vector<std::string> & Notes() const { return notes; }

    /// An element that a crack crosses, ends in, or runs along; nullptr elsewhere.
    const CutElement * Find (size_t element) const;
    /// Elements that carry a part of Γ_C (of one crack, or of all of them).
    shared_ptr<ngcore::BitArray> CrackElements (std::optional<size_t> crack = std::nullopt) const;

    /// For each element that cracks meet: them and its parts.
    const std::map<size_t, CutElement> & CutElements() const { return cut_elements; }

    /// The rules for functions with these disks; equal disks share theirs.
    shared_ptr<const BodyRules> Rules (const TipDisks & disks) const;

  private:
    size_t Checked (size_t crack) const;
    void CheckDistinct () const;
    void FindCutElements ();
    void FindTips (const BodyBoundary & boundary);
    void SetClearance (Tip & tip, const BodyBoundary & boundary) const;
    void LimitByCracks (const Tip & tip, const std::function<void(double, std::string)> & limit) const;
  };
}
