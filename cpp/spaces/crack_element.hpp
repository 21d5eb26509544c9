#pragma once
// The finite element of V_h on one triangle or boundary edge: φ_i, its copies, and χ F_j  (docs/method.md, section 3).
//
// Where cracks divide the support of φ_i into several connected parts, φ_i has a copy on each but the largest: ±φ_i there, 0 elsewhere. They
// span with φ_i one function for each part, vanish on the largest, and their coefficients are the jumps at the node.

#include "rules/body_rules.hpp"
#include "spaces/tip_functions.hpp"

namespace ngsxfem_contact
{
  using ngfem::FiniteElement, ngfem::BaseScalarFiniteElement;

  struct HeavisideFunction
  {
    int local;                              // which φ_i of the element
    std::vector<signed char> factors;       // of φ_i, on each part of the element and on those across its edges: see ElementParts
  };

  /// A point and its parts, each found when it is first asked for and kept for the other functions there.
  class PlacedPoint
  {
    ngfem::IntegrationPoint ip;
    Point x;
    std::optional<size_t> part;
    std::optional<CrackSides> sides;
  public:
    PlacedPoint () = default;
    PlacedPoint (double xi, double eta, Point ax) : ip(xi, eta, 0, 0), x(ax) { }
    Point Place () const { return x; }
    size_t PartOf (const ElementParts & parts)
    {
      if (!part) part = parts.PartAt(ip);
      return *part;
    }
    const CrackSides & SidesOf (const ElementCracks<2> & cut)
    {
      if (!sides) sides = cut.SidesAt(x);
      return *sides;
    }
  };

  /// Where a function that jumps is evaluated. On Γ_C a point has no side of its own.
  enum class Trace { Position, Plus, Minus, Jump, Larger };

  class CrackFiniteElement : public FiniteElement
  {
    const BaseScalarFiniteElement & scalar;
    ngcore::FlatArray<HeavisideFunction> heaviside;
    ngcore::FlatArray<const TipFunctions*> tips;
    const ElementParts * parts;             // nullptr: the element is one
    const ElementCracks<2> * cut;           // nullptr: no crack meets it, or nothing jumps in it

  public:
    CrackFiniteElement (const BaseScalarFiniteElement & ascalar, ngcore::FlatArray<HeavisideFunction> aheaviside,
                        ngcore::FlatArray<const TipFunctions*> atips, const ElementParts * aparts, const ElementCracks<2> * acut)
      : FiniteElement(0, ascalar.Order()), scalar(ascalar), heaviside(aheaviside), tips(atips), parts(aparts), cut(acut)
    {
      ndof = 2*NumScalar() + NumTip();
    }

    ngfem::ELEMENT_TYPE ElementType() const override { return scalar.ElementType(); }
    string ClassName() const override { return "CrackFiniteElement"; }

    /// Dofs: the scalar functions (φ_i, then their copies) for x, the same for y, the tips' vector fields.
    size_t NumScalar () const { return scalar.GetNDof() + heaviside.Size(); }
    size_t NumTip () const
    {
      size_t n = 0;
      for (auto tip : tips) n += tip->Size();
      return n;
    }

    const BaseScalarFiniteElement & Scalar() const { return scalar; }
    ngcore::FlatArray<HeavisideFunction> Heaviside() const { return heaviside; }
    ngcore::FlatArray<const TipFunctions*> Tips() const { return tips; }

    /// Whether all scalar functions are multiples of φ_i on this element.
    bool IsPolynomial (Trace trace) const
    {
      if (trace != Trace::Position) return !cut || cut->HasOneFacet();
      if (parts)
        for (auto & function : heaviside)
          for (size_t part = 1; part < parts->NumParts(); part++)
            if (function.factors[part] != function.factors[0]) return false;
      return true;
    }

    /// The number of the part in which a function is evaluated.
    size_t PartAt (Trace trace, PlacedPoint & x) const
    {
      if (trace == Trace::Position) return parts ? x.PartOf(*parts) : 0;
      if (!cut) return 0;
      auto & sides = x.SidesOf(*cut);
      return trace == Trace::Plus ? sides.plus : trace == Trace::Minus ? sides.minus : sides.Larger();
    }

    /// The factor of φ_i at x; needs no x if IsPolynomial.
    int HeavisideFactor (const HeavisideFunction & function, Trace trace, PlacedPoint & x) const
    {
      if (trace != Trace::Jump) return function.factors[PartAt(trace, x)];
      return cut ? function.factors[PartAt(Trace::Plus, x)] - function.factors[PartAt(Trace::Minus, x)] : 0;
    }

    /// On Γ_C the side of the limit that is asked for.
    int ForcedSide (Trace trace, PlacedPoint & x) const
    {
      switch (trace)
        {
        case Trace::Plus: return 1;
        case Trace::Minus: return -1;
        case Trace::Larger: return cut ? x.SidesOf(*cut).larger_side : 0;
        default: return 0;
        }
    }

    /// visit(number of the dof, s) for every function of the tips at x, see TipFunctions::SingularDivergence.
    template <typename F>
    void VisitSingularDivergence (PlacedPoint & x, Trace trace, F && visit) const
    {
      size_t dof = 2*NumScalar();
      for (auto tip : tips)
        {
          auto s = tip->SingularDivergence(x.Place(), ForcedSide(trace, x));
          for (int m = 0; m < tip->Size(); m++, dof++)
            if (m < 2) visit(dof, s[m]);
        }
    }

    /// visit(m, field) for the m-th function of the tips at x; FIELD: Vec<2,AutoDiff<2,T>>, with its gradient, or Vec<2,T>. side: see ForcedSide.
    template <typename FIELD, typename T, typename F>
    void VisitTipFunctions (Vec<2,T> x, Trace trace, int side, F && visit) const
    {
      FIELD values[TipFunctions::max_functions], minus[TipFunctions::max_functions];
      size_t number = 0;
      bool on_edge = ElementType() == ngfem::ET_SEGM;             // off Γ_C: a point of it has one value
      for (auto tip : tips)
        {
          tip->Evaluate(x, on_edge ? 0 : trace == Trace::Jump ? 1 : side, values);
          if (trace == Trace::Jump)
            {
              tip->Evaluate(x, on_edge ? 0 : -1, minus);
              for (int m = 0; m < tip->Size(); m++)
                for (int k = 0; k < 2; k++) values[m](k) -= minus[m](k);
            }
          for (int m = 0; m < tip->Size(); m++)
            visit(number++, values[m]);
        }
    }
  };
}
