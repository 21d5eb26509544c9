#pragma once
// An element that cracks meet: its parts, the facets of Γ_C between them, and the larger part beside each facet, that R_h is taken from.

#include "cut/element_location.hpp"

namespace ngsxfem_contact
{
  /// A stretch of Γ_C in an element, on one piece of a crack.
  struct CrackFacet : CrackSides
  {
    Chord chord;
    double length;
  };

  class CutElement final : public ElementCracks<2>
  {
    const std::vector<Crack> & all;
    Triangle corners;
    ElementDivision division;
    std::vector<CrackFacet> facets;

  public:
    /// chords: those that divide the element. Throws as ElementDivision.
    CutElement (const ElementMap & map, const std::vector<Crack> & aall, const std::vector<ElementChord> & chords);

    size_t PartAt (const ngfem::IntegrationPoint & ip) const override;
    CrackSides SidesAt (Point x) const override { return FacetAt(x); }
    bool HasOneFacet () const override { return facets.size() == 1; }
    void VisitFacets (const std::function<void(const CrackSides &, double)> & visit) const override;

    const Triangle & Corners () const { return corners; }
    const std::vector<PartTriangle> & Triangles () const { return division.Triangles(); }
    const std::vector<CrackFacet> & Facets () const { return facets; }
    std::vector<ElementDivision::Interval> Along (Point a, Point b) const { return division.Along(a, b); }
    /// The crack that a point of Γ_C in this element lies on.
    const ElementCrack & CrackAt (Point x) const;
    /// Whether a part is the larger one beside a facet of a crack, of any if there is none.
    bool IsLarger (size_t part, std::optional<size_t> crack) const;
    /// The same of a triangle; beside a tip those on the larger side of the crack and of the straight line ahead of it.
    bool IsLarger (const PartTriangle & t, std::optional<size_t> crack) const;

    /// A stretch of a crack along an edge, between a part, on this side of it, and one of a neighbour.
    void AddAligned (size_t crack, const Chord & chord, size_t part, Side side, PartOfElement neighbour);

  private:
    const CrackFacet & FacetAt (Point x) const;
    void AddFacet (size_t crack, const Chord & chord, size_t plus, size_t minus, int larger_side);
    int LargerSideOf (const ElementChord & chord, size_t plus, size_t minus) const;
  };
}
