#pragma once
// The triangles that the parts of an element are made of.

#include "cut/polygon.hpp"
#include "curve/crack.hpp"
#include <optional>

namespace ngsxfem_contact
{
  /// A part of T∩Γ_C on one piece of a crack, from arc length s0 to s1.
  struct Chord { size_t piece; double s0, s1; };

  /// A triangle inside a part. With a curved side it is the cone over this stretch of a curve, seen from corner 0; the curve ends in corners 1 and 2.
  struct PartTriangle
  {
    struct CurvedSide { const Crack * curve; Chord chord; };
    Triangle triangle;
    size_t part;
    std::optional<CurvedSide> curved;
  };

  /// Exact areas. Of a curved side ½∫|(x-A)×dx| along the curve.
  double Area (const PartTriangle & t);
}
