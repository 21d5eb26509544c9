#pragma once
// Γ_C: an oriented curve of smooth pieces, its arc length, its normal and the side of a point (docs/method.md, section 1).

#include "curve/box_tree.hpp"

namespace ngsxfem_contact
{
  enum class Side : int { Minus = -1, Plus = 1 };

  class Crack
  {
    std::vector<PiecePtr> pieces;
    std::vector<Point> points;       // the ends of the pieces
    std::vector<double> arclength;   // at the points
    std::vector<bool> kink;          // at the points
    bool closed = false;
    std::string name;                // of the user; empty: none
    BoxTree boxes;                   // of parts of the pieces that are nearly straight
    std::vector<size_t> piece_of;    // by box

  public:
    static constexpr double turn_in_pictures = 0.05;     // of an Outline

    /// A polyline. Throws for fewer than two points, a non-finite coordinate, a segment of zero length, a curve that
    /// meets itself elsewhere than at its two ends.
    explicit Crack (std::vector<Point> apoints);
    /// Throws for pieces that do not continue each other, and for a curve that meets itself.
    explicit Crack (std::vector<PiecePtr> apieces);
    /// A stretch of a crack, which need not be checked again.
    static Crack Unchecked (std::vector<PiecePtr> pieces);

    /// The same curve with another name.
    Crack Named (std::string aname) const;
    const std::string & Name() const { return name; }
    /// In messages: its number in a body, and its name if it has one.
    std::string Label (size_t number) const;

    /// The ends of the pieces: the points of a polyline.
    const std::vector<Point> & Points() const { return points; }
    size_t NumPieces() const { return pieces.size(); }
    const CurvePiece & Piece (size_t i) const { return *pieces[i]; }
    const std::vector<PiecePtr> & Pieces() const { return pieces; }
    double Length() const { return arclength.back(); }
    /// Whether it ends where it starts: no tip, no mouth.
    bool IsClosed() const { return closed; }
    bool IsPolyline() const { return std::ranges::all_of(pieces, [] (auto & piece) { return piece->IsStraight(); }); }
    /// An arc length within the crack but for round-off. Throws for others.
    double Checked (double s) const;
    /// Arc length at the i-th point.
    double ArcLength (size_t i) const { return arclength[i]; }
    /// Whether the direction jumps at the i-th point.
    bool IsKink (size_t i) const { return kink[i]; }

    Point Tangent (size_t piece, double s) const;
    /// To the left of the direction of travel, from the minus to the plus side.
    Point Normal (size_t piece, double s) const { return Left(Tangent(piece, s)); }

    /// The piece that carries arc length s; at an end of two the one that ends there.
    size_t PieceAt (double s) const;
    Point PointAt (double s) const { return PointAt(PieceAt(s), s); }
    Point PointAt (size_t piece, double s) const;
    /// Signed distance of p from the infinite line of a straight piece, positive on the plus side.
    double LineDistance (size_t piece, Point p) const;
    bool IsStraight (size_t piece) const { return pieces[piece]->IsStraight(); }
    /// The pieces that may meet a box, ascending.
    std::vector<size_t> PiecesNear (const Box & box) const;

    /// t: the parameter of the piece.
    struct Projection { size_t piece; double t, distance; bool beyond_end; };
    /// The nearest point of Γ_C.
    Projection Nearest (Point p) const;
    double ArcLength (const Projection & at) const { return arclength[at.piece] + pieces[at.piece]->ArcLength(at.t); }
    Point Tangent (const Projection & at) const;
    /// Side of p with respect to Γ_C and, beyond its ends, to their straight extensions. Plus on Γ_C itself.
    Side SideOf (Point p) const;

    /// A part of a piece that turns by at most `turn` (about), and how far it is from its chord.
    struct Arc { size_t piece; double s0, s1; Point a, b; double sagitta; };
    std::vector<Arc> Arcs (double turn) const;

    /// Points that follow the crack: the ends of the pieces, and of curved ones points between which they turn by `turn`.
    std::vector<Point> Outline (double turn) const;

  private:
    Crack() = default;
    void SetPieces (std::vector<PiecePtr> apieces);
    void CheckPoints() const;
    void CheckContinuous() const;
    void CheckSelfContact() const;
    void Measure();
    void MakeBoxes();
    Projection NearestOn (size_t piece, Point p) const;
  };

}
