#pragma once
// What V_h has in one element beside φ_i and their copies: in the plane functions at tips, in space modes of fronts times hats.

#include "cut/cut_geometry.hpp"
#include "spaces/front_functions.hpp"
#include "spaces/tip_functions.hpp"

namespace ngsxfem_contact
{
  /// Visit(x, side, visit): visit(m, field) for the m-th function at x; FIELD: Vec<D,AutoDiff<D,T>>, with its gradient, or Vec<D,T>. side: 0, by the
  /// position of x, or ±1, the limit on Γ_C.
  template <int D>
  class SingularFunctions;

  template <>
  class SingularFunctions<2>
  {
    FlatArray<const TipFunctions*> tips;
  public:
    explicit SingularFunctions (FlatArray<const TipFunctions*> atips) : tips(atips) { }
    FlatArray<const TipFunctions*> Tips () const { return tips; }
    bool Empty () const { return tips.Size() == 0; }
    size_t Size () const
    {
      size_t n = 0;
      for (auto tip : tips) n += tip->Size();
      return n;
    }

    template <typename FIELD, typename T, typename F>
    void Visit (Vec<2,T> x, int side, F && visit) const
    {
      FIELD values[TipFunctions::max_functions];
      size_t number = 0;
      for (auto tip : tips)
        {
          tip->Evaluate(x, side, values);
          for (int m = 0; m < tip->Size(); m++) visit(number++, values[m]);
        }
    }
  };

  /// A node with the modes of a front, in one element: its hat is hat(0) + hat(1..3)·x there. has_sides: whether limits on Γ_C in the element are those of
  /// the front's own sheet; on another sheet the modes are smooth. flat: the coordinates of a curved sheet there, nullptr for a planar one.
  struct NodeWithModes { Vec<4> hat; const FrontFunctions * modes; bool has_sides; const FlatMap * flat; };

  template <>
  class SingularFunctions<3>
  {
    FlatArray<NodeWithModes> nodes;
  public:
    explicit SingularFunctions (FlatArray<NodeWithModes> anodes) : nodes(anodes) { }
    bool Empty () const { return nodes.Size() == 0; }
    size_t Size () const { return FrontFunctions::size*nodes.Size(); }

    template <typename FIELD, typename T, typename F>
    void Visit (Vec<3,T> x, int side, F && visit) const
    {
      FIELD modes[FrontFunctions::size];
      for (auto & mode : modes) for (int k = 0; k < 3; k++) mode(k) = 0.;   // compilers do not see that they are evaluated before they are used
      const FrontFunctions * last = nullptr;
      size_t number = 0;
      for (auto & node : nodes)
        {
          if (node.modes != last) node.modes->Evaluate(x, node.has_sides ? side : 0, node.flat, modes);
          last = node.modes;
          auto hat = HatAt(node, x, modes[0](0));
          for (auto & mode : modes)
            {
              FIELD product;
              for (int k = 0; k < 3; k++) product(k) = hat * mode(k);
              visit(number++, product);
            }
        }
    }

  private:
    template <typename T>
    static T HatAt (const NodeWithModes & node, Vec<3,T> x, const T &)
    { return node.hat(0) + node.hat(1)*x(0) + node.hat(2)*x(1) + node.hat(3)*x(2); }

    template <typename T>
    static AutoDiff<3,T> HatAt (const NodeWithModes & node, Vec<3,T> x, const AutoDiff<3,T> &)
    {
      AutoDiff<3,T> hat(HatAt(node, x, x(0)));
      for (int i = 0; i < 3; i++) hat.DValue(i) = T(node.hat(i+1));
      return hat;
    }
  };
}
