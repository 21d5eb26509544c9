#pragma once
// V_h but for what is singular: P_k for each component, and copies where cracks divide supports (docs/method.md, section 3).

#include "cut/facets.hpp"
#include "cut/forest.hpp"
#include "spaces/diffops.hpp"

namespace ngsxfem_contact
{
  using ngcore::Array, ngcore::Flags, ngcomp::DofId, ngcomp::ElementId;

  template <typename T>
  FlatArray<T> View (const std::vector<T> & v) { return FlatArray<T>(v.size(), const_cast<T*>(v.data())); }

  /// For each component of u the name of the flag that holds it: dirichletx, dirichlety, dirichletz.
  string HeldFlag (int component);

  /// Dofs: φ_i for x, φ_i for the other components, ½(H - s_i) φ_i for x, the same for the others, what derived classes add.
  template <int D>
  class EnrichedSpace : public ngcomp::FESpace, public AsksForRules
  {
    shared_ptr<const CutGeometry<D>> geometry;
    std::array<ngcore::BitArray,D> held;              // by component: the boundary regions on which it is fixed
    shared_ptr<ngcomp::FESpace> scalar;               // P_k

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
    // by element, VOL and BND; 0: none
    Array<int> heaviside_of[2];
    std::vector<HeavisideFunctions> heaviside[2];

  public:
    EnrichedSpace (shared_ptr<const CutGeometry<D>> ageometry, const Flags & flags);

    const CutGeometry<D> & Geometry () const { return *geometry; }
    shared_ptr<ngcomp::FESpace> GetScalar () const { return scalar; }
    /// The boundary regions of dirichlet, and of dirichletx (component 0), dirichlety (1), ...
    const ngcore::BitArray & HeldRegions (int component) const;

    void Update () override;
    void FinalizeUpdate () override;
    void UpdateCouplingDofArray () override;
    void UpdateFreeDofs () override;
    FiniteElement & GetFE (ElementId ei, ngcore::Allocator & alloc) const override;
    void GetDofNrs (ElementId ei, Array<DofId> & dnums) const override;
    void GetDofNrs (ngcomp::NodeId ni, Array<DofId> & dnums) const override;

    size_t NumScalar () const { return scalar->GetNDof(); }
    size_t NumHeaviside () const { return enrichment.size(); }
    DofId HeavisideDof (size_t j, int component) const;
    /// The number of φ_i, and s_i, of the j-th Heaviside function: the side of the largest component as its own one sees it.
    std::pair<DofId, int> Heaviside (size_t j) const { return { At(j).dof, -CopyOf(j).sign }; }
    /// The crack beside its component.
    size_t HeavisideCrack (size_t j) const { return CopyOf(j).crack; }
    /// The factors of φ_i on the parts of an element in the support. Throws for another element.
    std::vector<signed char> HeavisideFactors (size_t j, size_t element) const;
    /// For each boundary region the functions of each component with a trace on it, sorted; singular ones belong to all components, where all are held.
    std::vector<std::array<std::vector<DofId>,D>> BoundaryDofs () const;
    /// The functions of one component of an element: φ_i, then NumScalar() + j for the j-th Heaviside function.
    void GetComponent (ElementId ei, Array<DofId> & functions) const;
    /// All dofs from here on belong to singular functions.
    DofId FirstSingularDof () const { return D*(NumScalar()+NumHeaviside()); }

  protected:
    /// Finds which singular functions there are, and on which elements; returns their number.
    virtual size_t CollectSingular () = 0;
    virtual FlatArray<DofId> SingularDofs (ElementId ei) const = 0;
    virtual SingularFunctions<D> SingularOf (ElementId ei) const = 0;
    /// Whether a singular function has only this component on a boundary where it alone is held.
    virtual bool HasOnly (DofId dof, int component) const { return false; }
    /// Whether one of the components is fixed on a boundary region.
    bool IsHeld (int region) const { return std::ranges::any_of(held, [&] (auto & regions) { return regions[region]; }); }
    bool IsWhollyHeld (int region) const { return std::ranges::all_of(held, [&] (auto & regions) { return regions[region]; }); }

  private:
    void FindEnrichment ();
    void EnrichNode (ngcomp::NodeId node);
    Array<int> ElementsOf (ngcomp::NodeId node) const;
    template <typename F>
    void VisitNeighbours (const Support & support, F && visit) const;
    Support SupportOf (ngcomp::NodeId node) const;
    void CheckHinge (ngcomp::NodeId node, const Support & support) const;
    /// Sizes of Γ_C between two components: on the plus and on the minus side of a crack.
    struct Border { size_t plus, minus, crack; double size; };
    std::vector<Border> BordersOf (const Support & support) const;
    size_t BaseOf (ngcomp::NodeId node, const Support & support, const std::vector<Border> & borders) const;
    using HeldSizes = std::vector<std::array<double,D>>;
    HeldSizes HeldSizesOf (ngcomp::NodeId node, const Support & support) const;
    void CheckHeld (ngcomp::NodeId node, const HeldSizes & sizes) const;
    Copy CopyOn (size_t component, const Support & support, const std::vector<Border> & borders) const;
    const Enrichment & At (size_t j) const;
    const Copy & CopyOf (size_t j) const { return copies[At(j).copy]; }
    std::vector<signed char> Factors (const Copy & copy, ElementId ei) const;
    signed char Factor (const Copy & copy, PartOfElement part) const;
    std::vector<PartOfElement> PartsBeside (size_t bnd_element) const;
    void CollectHeaviside (VorB vb);
    const HeavisideFunctions & HeavisideOf (ElementId ei) const
    { return heaviside[ei.VB()][heaviside_of[ei.VB()][ei.Nr()]]; }
  };
}
