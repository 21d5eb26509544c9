#pragma once
// A mesh with its cracks: where they lie, which elements they meet, and their tips.

#include "cut/crack_ends.hpp"
#include "cut/cut_element.hpp"
#include "curve/tip_curve.hpp"
#include <functional>
#include <memory>

namespace ngsxfem_contact
{
  using ngfem::ElementId, ngfem::VorB, ngfem::VOL, ngfem::BND;

  struct Tip
  {
    size_t crack;
    double s;                    // its arc length: 0 or the crack's length
    TipCurve curve;
    Point point, ahead;          // ahead: the direction in which the crack would grow
    int plus_sign;               // the sign of θ on the plus side, θ = 0 ahead
    double clearance;            // to ∂Ω, other cracks, the next kink, half the way to other tips, half of the radius of curvature
    std::string limit;           // what sets the clearance
    std::vector<std::pair<double, std::string>> distances {};    // of ∂Ω and of the other cracks
  };

  /// What a mesh was when cracks were located in it.
  struct MeshState
  {
    size_t num_elements, num_vertices;
    int curve_order;
    bool deformed;
    explicit MeshState (MeshAccess & mesh);
    auto operator<=> (const MeshState &) const = default;
  };

  /// The CutGeometry of the plane: says where things are, and never changes. It is final, so that calls through its own type are not virtual.
  class CrackedMesh final : public CutGeometry<2>
  {
    shared_ptr<MeshAccess> mesh;
    MeshState located_in;
    std::vector<Crack> cracks;
    std::vector<std::string> notes;
    std::vector<CrackLocation> locations;
    std::vector<Tip> tips;
    std::map<size_t, CutElement> cut_elements;

  public:
    /// The cracks are fitted to the body first: see FittedToBody.
    /// Throws for a mesh that is not plane triangles, for what FittedToBody, CrackLocation and CutElement refuse, for cracks that meet, and for a
    /// mesh with a deformation.
    CrackedMesh (shared_ptr<MeshAccess> amesh, std::vector<Crack> acracks);

    shared_ptr<MeshAccess> GetMesh () const override { return mesh; }
    void CheckMesh () const override;
    size_t NumCracks () const override { return cracks.size(); }
    Side SideOf (size_t crack, Point x) const override { return cracks[crack].SideOf(x); }
    Frame<2> FrameAt (size_t crack, Point x) const override;
    size_t CrackAt (const ElementCracks * element, Point x) const override;
    const CutElement * Find (size_t element) const override;
    std::vector<size_t> ElementsOf (size_t crack) const override;
    bool EndsIn (size_t crack, NodeId node, FlatArray<int> support) const override { return Location(crack).EndsIn(node, support); }
    bool RunsAlong (size_t crack, NodeId node) const override { return Location(crack).RunsAlong(node); }
    Side SideBeyond (size_t crack, size_t element, size_t edge) const override { return Location(crack).SideBeyond(element, edge); }
    std::optional<Measures> BoundarySizes (size_t crack, size_t bnd_element) const override { return Location(crack).BoundarySizes(bnd_element); }

    /// These throw for a number that is not below NumCracks().
    const Crack & GetCrack (size_t i) const { return cracks[Checked(i)]; }
    const CrackLocation & Location (size_t i) const { return locations[Checked(i)]; }
    /// Points of a crack at arc lengths, each in an element that carries that part of it, in reference coordinates.
    std::vector<std::pair<size_t, ngfem::IntegrationPoint>> OnCrack (size_t crack, const std::vector<double> & arclengths) const;
    const std::vector<Crack> & Cracks() const { return cracks; }
    const std::vector<Tip> & Tips() const { return tips; }
    /// What was changed at the ends of the cracks, in words.
    const std::vector<std::string> & Notes() const { return notes; }

    /// Elements that carry a part of Γ_C (of one crack, or of all of them).
    shared_ptr<ngcore::BitArray> CrackElements (std::optional<size_t> crack = std::nullopt) const;

    /// For each element that cracks meet: them and its parts.
    const std::map<size_t, CutElement> & CutElements() const { return cut_elements; }

  private:
    size_t Checked (size_t crack) const;
    void CheckDistinct () const;
    void FindCutElements ();
    void FindTips (const BodyBoundary & boundary);
    void SetClearance (Tip & tip, const BodyBoundary & boundary) const;
    void LimitByOwnCrack (const Tip & tip, const std::function<void(double, std::string)> & limit) const;
  };
}
