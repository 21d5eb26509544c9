#pragma once
// A mesh with its cracks: where they lie, which elements they meet, and their tips.

#include "cut/crack_ends.hpp"
#include "cut/crack_meetings.hpp"
#include "cut/cut_element.hpp"
#include "cut/mesh_state.hpp"
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

  /// An edge beside cracked elements: the stretches of cracks along it, from 0 to 1 times its length, and which parts of its two elements are one.
  struct CutEdge
  {
    struct Covered { double t0, t1; };
    std::vector<Covered> covered;
    std::vector<std::array<size_t,2>> links;
  };

  /// A boundary element between the vertices v[1] (0) and v[0] (1): its parts end at `ends`, the last of which is 1.
  class DividedBoundary final : public BoundaryParts
  {
  public:
    std::vector<double> ends;
    size_t PartAt (const ngfem::IntegrationPoint & ip) const override
    { return std::min<size_t>(std::ranges::lower_bound(ends, ip(0)) - ends.begin(), ends.size()-1); }
  };

  /// The CutGeometry of the plane: says where things are, and never changes. It is final, so that calls through its own type are not virtual.
  class CrackedMesh final : public CutGeometry<2>
  {
    shared_ptr<MeshAccess> mesh;
    MeshState located_in;
    std::vector<Crack> cracks;
    std::vector<std::string> notes;
    std::deque<CrackLocation> locations;
    std::vector<Tip> tips;
    std::map<size_t, CutElement> cut_elements;
    std::map<size_t, CutEdge> cut_edges;
    std::map<size_t, DividedBoundary> boundary_parts;

  public:
    /// The cracks are fitted to the body and to each other first: see FittedToBody, FitToEachOther.
    /// Throws for a mesh that is not plane triangles, for what FittedToBody, AllMeetings, CrackLocation and CutElement refuse, and for a
    /// mesh with a deformation.
    /// is_part: the mesh is a part of the body's, with all that lies beside cracks and beside ∂Ω.
    CrackedMesh (shared_ptr<MeshAccess> amesh, std::vector<Crack> acracks, bool is_part = false);
    CrackedMesh (const CrackedMesh &) = delete;        // spaces, measures and functions share one

    shared_ptr<MeshAccess> GetMesh () const override { return mesh; }
    void CheckMesh () const override { located_in.Check(*mesh); }
    size_t NumCracks () const override { return cracks.size(); }
    Frame<2> FrameAt (size_t crack, const ElementCracks<2> * element, Point x) const override;
    size_t CrackAt (const ElementCracks<2> * element, Point x) const override;
    const CutElement * Find (size_t element) const override { return FindIn(cut_elements, element); }
    std::vector<size_t> CrackedElements () const override { return ElementsOf(cut_elements); }
    const DividedBoundary * FindBoundary (size_t bnd_element) const override { return FindIn(boundary_parts, bnd_element); }
    std::vector<std::array<size_t,2>> Links (size_t edge) const override;

    /// These throw for a number that is not below NumCracks().
    const Crack & GetCrack (size_t i) const { return cracks[Checked(i)]; }
    const CrackLocation & Location (size_t i) const { return locations[Checked(i)]; }
    /// The number of the crack with a name. Throws if there is none.
    size_t CrackNumber (const string & name) const override;
    /// Points of a crack at arc lengths, each in an element that carries that part of it, in reference coordinates.
    std::vector<std::pair<size_t, ngfem::IntegrationPoint>> OnCrack (size_t crack, const std::vector<double> & arclengths) const;
    const std::vector<Crack> & Cracks() const { return cracks; }
    const std::vector<Tip> & Tips() const { return tips; }
    /// What was changed at the ends of the cracks, in words.
    const std::vector<std::string> & Notes() const { return notes; }

    /// For each element that cracks meet: them and its parts.
    const std::map<size_t, CutElement> & CutElements() const { return cut_elements; }

  private:
    void CheckNames () const;
    void LocateCracks (const std::vector<std::vector<double>> & meetings);
    CutElement & CutElementOf (size_t element);
    void AlignEdges ();
    void AlignEdge (size_t crack, size_t edge, const std::vector<Chord> & chords);
    void CompareNeighbours ();
    void DivideBoundary ();
    /// The parts of an element along an edge, from the vertex with the lower number.
    std::vector<ElementDivision::Interval> Along (size_t element, size_t edge) const;
    void FindTips (const BodyBoundary & boundary);
    void SetClearance (Tip & tip, const BodyBoundary & boundary) const;
    void LimitByOwnCrack (const Tip & tip, const std::function<void(double, std::string)> & limit) const;
  };
}
