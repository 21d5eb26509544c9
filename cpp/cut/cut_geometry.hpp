#pragma once
// What the spaces and the forms ask of a body with cracks. The plane's answers are those of CrackedMesh, in space those of CrackedSolid.

#include "curve/crack.hpp"
#include <algorithm>
#include <comp.hpp>
#include <functional>
#include <map>
#include <optional>

namespace ngsxfem_contact
{
  using std::shared_ptr;
  using ngcomp::MeshAccess, ngcomp::NodeId, ngcore::FlatArray;

  enum class ElementKind
    {
      Uncut,      // Γ_C does not meet the open element (it may pass through a vertex)
      Cut,        // Γ_C crosses it from boundary to boundary
      Tip,        // Γ_C ends inside: a tip, of a sheet a front
      Aligned     // Γ_C runs along a facet that this element carries for both neighbours
    };

  struct ElementLocation;                  // of the plane, which its rules and multipliers ask for more

  /// One of the cracks that meet an element. location: in the plane.
  struct ElementCrack { size_t crack; const ElementLocation * location; ElementKind kind; };

  /// The parts on either side of Γ_C at a point of it, the same one beside a tip.
  struct CrackSides
  {
    size_t crack, plus, minus;
    int larger_side;                                // ±1: that of the larger one of the two, whose stress is R_h
    size_t Larger () const { return larger_side > 0 ? plus : minus; }
  };

  /// A part of an element: what is connected in it without crossing a crack.
  struct PartOfElement
  {
    size_t element, part;
    auto operator<=> (const PartOfElement &) const = default;
  };

  /// The parts of an element of the mesh, or of a boundary element: numbers from 0. Parts of neighbours that lie across a facet along which a
  /// crack runs follow those of the element itself.
  class ElementParts
  {
  public:
    virtual ~ElementParts () = default;
    virtual size_t NumParts () const = 0;
    /// By NGSolve's reference coordinates.
    virtual size_t PartAt (const ngfem::IntegrationPoint & ip) const = 0;
  };

  /// An element that cracks meet. h: its longest edge.
  template <int D>
  class ElementCracks : public ElementParts
  {
  public:
    std::vector<ElementCrack> cracks;
    double h;
    std::vector<double> sizes;                      // areas or volumes of its own parts
    std::vector<PartOfElement> across;              // those of neighbours

    size_t NumParts () const override { return sizes.size(); }
    bool IsShared () const { return cracks.size() > 1; }
    /// nullptr: the crack does not meet the element.
    const ElementCrack * Find (size_t crack) const
    {
      auto here = std::ranges::find(cracks, crack, &ElementCrack::crack);
      return here == cracks.end() ? nullptr : &*here;
    }
    /// At x, a point of Γ_C in the element. Its parts have numbers below NumParts(), others are across[number-NumParts()].
    virtual CrackSides SidesAt (Vec<D> x) const = 0;
    /// Whether all points of Γ_C in the element have the same sides.
    virtual bool HasOneFacet () const = 0;
    /// visit(sides, measure) for the facets of Γ_C in the element.
    virtual void VisitFacets (const std::function<void(const CrackSides &, double)> & visit) const = 0;
  };

  /// A boundary element, or one of an inner interface, that cracks divide: parts, their sizes, and of which part of a neighbour each is a facet.
  class BoundaryParts : public ElementParts
  {
  public:
    std::vector<double> sizes;
    std::vector<PartOfElement> beside;
    size_t NumParts () const override { return sizes.size(); }
  };

  /// Directions of unit length on a crack. The normal points from the minus to the plus side.
  template <int D>
  struct Frame { Vec<D> normal; std::array<Vec<D>,D-1> tangents; };

  /// What a map holds for an element; nullptr: nothing.
  template <typename T>
  const T * FindIn (const std::map<size_t, T> & of_element, size_t element)
  {
    auto it = of_element.find(element);
    return it == of_element.end() ? nullptr : &it->second;
  }

  /// The elements that a map holds something for.
  template <typename T>
  std::vector<size_t> ElementsOf (const std::map<size_t, T> & of_element)
  {
    std::vector<size_t> elements;
    for (auto & [element, held] : of_element) elements.push_back(element);
    return elements;
  }

  /// A body with cracks, of any dimension.
  class CrackedBody
  {
  public:
    virtual ~CrackedBody () = default;
    virtual shared_ptr<MeshAccess> GetMesh () const = 0;
    /// Throws if the mesh was changed after the cracks were located in it.
    virtual void CheckMesh () const = 0;
    virtual size_t NumCracks () const = 0;
    /// Of the crack with a name; throws std::invalid_argument if there is none.
    virtual size_t CrackNumber (const std::string & name) const
    { throw std::invalid_argument("CrackedMesh: no crack is named '" + name + "'; sheets have no names, give the number"); }
    /// Elements that carry a part of Γ_C (of one crack, or of all of them).
    virtual shared_ptr<ngcore::BitArray> CrackElements (std::optional<size_t> crack = std::nullopt) const = 0;

  protected:
    /// Throws for a number that is not below NumCracks().
    size_t Checked (size_t crack) const
    {
      if (crack >= NumCracks())
        throw ngcore::Exception("CrackedMesh: there is no crack " + std::to_string(crack) + "; the body has " + std::to_string(NumCracks()));
      return crack;
    }
  };

  /// A body in D dimensions. Nothing here depends on a space or a rule, and nothing changes. All answers are the same for neighbours: what an
  /// element is told of a facet, its neighbour is told, too.
  template <int D>
  class CutGeometry : public CrackedBody
  {
  public:
    static constexpr int dimension = D;
    /// At the point of a crack that is nearest to x, in an element that it meets, or anywhere (nullptr).
    virtual Frame<D> FrameAt (size_t crack, const ElementCracks<D> * element, Vec<D> x) const = 0;
    /// The crack that x, a point of Γ_C, lies on: the nearest of those that meet the element, of all if there are none (nullptr).
    virtual size_t CrackAt (const ElementCracks<D> * element, Vec<D> x) const = 0;

    /// nullptr for an element that no crack crosses, ends in, or runs along: it is one part.
    virtual const ElementCracks<D> * Find (size_t element) const = 0;
    /// The elements that have such.
    virtual std::vector<size_t> CrackedElements () const = 0;
    /// nullptr for a boundary element that no crack divides.
    virtual const BoundaryParts * FindBoundary (size_t bnd_element) const = 0;
    /// Which parts of the two elements beside a facet of the mesh hang together across it, in the mesh's order of the elements.
    virtual std::vector<std::array<size_t,2>> Links (size_t facet) const = 0;

    shared_ptr<ngcore::BitArray> CrackElements (std::optional<size_t> crack = std::nullopt) const override
    {
      if (crack) Checked(*crack);
      auto elements = make_shared<ngcore::BitArray>(GetMesh()->GetNE(ngfem::VOL));
      elements->Clear();
      for (size_t element : CrackedElements())
        if (!crack || Find(element)->Find(*crack)) elements->SetBit(element);
      return elements;
    }
  };
}
