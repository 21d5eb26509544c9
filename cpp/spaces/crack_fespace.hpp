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

    /// The parts of the elements around a node: which of them hang together.
    struct Support
    {
      std::vector<size_t> elements, first;            // first[i]: the number of the first part of the i-th element
      std::vector<size_t> component;                  // of each part
      std::vector<double> sizes;                      // of the components
      size_t base;                                    // the component on which φ_i has no copy
      /// Of an element of the support.
      std::optional<size_t> ComponentOf (PartOfElement part) const;
    };
    std::vector<Support> supports;
    /// A copy of φ_i on one component, where it is sign × φ_i.
    struct Copy { size_t support, component; int sign; size_t crack; };
    std::vector<Copy> copies;
    struct Enrichment { DofId dof; size_t copy; };
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
    /// The number of φ_i, and s_i, of the j-th Heaviside function: the side of the largest component as its own one sees it.
    std::pair<DofId, int> Heaviside (size_t j) const { return { At(j).dof, -CopyOf(j).sign }; }
    /// The crack beside its component.
    size_t HeavisideCrack (size_t j) const { return CopyOf(j).crack; }
    /// The factors of φ_i on the parts of an element in the support. Throws for another element.
    std::vector<signed char> HeavisideFactors (size_t j, size_t element) const;
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
    void EnrichNode (ngcomp::NodeId node);
    Array<int> ElementsOf (ngcomp::NodeId node) const;
    template <typename F>
    void VisitNeighbours (const Support & support, F && visit) const;
    Support SupportOf (ngcomp::NodeId node) const;
    void CheckHinge (ngcomp::NodeId node, const Support & support) const;
    /// Lengths of Γ_C between two components: on the plus and on the minus side of a crack.
    struct Border { size_t plus, minus, crack; double length; };
    std::vector<Border> BordersOf (const Support & support) const;
    size_t BaseOf (ngcomp::NodeId node, const Support & support, const std::vector<Border> & borders) const;
    std::vector<std::array<double,2>> HeldLengths (ngcomp::NodeId node, const Support & support) const;
    Copy CopyOn (size_t component, const Support & support, const std::vector<Border> & borders) const;
    const Enrichment & At (size_t j) const;
    const Copy & CopyOf (size_t j) const { return copies[At(j).copy]; }
    std::vector<signed char> Factors (const Copy & copy, ElementId ei) const;
    signed char Factor (const Copy & copy, PartOfElement part) const;
    std::vector<PartOfElement> PartsBeside (size_t bnd_element) const;
    void CollectHeaviside (VorB vb);
    void CollectTips ();
    void AddTip (ElementId ei, size_t tip);
    void AddToInterfaces (size_t tip);
    int TipSetOf (const std::vector<size_t> & tips);
    const HeavisideFunctions & HeavisideOf (ElementId ei) const
    { return heaviside[ei.VB()][heaviside_of[ei.VB()][ei.Nr()]]; }
    const TipSet & TipsOf (ElementId ei) const
    { return tip_sets[ei.VB() <= BND ? tips_of[ei.VB()][ei.Nr()] : 0]; }
  };
}
