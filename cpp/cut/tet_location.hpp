#pragma once
// Where the tetrahedra of a mesh lie with respect to one sheet. Decided once for each vertex (its side) and once for each edge (the point in which the
// plane cuts it), so that neighbours agree:
//
//   corners on the plane   the others            kind
//   any                    on both sides         cut by a polygon: a triangle (1:3, or with corners on the plane) or a quadrilateral (2:2)
//   3                      on one side           the face lies on the plane: one of its two tetrahedra carries it
//   0, 1, 2                on one side           not cut
//
// The open polygon against the curves that bound the sheet: inside → Cut or Aligned, outside → Uncut, entered by one of them → Tip.

#include "cut/cut_geometry.hpp"
#include "cut/element_division.hpp"
#include "cut/front.hpp"
#include "cut/tet_division.hpp"
#include <map>
#include <set>

namespace ngsxfem_contact
{
  /// A vertex of the mesh on the plane (twice), or the point between two on different sides.
  using TraceNode = std::array<size_t,2>;
  using TraceSegment = std::array<TraceNode,2>;

  /// A stretch of a curve of a sheet.
  struct LoopChord { size_t loop; Chord chord; };

  /// A polygon in which the plane cuts a tetrahedron, or a face on the plane.
  struct SheetCell
  {
    size_t element;
    std::optional<size_t> neighbour;             // across a face on the plane, which the element carries for both
    ElementKind kind;                            // Cut, Tip or Aligned
    std::array<size_t,4> corners;                // 0 to 3 in the order of the vertices' numbers
    Tet tet, in_space;                           // in this order; tet: in flat coordinates (Sheet::Flat)
    std::array<double,4> heights;                // over the plane, 0 on it
    Polygon polygon;                             // in the plane, counter-clockwise
    std::vector<TraceNode> nodes;                // its corners
    std::vector<LoopChord> chords;               // in it, of a Tip
  };

  class SheetLocation
  {
    const MeshAccess & mesh;
    const Sheet & sheet;
    size_t number;
    std::vector<double> kinks;                   // values of p₂
    double tolerance;                            // in the plane: geometric_tolerance × the shortest edge of ElementsBeside
    std::map<size_t, double> height;             // by vertex, 0 on the plane
    std::map<size_t, Point3> flat;               // points by vertex
    std::map<TraceNode, Point> places;
    std::vector<SheetCell> cells;
    std::set<TraceSegment> segments;
    std::map<TraceSegment, Point3> boundary;     // those on ∂Ω, with its normal in space
    std::vector<Front> fronts;
    std::set<size_t> front_elements;

    using Ranges = std::vector<std::pair<double,double>>;
    std::vector<Ranges> inside_body;             // arc lengths of each loop between which it is in the closed body
    std::vector<Ranges> on_boundary;             // and along ∂Ω

  public:
    /// Throws for a sheet that lies outside of the body or inside of one element, that runs along ∂Ω, or whose front meets it at less than 20°.
    SheetLocation (const MeshAccess & amesh, const Sheet & asheet, size_t anumber);

    const std::vector<SheetCell> & Cells () const { return cells; }
    const std::vector<Front> & Fronts () const { return fronts; }
    /// The elements whose closure holds a stretch of a front.
    const std::set<size_t> & FrontElements () const { return front_elements; }
    double HeightOf (size_t vertex) const { return height.at(vertex); }

  private:
    void FindHeights (const std::vector<size_t> & beside);
    void LocateElement (size_t element);
    bool IsBent (const SheetCell & cell) const;
    bool IsNear (const SheetCell & cell) const;
    double HeightAt (Point3 x) const;
    void LocateInsideKink (const SheetCell & cell, const std::vector<CutCorner> & corners);
    void AddEdges (const SheetCell & cell, const std::vector<CutCorner> & corners);
    std::optional<size_t> Across (const SheetCell & cell, const std::vector<CutCorner> & on_plane) const;
    /// Whether a face on the plane parts the element from its neighbour, and which of the two carries it.
    enum class FaceOnPlane { Here, There, Nowhere };
    FaceOnPlane Carrier (const SheetCell & cell, double height) const;
    void CheckKinks (const Front & front) const;
    void AddCell (SheetCell cell, const std::vector<CutCorner> & corners);
    void AddSegment (size_t element, TraceNode a, TraceNode b);
    void MeetLoops (SheetCell & cell);
    void FollowSegments ();
    void FollowSegment (const TraceSegment & segment);
    void MakeFronts ();
    void CheckEnd (const Front & front, bool at_end) const;
    [[noreturn]] void Refuse (const string & what, Point3 where) const;
    TraceNode NodeOf (const SheetCell & cell, const CutCorner & corner) const;
    std::vector<size_t> ElementsOf (const TraceSegment & segment) const;
  };

  /// Elements that a sheet may meet: by a box around it, and the heights of their corners.
  std::vector<size_t> ElementsBeside (const MeshAccess & mesh, const Sheet & sheet);
}
