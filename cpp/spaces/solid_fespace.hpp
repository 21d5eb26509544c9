#pragma once
// V_h of a body in space: P_k, copies, and at the nodes around fronts the vector modes times hats (docs/method.md, section 15).

#include "rules/solid_rules.hpp"
#include "spaces/enriched_space.hpp"

namespace ngsxfem_contact
{
  /// The modes of all fronts. material: of each front; the rules are those that the modes ask for, with the modes also at nodes nearer than their radius.
  struct FrontSpec { std::vector<ModeMaterial> material; FrontDemand rules; };

  class SolidFESpace final : public EnrichedSpace<3>
  {
    shared_ptr<const CrackedSolid> body;
    std::vector<FrontFunctions> modes;                // by front; empty: there are none
    FrontDemand demand;
    shared_ptr<const SolidRules> rules;
    struct FrontNode { size_t vertex, front; std::optional<int> along; };   // along: the axis in which the front leaves through a boundary where that component is held
    std::vector<FrontNode> nodes;                     // those with modes
    size_t num_left_out = 0;
    struct ModesIn { std::vector<NodeWithModes> nodes; std::vector<DofId> dofs; };
    // by element, VOL and BND; 0: none
    Array<int> modes_of[2];
    std::vector<ModesIn> modes_in[2];
    std::deque<FlatMap> flat_maps[2];                 // of curved sheets

  public:
    /// Throws unless there is a material for each front.
    SolidFESpace (shared_ptr<const CrackedSolid> abody, std::optional<FrontSpec> spec, const Flags & flags);

    string GetClassName () const override { return "SolidFESpace"; }
    shared_ptr<const CrackedSolid> GetBody () const { return body; }
    std::optional<FrontSpec> Spec () const;
    /// Gives the modes of a front another material: unknowns and rules stay what they are.
    void SetFrontMaterial (size_t front, ModeMaterial material);
    const SolidRules & Rules () const override { return *rules; }

    size_t NumFrontNodes () const { return nodes.size(); }
    /// Nodes around fronts without modes: beside corners, where two fronts are near, and where some components of u are held and others are not, but for planes that a front
    /// is normal to: there modes I and II have no component along the normal, and mode III is held with it.
    size_t NumLeftOut () const { return num_left_out; }
    /// The vertex of the j-th node with modes, and the front.
    std::pair<size_t, size_t> FrontNodeAt (size_t j) const { return { nodes.at(j).vertex, nodes.at(j).front }; }
    DofId FrontDof (size_t j, int mode) const { return FirstSingularDof() + FrontFunctions::size*j + mode; }

  private:
    size_t CollectSingular () override;
    FlatArray<DofId> SingularDofs (ElementId ei) const override { return View(ModesOf(ei).dofs); }
    SingularFunctions<3> SingularOf (ElementId ei) const override { return SingularFunctions<3>(View(ModesOf(ei).nodes)); }
    void FindNodes ();
    /// Of the vertices on boundaries where some components are held and others are not that component and the axis of the normal if they are one, else -1.
    std::map<size_t, int> PartlyHeldVertices () const;
    bool HasOnly (DofId dof, int component) const override;
    size_t NearestFront (size_t sheet, Point3 x) const;
    bool IsAlone (FrontNode node) const;
    bool LeavesAlong (FrontNode node) const;
    void AddModes (VorB vb);
    const ModesIn & ModesOf (ElementId ei) const
    { return ei.VB() <= BND ? modes_in[ei.VB()][modes_of[ei.VB()][ei.Nr()]] : modes_in[VOL][0]; }
  };
}
