#pragma once
// V_h: the cut-off XFEM space (docs/method.md, section 3), one vector-valued space.

#include "spaces/dilatation.hpp"

namespace ngsxfem_contact
{
  using ngcore::Array, ngcore::Flags, ngcomp::DofId;

  class CrackFESpace : public ngcomp::FESpace, public AsksForRules
  {
    shared_ptr<const CrackedMesh> body;
    double tolerance;                                 // of the rules around the tips
    std::array<ngcore::BitArray,2> held;              // by component: the boundary regions on which it is fixed
    shared_ptr<ngcomp::FESpace> scalar;               // P_k
    std::vector<std::optional<TipFunctions>> tips;    // by tip of the body
    shared_ptr<const BodyRules> standard_rules;       // those of measures without a function, kept as long as the space
    shared_ptr<const BodyRules> rules;                // for these functions
    std::vector<size_t> first_tip_dof;

    struct Support
    {
      size_t crack;
      int shift;                                      // s_i
      std::map<size_t, int> sides;                    // of its elements; 0: the crack divides it or runs along it
    };
    std::vector<Support> supports;
    struct Enrichment { DofId dof; size_t support; };
    std::vector<Enrichment> enrichment;               // N_H
    struct HeavisideFunctions
    {
      std::vector<HeavisideFunction> functions;
      std::vector<size_t> global;                     // positions in enrichment
    };
    struct TipSet                                     // tips whose disks meet an element
    {
      std::vector<size_t> tips;
      std::vector<const TipFunctions*> functions;
      std::vector<DofId> dofs;
    };
    // by element, VOL and BND; 0: none
    Array<int> heaviside_of[2], tips_of[2];
    std::vector<HeavisideFunctions> heaviside[2];
    std::vector<TipSet> tip_sets;

  public:
    /// tips: one entry for each tip of the body, empty where there shall be no singular functions, or none at all.
    /// Throws for a disk r1 that does not fit its tip's clearance.
    CrackFESpace (shared_ptr<const CrackedMesh> abody, std::vector<std::optional<TipSpec>> atips, double atolerance, const Flags & flags);

    string GetClassName () const override { return "CrackFESpace"; }
    shared_ptr<const CrackedMesh> GetBody() const { return body; }
    shared_ptr<ngcomp::FESpace> GetScalar() const { return scalar; }
    std::vector<std::optional<TipSpec>> TipSpecs() const;
    /// Gives the modes at a tip another material: unknowns and rules stay what they are.
    void SetTipMaterial (size_t tip, double kappa, double mu);
    double Tolerance() const { return tolerance; }
    /// The boundary regions of dirichlet, and of dirichletx (component 0) or dirichlety (1).
    const ngcore::BitArray & HeldRegions (int component) const;
    const BodyRules & Rules () const override { return *rules; }

    void Update () override;
    void FinalizeUpdate () override;
    void UpdateCouplingDofArray () override;
    void UpdateFreeDofs () override;
    FiniteElement & GetFE (ElementId ei, ngcore::Allocator & alloc) const override;
    void GetDofNrs (ElementId ei, Array<DofId> & dnums) const override;
    void GetDofNrs (ngcomp::NodeId ni, Array<DofId> & dnums) const override;

    /// Dofs: φ_i for x, φ_i for y, ½(H - s_i) φ_i for x, the same for y, the tips.
    size_t NumScalar () const { return scalar->GetNDof(); }
    size_t NumHeaviside () const { return enrichment.size(); }
    DofId HeavisideDof (size_t j, int component) const;
    /// The number of φ_i, and s_i, of the j-th Heaviside function.
    std::pair<DofId, int> Heaviside (size_t j) const { return { At(j).dof, SupportOf(j).shift }; }
    size_t HeavisideCrack (size_t j) const { return SupportOf(j).crack; }
    /// Of an element in the support: +1, -1, or 0 if the crack divides it or runs along it.
    int HeavisideSide (size_t j, size_t element) const;
    std::vector<DofId> TipDofs (size_t tip) const;
    /// For each boundary region the functions of either component with a trace on it, sorted. Those of tips vanish there.
    std::vector<std::array<std::vector<DofId>,2>> BoundaryDofs () const;
    size_t NumTipDofs (size_t tip) const { return tips.at(tip) ? tips[tip]->Size() : 0; }
    /// The functions of one component of an element: φ_i, then NumScalar() + j for the j-th Heaviside function.
    void GetComponent (ElementId ei, Array<DofId> & functions) const;
    /// The tips whose functions an element has.
    const std::vector<size_t> & TipsAt (size_t element) const { return tip_sets[tips_of[VOL][element]].tips; }
    /// All dofs from here on belong to tips.
    DofId FirstTipDof () const { return 2*(NumScalar()+NumHeaviside()); }

  private:
    const CutGeometry<2> & Geometry () const { return *body; }
    void SetTips (const std::vector<std::optional<TipSpec>> & specs);
    void FindEnrichment ();
    void EnrichNode (ngcomp::NodeId node, size_t crack);
    Array<int> ElementsOf (ngcomp::NodeId node) const;
    const ElementCrack * MetBy (size_t crack, size_t element) const;
    bool IsCrossed (ngcomp::NodeId node, FlatArray<int> support, size_t crack) const;
    std::map<size_t, int> SupportSides (ngcomp::NodeId node, FlatArray<int> support, size_t crack) const;
    Measures SupportAreas (const std::map<size_t, int> & sides, size_t crack) const;
    const Enrichment & At (size_t j) const;
    const Support & SupportOf (size_t j) const { return supports[At(j).support]; }
    void CollectHeaviside (VorB vb);
    void CollectTips ();
    void AddTip (ElementId ei, size_t tip);
    void AddToInterfaces (size_t tip);
    int TipSetOf (const std::vector<size_t> & tips);
    const HeavisideFunctions & HeavisideOf (ElementId ei) const
    { return heaviside[ei.VB()][heaviside_of[ei.VB()][ei.Nr()]]; }
    const TipSet & TipsOf (ElementId ei) const
    { return tip_sets[ei.VB() <= BND ? tips_of[ei.VB()][ei.Nr()] : 0]; }
    int SideOfBoundaryElement (size_t element, const Support & support) const;
    std::array<Measures,2> HeldLengths (ngcomp::NodeId node, const Support & support) const;
    int SideOfFixedBoundary (ngcomp::NodeId node, const Support & support) const;
  };
}
