#pragma once
// Where each element lies with respect to one crack.

#include "cut/cut_geometry.hpp"
#include "cut/element_division.hpp"
#include "cut/element_map.hpp"
#include <deque>
#include <map>
#include <set>

namespace ngsxfem_contact
{
  /// The special positions. A position that holds to within geometric_tolerance counts as exact.
  struct Degeneracy { bool through_vertex = false, along_edge = false, tip_on_edge = false, tip_on_vertex = false, kink_inside = false; };

  /// A chord in a curved element, in the coordinates of its straight triangle (ElementMap), there on a crack of its own.
  struct StraightenedChord { shared_ptr<const Crack> crack; Chord chord; };

  struct ElementLocation
  {
    size_t element;
    ElementKind kind;
    Degeneracy degeneracy;
    Triangle triangle;
    double h;                       // longest edge
    std::vector<Chord> chords;      // in the order of arc length; the crack may leave T between two of them
    bool curved;
    std::vector<StraightenedChord> straightened;       // the same chords, of a curved element
    double S0 () const { return chords.front().s0; }
    double S1 () const { return chords.back().s1; }
  };

  /// An edge of the boundary or of an inner interface that Γ_C crosses, at its mouth or elsewhere.
  /// along: from a (0) to b (1), in the coordinates of the straight edge.
  struct CutBoundaryEdge { size_t element; Point a, b, crossing; double along; };

  enum class EndKind { Tip, Mouth, Junction };

  /// An end of a crack: a tip (inside the body), a mouth (on its boundary) or a junction (on another crack, or where a closed crack starts), and
  /// the mesh node that it lies on or in.
  struct CrackEnd { EndKind kind; double s; Point point; ngfem::NodeId node; };

  /// One crack in one mesh. Work is proportional to the number of elements, with a bounding box test each.
  class CrackLocation
  {
    const MeshAccess & mesh;
    const Crack & crack;
    std::vector<double> meetings;                    // arc lengths at which it meets others
    double tolerance;                                // geometric_tolerance × the smallest h_T beside the crack
    std::deque<ElementLocation> elements;            // Cut, Tip and Aligned
    std::map<size_t, size_t> index;                  // element number → position in elements
    std::multimap<size_t, CutBoundaryEdge> boundary_edges;
    std::map<size_t, std::vector<Chord>> aligned_edges;
    std::array<CrackEnd,2> ends;
    /// A chord, and the largest s1 of those up to it, sorted by s0.
    struct Interval { double s0, s1, reach; size_t location; };
    std::vector<Interval> intervals;

  public:
    /// ameetings: the arc lengths at which the crack meets others; chords end there.
    /// Throws for a crack that leaves the body or lies outside of it, or runs along its boundary.
    CrackLocation (const MeshAccess & amesh, const Crack & acrack, std::vector<double> ameetings);

    const std::deque<ElementLocation> & Elements() const { return elements; }
    /// The element that carries arc length s, or is nearest to it; of two that meet there the one in which the crack ends.
    const ElementLocation & At (double s) const;
    const std::multimap<size_t, CutBoundaryEdge> & BoundaryEdges() const { return boundary_edges; }
    /// The edges along which the crack runs, with the chords on them.
    const std::map<size_t, std::vector<Chord>> & AlignedEdges() const { return aligned_edges; }
    /// One of the two elements beside such an edge carries the crack for both.
    void Align (size_t edge, size_t element);
    /// To be called when all such edges have an element. Throws for a crack of which a part is in no element.
    void Complete ();
    /// What divides an element, if this is the crack with a number. To be asked for before Align.
    std::vector<ElementChord> DividingChords (const ElementLocation & location, size_t number) const;
    const std::vector<double> & Meetings() const { return meetings; }
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
    void DivideAtMeetings (ElementLocation & location) const;
    void LocateElement (size_t element);
    size_t AlignedEdge (size_t element, const Triangle & t, const Chord & chord) const;
    CrackEnd LocateEnd (double s, const std::vector<size_t> & beside) const;
    bool IsMeeting (double s) const;
    void LocateBoundary ();
    void AddBoundaryEdge (const CutBoundaryEdge & edge);
    void CheckCovered () const;
    void MakeIntervals ();
    void MarkDegenerate (ElementLocation & location) const;
  };

  /// The elements of a mesh that a crack may meet, by boxes around both.
  std::vector<size_t> ElementsBeside (const MeshAccess & mesh, const Crack & crack);
  /// Throws for a mesh that is not plane or has other elements than triangles.
  void CheckTriangles (const MeshAccess & mesh);
}
