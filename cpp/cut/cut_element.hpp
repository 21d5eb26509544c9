#pragma once
// An element that cracks meet: its parts, the sides on which they lie, and the part that R_h is taken from. Where several
// cracks meet one element, lines between them cut it apart first, and each crack divides what is left to it.

#include "cut/element_location.hpp"

namespace ngsxfem_contact
{
  struct ElementPart : Part
  {
    size_t crack;                     // to which side and curved refer
    std::vector<Side> sides;          // with respect to each crack of the element
    std::vector<bool> larger;         // for each crack: whether this belongs to the larger part beside it
  };

  struct CutElement : ElementCracks
  {
    std::vector<ElementPart> parts;

    /// Throws where no straight line separates the cracks inside the element, and for several cracks in a curved one.
    CutElement (const std::vector<Crack> & all, std::vector<ElementCrack> acracks);

    /// The crack that a point of Γ_C in this element lies on.
    const ElementCrack & CrackAt (const std::vector<Crack> & all, Point x) const;
    /// The crack that the curved side of a part is a part of: see ElementLocation.
    const Crack & CrackOf (const std::vector<Crack> & all, const ElementPart & part) const
    { return Find(part.crack)->location->CrackInTriangle(all[part.crack]); }
  };
}
