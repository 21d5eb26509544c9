#pragma once
// Where each element lies with respect to one crack, and the triangles that a crack divides it into.

#include "cut/cut_geometry.hpp"
#include "cut/element_map.hpp"
#include <map>
#include <set>

namespace ngsxfem_contact
{
  /// The special positions. A position that holds to within geometric_tolerance counts as exact.
  struct Degeneracy { bool through_vertex = false, along_edge = false, tip_on_edge = false, tip_on_vertex = false, kink_inside = false; };

  /// The part of Γ_C in a curved element, in the coordinates of its straight triangle (ElementMap), as a crack of its own.
  struct StraightenedCrack { Crack crack; std::vector<Chord> chords; };

  /// Of a curved element all but the chords refers to its straight triangle: the areas, and the parts, whose curved sides are stretches of
  /// the straightened crack.
  struct ElementLocation
  {
    size_t element;
    ElementKind kind;
    Degeneracy degeneracy;
    Triangle triangle;
    double h;                       // longest edge
    std::vector<Chord> chords;      // in the order of arc length; the crack may leave T for a moment between two of them
    std::vector<Part> parts;
    Measures areas;
    bool curved;
    shared_ptr<const StraightenedCrack> straightened;       // where the crack crosses or ends in a curved element
    /// The crack that the parts refer to.
    const Crack & CrackInTriangle (const Crack & crack) const { return straightened ? straightened->crack : crack; }
    double S0 () const { return chords.front().s0; }
    double S1 () const { return chords.back().s1; }
  };

  /// An edge of the boundary or of an inner interface that Γ_C crosses, at its mouth or elsewhere.
  /// along: from a (0) to b (1), in the coordinates of the straight edge.
  struct CutBoundaryEdge { size_t element; Point a, b, crossing; double along; };

  enum class EndKind { Tip, Mouth };

  /// An end of Γ_C: a tip (inside the body) or a mouth (on its boundary), and the mesh node that it lies on or in.
  struct CrackEnd { EndKind kind; double s; Point point; ngfem::NodeId node; };

  /// One crack in one mesh. Work is proportional to the number of elements, with a bounding box test each.
  class CrackLocation
  {
    const MeshAccess & mesh;
    const Crack & crack;
    double tolerance;                                // geometric_tolerance × the smallest h_T beside the crack
    std::vector<ElementLocation> elements;           // Cut, Tip and Aligned
    std::map<size_t, size_t> index;                  // element number → position in elements
    std::map<size_t, CutBoundaryEdge> boundary_edges;
    std::set<size_t> aligned_edges;
    std::array<CrackEnd,2> ends;
    /// A chord, and the largest s1 of those up to it, sorted by s0.
    struct Interval { double s0, s1, reach; size_t location; };
    std::vector<Interval> intervals;

  public:
    /// Throws for a crack that leaves the body or lies outside of it, runs along its boundary, or passes twice through one element (but it
    /// may leave a straight one for a moment).
    CrackLocation (const MeshAccess & amesh, const Crack & acrack);

    const std::vector<ElementLocation> & Elements() const { return elements; }
    const ElementLocation * Find (size_t element) const;
    /// The element that carries arc length s, or is nearest to it; of two that meet there the one in which the crack ends.
    const ElementLocation & At (double s) const;
    const std::map<size_t, CutBoundaryEdge> & BoundaryEdges() const { return boundary_edges; }
    /// See CutGeometry.
    bool EndsIn (NodeId node, FlatArray<int> support) const;
    bool RunsAlong (NodeId node) const;
    Side SideBeyond (size_t element, size_t edge) const;
    std::optional<Measures> BoundarySizes (size_t bnd_element) const;
    const std::array<CrackEnd,2> & Ends() const { return ends; }
    double Tolerance() const { return tolerance; }

  private:
    struct Clip { bool aligned; Chord chord; bool starts_inside, ends_inside; PiecePtr straightened; };
    struct Inside { double t0, t1; bool starts, ends; };
    std::vector<Clip> ClipPiece (size_t element, const ElementMap & map, size_t piece) const;
    std::optional<Clip> ClipSegment (const Triangle & t, size_t piece) const;
    std::vector<Inside> RangesInside (const CurvePiece & piece, size_t element, const Triangle & t) const;
    std::vector<Clip> ClipCurve (size_t element, const Triangle & t, size_t piece) const;
    std::vector<Clip> ClipInCurved (size_t element, const ElementMap & map, size_t piece) const;
    void Straighten (ElementLocation & location, const std::vector<PiecePtr> & pieces) const;
    std::vector<size_t> ElementsBeside () const;
    void LocateElement (size_t element, std::map<size_t, std::vector<size_t>> & aligned);
    void SetParts (ElementLocation & location) const;
    void LocateAligned (const std::map<size_t, std::vector<size_t>> & aligned);
    size_t AlignedEdge (size_t element, const Triangle & t, const Chord & chord) const;
    void LocateEnds (const std::vector<size_t> & beside);
    CrackEnd LocateEnd (double s, const std::vector<size_t> & beside);
    void LocateBoundary ();
    void CheckCovered () const;
    void MakeIntervals ();
    bool HasVertex (size_t edge, NodeId node) const;
    void CheckConnected (const ElementLocation & location) const;
    void MarkDegenerate (ElementLocation & location) const;
  };

  /// Throws for a mesh that is not plane or has other elements than triangles.
  void CheckTriangles (const MeshAccess & mesh);
}
