#pragma once
// What the spaces and the forms ask of a body with cracks. The plane's answers are those of CrackedMesh.

#include "curve/crack.hpp"
#include <algorithm>
#include <comp.hpp>
#include <optional>

namespace ngsxfem_contact
{
  using std::shared_ptr;
  using ngcomp::MeshAccess, ngcomp::NodeId, ngcore::FlatArray;

  enum class ElementKind
    {
      Uncut,      // Γ_C does not meet the open element (it may pass through a vertex)
      Cut,        // Γ_C crosses it from boundary to boundary
      Tip,        // Γ_C ends inside
      Aligned     // Γ_C runs along a facet that this element carries for both neighbours
    };

  /// Lengths, areas or volumes on either side of a crack.
  struct Measures
  {
    double plus = 0, minus = 0;
    double & operator[] (Side side) { return side == Side::Plus ? plus : minus; }
    Measures & operator+= (const Measures & other) { plus += other.plus; minus += other.minus; return *this; }
    /// The side of the larger one; plus if they are equal but for round-off, so that no numbering decides.
    Side Larger () const { return plus >= (1-1e-8)*minus ? Side::Plus : Side::Minus; }
  };

  struct ElementLocation;                  // of the plane, which its rules and multipliers ask for more

  /// One of the cracks that meet an element. larger: the side of the larger one of the two parts directly beside it, whose stress is R_h.
  struct ElementCrack { size_t crack; const ElementLocation * location; ElementKind kind; Measures sizes; Side larger; };

  /// An element that cracks meet. h: its longest edge.
  struct ElementCracks
  {
    std::vector<ElementCrack> cracks;
    double h;

    bool IsShared () const { return cracks.size() > 1; }
    /// nullptr: the crack does not meet the element.
    const ElementCrack * Find (size_t crack) const
    {
      auto here = std::ranges::find(cracks, crack, &ElementCrack::crack);
      return here == cracks.end() ? nullptr : &*here;
    }
  };

  /// Directions of unit length on a crack. The normal points from the minus to the plus side.
  template <int D>
  struct Frame { Vec<D> normal; std::array<Vec<D>,D-1> tangents; };

  /// A body in D dimensions. Nothing here depends on a space or a rule, and nothing changes. All answers are the same for neighbours: what an
  /// element is told of a facet, its neighbour is told, too.
  template <int D>
  class CutGeometry
  {
  public:
    virtual ~CutGeometry () = default;
    virtual shared_ptr<MeshAccess> GetMesh () const = 0;
    /// Throws if the mesh was changed after the cracks were located in it.
    virtual void CheckMesh () const = 0;
    virtual size_t NumCracks () const = 0;

    /// Of x with respect to a crack: Plus on the crack itself; beyond where it ends the side of some smooth continuation.
    virtual Side SideOf (size_t crack, Vec<D> x) const = 0;
    /// At the point of a crack that is nearest to x.
    virtual Frame<D> FrameAt (size_t crack, Vec<D> x) const = 0;
    /// The crack that x, a point of Γ_C, lies on: the nearest of those that meet the element, of all if there are none (nullptr).
    virtual size_t CrackAt (const ElementCracks * element, Vec<D> x) const = 0;

    /// nullptr for an element that no crack crosses, ends in, or runs along.
    virtual const ElementCracks * Find (size_t element) const = 0;
    /// The elements that a crack meets.
    virtual std::vector<size_t> ElementsOf (size_t crack) const = 0;

    /// Whether a crack ends inside the open support of the functions of a node; support: its elements.
    virtual bool EndsIn (size_t crack, NodeId node, FlatArray<int> support) const = 0;
    /// Whether a crack runs along a facet that the node belongs to.
    virtual bool RunsAlong (size_t crack, NodeId node) const = 0;
    /// The side just beyond a facet of an element that the crack meets, where the crack itself does not go.
    virtual Side SideBeyond (size_t crack, size_t element, size_t facet) const = 0;
    /// What lies on either side of a boundary element that the crack cuts; nothing if it does not.
    virtual std::optional<Measures> BoundarySizes (size_t crack, size_t bnd_element) const = 0;
  };
}
