#pragma once
// V_h of the plane: the cut-off XFEM space (docs/method.md, section 3), one vector-valued space.

#include "rules/body_rules.hpp"
#include "spaces/dilatation.hpp"
#include "spaces/enriched_space.hpp"

namespace ngsxfem_contact
{
  class CrackFESpace final : public EnrichedSpace<2>
  {
    shared_ptr<const CrackedMesh> body;
    double tolerance;                                 // of the rules around the tips
    std::vector<std::optional<TipFunctions>> tips;    // by tip of the body
    shared_ptr<const BodyRules> standard_rules;       // those of measures without a function, kept as long as the space
    shared_ptr<const BodyRules> rules;                // for these functions
    std::vector<size_t> first_tip_dof;
    struct TipSet                                     // tips whose disks meet an element
    {
      std::vector<size_t> tips;
      std::vector<const TipFunctions*> functions;
      std::vector<DofId> dofs;
    };
    // by element, VOL and BND; 0: none
    Array<int> tips_of[2];
    std::vector<TipSet> tip_sets;

  public:
    /// tips: one entry for each tip of the body, empty where there shall be no singular functions, or none at all.
    /// Throws for a disk r1 that does not fit its tip's clearance.
    CrackFESpace (shared_ptr<const CrackedMesh> abody, std::vector<std::optional<TipSpec>> atips, double atolerance, const Flags & flags);

    string GetClassName () const override { return "CrackFESpace"; }
    shared_ptr<const CrackedMesh> GetBody() const { return body; }
    std::vector<std::optional<TipSpec>> TipSpecs() const;
    /// Gives the modes at a tip another material: unknowns and rules stay what they are.
    void SetTipMaterial (size_t tip, double kappa, double mu);
    double Tolerance() const { return tolerance; }
    const BodyRules & Rules () const override { return *rules; }

    void Update () override;
    std::vector<DofId> TipDofs (size_t tip) const;
    size_t NumTipDofs (size_t tip) const { return tips.at(tip) ? tips[tip]->Size() : 0; }
    /// The tips whose functions an element has.
    const std::vector<size_t> & TipsAt (size_t element) const { return tip_sets[tips_of[VOL][element]].tips; }
    /// All dofs from here on belong to tips.
    DofId FirstTipDof () const { return FirstSingularDof(); }

  private:
    size_t CollectSingular () override;
    FlatArray<DofId> SingularDofs (ElementId ei) const override;
    SingularFunctions<2> SingularOf (ElementId ei) const override;
    void SetTips (const std::vector<std::optional<TipSpec>> & specs);
    void AddTip (ElementId ei, size_t tip);
    void AddToInterfaces (size_t tip);
    int TipSetOf (const std::vector<size_t> & tips);
    const TipSet & TipsOf (ElementId ei) const
    { return tip_sets[ei.VB() <= BND ? tips_of[ei.VB()][ei.Nr()] : 0]; }
  };
}
