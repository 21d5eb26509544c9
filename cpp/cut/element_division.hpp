#pragma once
// The parts into which cracks divide an element: what is left of it is connected in each of them.
//
// A tree of lines divides the element into convex cells that no crack enters, or that one crack crosses once. Along each
// line the cells on both sides are compared: they belong to one part where no crack lies between them, and where one does,
// there is a facet of Γ_C between two parts. So sides follow from what is connected, for any number of cracks that cross,
// end on each other, kink or come back.

#include "cut/forest.hpp"
#include "cut/part_triangle.hpp"
#include <memory>
#include <optional>

namespace ngsxfem_contact
{
  using std::shared_ptr;

  /// A chord of the crack with this number. curve: the crack in the coordinates of the division, where the chord is `here`; of a straight
  /// element both are the crack's own.
  struct ElementChord
  {
    size_t crack;
    const Crack * curve;
    Chord here;
    bool starts_at_tip, ends_at_tip;         // inside of the element
    bool meets_before;                       // whether another crack meets this one where the chord starts
  };

  class ElementDivision
  {
  public:
    /// A stretch of a chord (its number) between two parts: those on the plus and on the minus side, the same one beside a tip.
    struct Facet { size_t chord; double s0, s1; size_t plus, minus; };
    /// From t0 to t1 times the way from one point to another.
    struct Interval { double t0, t1; size_t part; };

    /// A convex polygon, counter-clockwise. Throws for stretches of cracks that coincide, and for curves that cannot be told apart.
    ElementDivision (const Polygon & polygon, std::vector<ElementChord> chords, double atolerance);

    size_t NumParts () const { return areas.size(); }
    const std::vector<double> & Areas () const { return areas; }
    const std::vector<PartTriangle> & Triangles () const { return triangles; }
    /// Chord by chord, in the order of arc length.
    const std::vector<Facet> & Facets () const { return facets; }
    size_t PartAt (Point p) const;
    /// The parts along a segment on the boundary of the polygon.
    std::vector<Interval> Along (Point a, Point b) const;

  private:
    /// Of a chord, or of the straight line on which it goes on beyond a tip to the end of the cell.
    struct Stretch
    {
      size_t chord;
      bool real;                             // otherwise beyond a tip
      double s0, s1;
      Point a, b, direction;                 // of unit length, of a straight one
    };
    using Stretches = std::vector<Stretch>;
    /// Consecutive stretches of one crack, and what they enclose.
    struct Run
    {
      Stretches stretches;
      Polygon hull;
      double margin;                         // how far the curve may leave the hull
      double Length () const;
      /// +1, -1, or 0 if the line meets the run; it may end on the line.
      int SideOf (const Line & line, double tolerance) const;
      Point Start () const { return stretches.front().a; }
      Point End () const { return stretches.back().b; }
    };
    /// A leaf is a cell: a convex polygon without a crack, or what lies on one side of a crossing. A crossing has two leaves, plus first.
    struct Node
    {
      enum { Leaf, Divided, Crossed } kind;
      size_t leaf;
      Line line;
      std::array<size_t,2> child;            // on the positive and the negative side; none: no_node
      shared_ptr<const Crack> crossing;
    };
    static constexpr size_t no_node = size_t(-1);
    struct Passage { double t0, t1; size_t leaf; };

    Polygon corners;                         // of the whole polygon
    std::vector<ElementChord> chords;
    double tolerance;                        // lengths below are none, nor are distances of corners from a line: there neighbours agree
    double round_off;                        // distances of other points from a line below are none: smaller, so that tiny cells keep their shape
    std::vector<Node> nodes;
    Forest cells;                            // by leaf: which belong to one part
    std::vector<size_t> part_of;             // by leaf
    std::vector<PartTriangle> triangles;
    std::vector<Facet> facets;
    std::vector<double> areas;

    const Crack & CurveOf (const Stretch & stretch) const { return *chords[stretch.chord].curve; }
    size_t PieceOf (const Stretch & stretch) const { return chords[stretch.chord].here.piece; }
    bool IsStraight (const Stretch & stretch) const { return !stretch.real || CurveOf(stretch).IsStraight(PieceOf(stretch)); }
    double DistanceFrom (const Line & line, Point p) const;
    Point Direction (const Stretch & stretch, double s) const;
    Stretch Part (const Stretch & stretch, double s0, double s1) const;
    std::optional<Stretch> Beyond (const Stretch & stretch, bool at_end, const Polygon & polygon) const;
    Stretches Extended (const Stretches & stretches, const Polygon & polygon) const;
    bool AreStraight (const Stretches & stretches) const;
    size_t Build (const Polygon & polygon, const Stretches & stretches, int depth);
    size_t BuildStraight (const Polygon & polygon, const Stretches & stretches);
    size_t MakeLeaf (const Polygon & polygon);
    std::optional<size_t> MakeCrossing (const Polygon & polygon, const Stretches & stretches);
    template <typename F>
    size_t Divide (const Polygon & polygon, const Stretches & stretches, const Line & line, F && build);
    std::array<Stretches,3> Sort (const Stretches & stretches, const Line & line) const;
    Line LineThrough (const Stretches & stretches) const;
    std::optional<Line> LineBetween (const std::vector<Run> & runs) const;
    std::optional<Line> LineBetween (const Run & a, const Run & b) const;
    Line LineAcross (const Run & run) const;
    Run MakeRun (const Stretches & stretches) const;
    std::vector<Run> RunsOf (const Stretches & stretches) const;
    void Compare (size_t node, const Polygon & polygon, const std::vector<double> & d, const Stretches & on);
    void Follow (size_t node, Point p, Point q, double t0, double t1, std::vector<Passage> & passages) const;
    void FollowCrossing (const Node & node, Point p, Point q, double t0, double t1, std::vector<Passage> & passages) const;
    void NumberParts ();
    void JoinFacets ();
  };
}
