#pragma once
// The finite element of V_h on one triangle or boundary edge: φ_i, ½(H - s_i) φ_i and χ F_j  (docs/method.md, section 3).
//
// The Heaviside functions are shifted by the sign s_i of the larger part of the support of φ_i: ½(H - s_i) φ_i spans
// with φ_i what H φ_i does, vanishes on the larger part, and has the jump φ_i, so its coefficient is the nodal jump.

#include "rules/body_rules.hpp"
#include "spaces/tip_functions.hpp"

namespace ngsxfem_contact
{
  using ngfem::FiniteElement, ngfem::BaseScalarFiniteElement;

  struct HeavisideFunction
  {
    int local;          // which φ_i of the element
    int shift;          // s_i
    size_t crack;
    int side;           // of this element with respect to the crack; 0 if the crack divides it or runs along it

    double Value (int h) const { return 0.5*(h-shift); }
  };

  /// A point and its sides, each found when it is first asked for and kept for the other functions there.
  class SidedPoint
  {
    const CrackedMesh * body = nullptr;
    Point x;
    size_t crack = size_t(-1);
    int side = 0;
  public:
    SidedPoint () = default;
    SidedPoint (const CrackedMesh & abody, Point ax) : body(&abody), x(ax) { }
    Point Place () const { return x; }
    int SideOf (size_t of)
    {
      if (of != crack) { crack = of; side = int(body->SideOf(of, x)); }
      return side;
    }
  };

  /// Where a function that jumps is evaluated. On Γ_C a point has no side of its own.
  enum class Trace { Position, Plus, Minus, Jump, Larger };

  class CrackFiniteElement : public FiniteElement
  {
    const BaseScalarFiniteElement & scalar;
    ngcore::FlatArray<HeavisideFunction> heaviside;
    ngcore::FlatArray<const TipFunctions*> tips;
    const CrackedMesh & body;           // asked as a CutGeometry only; by its final type, so that no call is virtual
    const ElementCracks * cut;          // nullptr: no crack meets the element, or nothing jumps in it

  public:
    CrackFiniteElement (const BaseScalarFiniteElement & ascalar, ngcore::FlatArray<HeavisideFunction> aheaviside,
                        ngcore::FlatArray<const TipFunctions*> atips, const CrackedMesh & abody, const ElementCracks * acut)
      : FiniteElement(0, ascalar.Order()), scalar(ascalar), heaviside(aheaviside), tips(atips), body(abody), cut(acut)
    {
      ndof = 2*NumScalar() + NumTip();
    }

    ngfem::ELEMENT_TYPE ElementType() const override { return scalar.ElementType(); }
    string ClassName() const override { return "CrackFiniteElement"; }

    /// Dofs: the scalar functions (φ_i, then ½(H - s_i) φ_i) for x, the same for y, the tips' vector fields.
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

    /// Whether points on Γ_C lie on different cracks.
    bool IsShared () const { return cut && cut->IsShared(); }

    /// Whether all scalar functions are multiples of φ_i on this element.
    bool IsPolynomial (Trace trace) const
    {
      if (IsShared()) return false;
      if (trace == Trace::Position)
        for (auto & function : heaviside)
          if (function.side == 0) return false;
      return true;
    }

    SidedPoint At (Point x) const { return { body, x }; }

    /// The factor of φ_i at x; needs no x if IsPolynomial. On one crack the functions of another have no limits of their own.
    double HeavisideFactor (const HeavisideFunction & function, Trace trace, SidedPoint & x) const
    {
      if (function.side) return trace == Trace::Jump ? 0 : function.Value(function.side);
      if (trace == Trace::Jump) return IsElsewhere(function.crack, x.Place()) ? 0 : function.Value(1) - function.Value(-1);
      return function.Value(SideAt(function.crack, trace, x));
    }

    /// The side of x with respect to a crack that divides the element.
    int SideAt (size_t crack, Trace trace, SidedPoint & x) const
    {
      bool by_position = trace == Trace::Position || IsElsewhere(crack, x.Place());
      return by_position ? x.SideOf(crack) : ForcedSide(trace, crack);
    }

    /// Whether a point of Γ_C lies on another crack.
    bool IsElsewhere (size_t crack, Point x) const { return IsShared() && body.CrackAt(cut, x) != crack; }

    /// The cracks across which functions of the element jump.
    std::vector<size_t> DividingCracks () const
    {
      std::set<size_t> cracks;
      for (auto & function : heaviside)
        if (function.side == 0) cracks.insert(function.crack);
      return { cracks.begin(), cracks.end() };
    }

    int ForcedSide (Trace trace, size_t crack) const
    {
      switch (trace)
        {
        case Trace::Plus: return 1;
        case Trace::Minus: return -1;
        case Trace::Larger:
          {
            auto here = cut ? cut->Find(crack) : nullptr;
            return here ? int(here->larger) : 0;
          }
        default: return 0;
        }
    }

    /// visit(number of the dof, s) for every function of the tips at x, see TipFunctions::SingularDivergence.
    template <typename F>
    void VisitSingularDivergence (Point x, Trace trace, F && visit) const
    {
      size_t dof = 2*NumScalar();
      for (auto tip : tips)
        {
          auto s = tip->SingularDivergence(x, ForcedSide(trace, tip->Crack()));
          for (int m = 0; m < tip->Size(); m++, dof++)
            if (m < 2) visit(dof, s[m]);
        }
    }

    /// visit(m, field) for the m-th function of the tips at x; FIELD: Vec<2,AutoDiff<2,T>>, with its gradient, or Vec<2,T>.
    template <typename FIELD, typename T, typename F>
    void VisitTipFunctions (Vec<2,T> x, Trace trace, F && visit) const
    {
      FIELD values[TipFunctions::max_functions], minus[TipFunctions::max_functions];
      size_t number = 0;
      bool on_edge = ElementType() == ngfem::ET_SEGM;             // off Γ_C: a point of it has one value
      for (auto tip : tips)
        {
          tip->Evaluate(x, on_edge ? 0 : trace == Trace::Jump ? 1 : ForcedSide(trace, tip->Crack()), values);
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
