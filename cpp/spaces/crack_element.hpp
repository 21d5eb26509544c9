#pragma once
// The finite element of V_h on one element or boundary element: φ_i, its copies, and singular functions  (docs/method.md, section 3).
//
// Where cracks divide the support of φ_i into several connected parts, φ_i has a copy on each but the largest: ±φ_i there, 0 elsewhere. They
// span with φ_i one function for each part, vanish on the largest, and their coefficients are the jumps at the node.

#include "rules/measure_rules.hpp"
#include "spaces/singular_functions.hpp"

namespace ngsxfem_contact
{
  using ngfem::FiniteElement, ngfem::BaseScalarFiniteElement;

  struct HeavisideFunction
  {
    int local;                              // which φ_i of the element
    std::vector<signed char> factors;       // of φ_i, on each part of the element and on those across its edges: see ElementParts
  };

  /// A point and its parts, each found when it is first asked for and kept for the other functions there.
  template <int D>
  class PlacedPoint
  {
    ngfem::IntegrationPoint ip;
    Vec<D> x;
    std::optional<size_t> part;
    std::optional<CrackSides> sides;
  public:
    PlacedPoint () = default;
    PlacedPoint (const ngfem::IntegrationPoint & aip, Vec<D> ax) : ip(aip), x(ax) { }
    Vec<D> Place () const { return x; }
    size_t PartOf (const ElementParts & parts)
    {
      if (!part) part = parts.PartAt(ip);
      return *part;
    }
    const CrackSides & SidesOf (const ElementCracks<D> & cut)
    {
      if (!sides) sides = cut.SidesAt(x);
      return *sides;
    }
  };

  /// Where a function that jumps is evaluated. On Γ_C a point has no side of its own.
  enum class Trace { Position, Plus, Minus, Jump, Larger };

  template <int D>
  class CrackFiniteElement : public FiniteElement
  {
    const BaseScalarFiniteElement & scalar;
    ngcore::FlatArray<HeavisideFunction> heaviside;
    SingularFunctions<D> singular;
    const ElementParts * parts;             // nullptr: the element is one
    const ElementCracks<D> * cut;           // nullptr: no crack meets it, or nothing jumps in it

  public:
    CrackFiniteElement (const BaseScalarFiniteElement & ascalar, ngcore::FlatArray<HeavisideFunction> aheaviside,
                        SingularFunctions<D> asingular, const ElementParts * aparts, const ElementCracks<D> * acut)
      : FiniteElement(0, ascalar.Order()), scalar(ascalar), heaviside(aheaviside), singular(asingular), parts(aparts), cut(acut)
    {
      ndof = D*NumScalar() + NumSingular();
    }

    ngfem::ELEMENT_TYPE ElementType() const override { return scalar.ElementType(); }
    string ClassName() const override { return "CrackFiniteElement"; }

    /// Dofs: the scalar functions (φ_i, then their copies) for x, the same for the other components, the singular vector fields.
    size_t NumScalar () const { return scalar.GetNDof() + heaviside.Size(); }
    size_t NumSingular () const { return singular.Size(); }

    const BaseScalarFiniteElement & Scalar() const { return scalar; }
    ngcore::FlatArray<HeavisideFunction> Heaviside() const { return heaviside; }
    const SingularFunctions<D> & Singular() const { return singular; }

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
    size_t PartAt (Trace trace, PlacedPoint<D> & x) const
    {
      if (trace == Trace::Position) return parts ? x.PartOf(*parts) : 0;
      if (!cut) return 0;
      auto & sides = x.SidesOf(*cut);
      return trace == Trace::Plus ? sides.plus : trace == Trace::Minus ? sides.minus : sides.Larger();
    }

    /// The factor of φ_i at x; needs no x if IsPolynomial.
    int HeavisideFactor (const HeavisideFunction & function, Trace trace, PlacedPoint<D> & x) const
    {
      if (trace != Trace::Jump) return function.factors[PartAt(trace, x)];
      return cut ? function.factors[PartAt(Trace::Plus, x)] - function.factors[PartAt(Trace::Minus, x)] : 0;
    }

    /// On Γ_C the side of the limit that is asked for.
    int ForcedSide (Trace trace, PlacedPoint<D> & x) const
    {
      switch (trace)
        {
        case Trace::Plus: return 1;
        case Trace::Minus: return -1;
        case Trace::Larger: return cut ? x.SidesOf(*cut).larger_side : 0;
        default: return 0;
        }
    }

    /// visit(m, field) for the m-th singular function at x; FIELD: Vec<D,AutoDiff<D,T>>, with its gradient, or Vec<D,T>. side: see ForcedSide.
    template <typename FIELD, typename T, typename F>
    void VisitSingular (Vec<D,T> x, Trace trace, int side, F && visit) const
    {
      bool on_boundary = ngfem::Dim(ElementType()) < D;            // off Γ_C: a point of it has one value
      if (trace != Trace::Jump) return singular.template Visit<FIELD>(x, on_boundary ? 0 : side, visit);
      ngcore::ArrayMem<FIELD, 12> plus(NumSingular());
      singular.template Visit<FIELD>(x, on_boundary ? 0 : 1, [&] (size_t m, const FIELD & value) { plus[m] = value; });
      singular.template Visit<FIELD>(x, on_boundary ? 0 : -1, [&] (size_t m, const FIELD & value)
      {
        for (int k = 0; k < D; k++) plus[m](k) -= value(k);
        visit(m, plus[m]);
      });
    }
  };
}
