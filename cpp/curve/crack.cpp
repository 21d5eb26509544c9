#include "curve/crack.hpp"
#include <algorithm>
#include <core/exception.hpp>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  namespace
  {
    bool AreCrossing (Point a, Point b, Point c, Point d)
    {
      // the sign of three points on a line is round-off; segments that touch there are found by their end points
      auto orient = [] (Point p, Point q, Point r)
      {
        double o = Cross(q-p, r-p);
        return std::abs(o) <= 1e-14*Norm(Point(q-p))*Norm(Point(r-p)) ? 0 : o;
      };
      return orient(a,b,c)*orient(a,b,d) < 0 && orient(c,d,a)*orient(c,d,b) < 0;
    }

    /// The distance of the segments ab and cd, and where: the crossing, or the end that is nearest to the other segment.
    std::pair<double, Point> Approach (Point a, Point b, Point c, Point d)
    {
      if (AreCrossing(a, b, c, d)) return { 0, Lerp(a, b, Cross(c-a, d-c) / Cross(b-a, d-c)) };
      std::pair<double, Point> ends[] { { Distance(a,c,d), a }, { Distance(b,c,d), b }, { Distance(c,a,b), c }, { Distance(d,a,b), d } };
      return *std::min_element(std::begin(ends), std::end(ends), [] (auto & p, auto & q) { return p.first < q.first; });
    }

    /// A smaller turn between two pieces, one of them curved, is no kink; nor is one between segments on a line.
    constexpr double smooth_turn = 1e-6, straight_turn = 1e-12;
  }

  Crack :: Crack (std::vector<Point> apoints) : points(std::move(apoints))
  {
    CheckPoints();
    for (size_t i = 0; i+1 < points.size(); i++)
      pieces.push_back(MakeSegment(points[i], points[i+1]));
    Measure();
    CheckSelfContact();
  }

  Crack :: Crack (std::vector<PiecePtr> apieces)
  {
    if (apieces.empty()) throw Exception("Crack: needs at least one piece; give pieces to Crack.OfPieces, or cracks to Crack.Join");
    SetPieces(std::move(apieces));
    CheckPoints();
    CheckContinuous();
    Measure();
    CheckSelfContact();
  }

  Crack Crack :: Unchecked (std::vector<PiecePtr> pieces)
  {
    Crack crack;
    crack.SetPieces(std::move(pieces));
    crack.Measure();
    return crack;
  }

  Crack Crack :: Named (std::string aname) const
  {
    Crack crack = *this;
    crack.name = std::move(aname);
    return crack;
  }

  std::string Crack :: Label (size_t number) const
  { return std::to_string(number) + (name.empty() ? "" : " '" + name + "'"); }

  void Crack :: SetPieces (std::vector<PiecePtr> apieces)
  {
    pieces = std::move(apieces);
    points.push_back(pieces[0]->Value(0));
    for (auto & piece : pieces)
      points.push_back(piece->Value(piece->End()));
  }

  void Crack :: Measure ()
  {
    arclength.push_back(0);
    for (size_t i = 0; i < NumPieces(); i++)
      arclength.push_back(arclength[i] + pieces[i]->Length());
    closed = Norm(Point(points.back()-points.front())) <= geometric_tolerance*Length();
    kink.assign(points.size(), false);
    for (size_t i = 1; i < NumPieces(); i++)
      kink[i] = Norm(Point(Tangent(i, arclength[i]) - Tangent(i-1, arclength[i])))
        > (IsStraight(i-1) && IsStraight(i) ? straight_turn : smooth_turn);
    MakeBoxes();
  }

  void Crack :: MakeBoxes ()
  {
    std::vector<Box> all;
    for (auto & arc : Arcs(0.25))
      {
        all.push_back(BoxOf(std::array { arc.a, arc.b }).Grown(2*arc.sagitta));
        piece_of.push_back(arc.piece);
      }
    boxes = BoxTree(all);
  }

  std::vector<Crack::Arc> Crack :: Arcs (double turn) const
  {
    std::vector<Arc> arcs;
    for (size_t i = 0; i < NumPieces(); i++)
      {
        auto s = IsStraight(i) ? std::vector<double> { 0, pieces[i]->Length() } : pieces[i]->Samples(turn);
        for (size_t k = 0; k+1 < s.size(); k++)
          {
            Point a = k == 0 ? points[i] : pieces[i]->PointAt(s[k]), b = k+2 == s.size() ? points[i+1] : pieces[i]->PointAt(s[k+1]);
            arcs.push_back({ i, arclength[i]+s[k], arclength[i]+s[k+1], a, b, IsStraight(i) ? 0 : 0.125*turn*(s[k+1]-s[k]) });
          }
      }
    return arcs;
  }

  void Crack :: CheckPoints () const
  {
    if (points.size() < 2)
      throw Exception("Crack: needs at least two points, got " + std::to_string(points.size()));
    for (size_t i = 0; i < points.size(); i++)
      if (!std::isfinite(points[i](0)) || !std::isfinite(points[i](1)))
        throw Exception("Crack: point " + std::to_string(i) + " is " + ToString(points[i]) + "; coordinates must be finite");
    double size = 0;
    for (auto & p : points)
      size = std::max(size, Norm(Point(p-points[0])));
    for (size_t i = 0; i+1 < points.size(); i++)
      if (Norm(Point(points[i+1]-points[i])) <= geometric_tolerance * size)
        throw Exception("Crack: points " + std::to_string(i) + " and " + std::to_string(i+1) + " coincide at "
                        + ToString(points[i]) + "; a segment of zero length has no direction: remove one of them");
  }

  void Crack :: CheckContinuous () const
  {
    double size = 0;
    for (auto & piece : pieces) size += piece->Length();
    for (size_t i = 0; i+1 < pieces.size(); i++)
      if (Point next = pieces[i+1]->Value(0); Norm(Point(points[i+1]-next)) > geometric_tolerance*size)
        throw Exception("Crack: piece " + std::to_string(i) + " ends at " + ToString(points[i+1]) + ", but the next one starts at "
                        + ToString(next) + "; give the pieces in order, end to end");
  }

  /// Curved pieces by their chords, which keep clear of each other by more than their sagittas.
  void Crack :: CheckSelfContact () const
  {
    auto chords = Arcs(0.02);
    std::vector<Box> around;
    for (auto & chord : chords)
      around.push_back(BoxOf(std::array { chord.a, chord.b }).Grown(chord.sagitta + geometric_tolerance*Length()));
    BoxTree tree(around);
    for (size_t i = 0; i < chords.size(); i++)
      tree.VisitMeeting(around[i], [&] (size_t j)
        {
          if (j <= i) return;
          auto & c = chords[i], & d = chords[j];
          // neighbours share d.a, or c.a where the crack is closed
          bool next = j == i+1, around = closed && i == 0 && j+1 == chords.size();
          auto [distance, place] = next ? std::pair(std::min(Distance(d.b, c.a, c.b), Distance(c.a, d.a, d.b)), d.a)
            : around ? std::pair(std::min(Distance(c.b, d.a, d.b), Distance(d.a, c.a, c.b)), c.a)
            : Approach(c.a, c.b, d.a, d.b);
          double sagittas = next || around ? 0 : c.sagitta + d.sagitta;
          if (distance <= geometric_tolerance * Length() + sagittas)
            throw Exception("Crack: pieces " + std::to_string(c.piece) + " and " + std::to_string(d.piece) + " meet near "
                            + ToString(place) + "; a crack must not touch or cross itself: split or shorten it");
        });
  }

  Point Crack :: Tangent (size_t i, double s) const
  { return IsStraight(i) ? pieces[i]->Derivative(0) : pieces[i]->Tangent(s-arclength[i]); }

  Point Crack :: Tangent (const Projection & at) const
  {
    Point d = pieces[at.piece]->Derivative(at.t);
    return IsStraight(at.piece) ? d : Point(1/Norm(d) * d);
  }

  size_t Crack :: PieceAt (double s) const
  {
    size_t i = std::lower_bound(arclength.begin()+1, arclength.end()-1, s) - arclength.begin();
    return i-1;
  }

  double Crack :: Checked (double s) const
  {
    if (!(s >= -1e-10*Length() && s <= (1+1e-10)*Length()))
      throw ngcore::Exception("Crack: arc length " + std::to_string(s) + " is outside of 0 to " + std::to_string(Length()));
    return std::clamp(s, 0.0, Length());
  }

  Point Crack :: PointAt (size_t i, double s) const
  {
    if (!IsStraight(i)) return pieces[i]->PointAt(s-arclength[i]);
    return Point(points[i] + (s-arclength[i]) * Tangent(i, s));
  }

  double Crack :: LineDistance (size_t i, Point p) const
  {
    return Dot(Point(p-points[i]), Normal(i, arclength[i]));
  }

  std::vector<size_t> Crack :: PiecesNear (const Box & box) const
  {
    std::vector<size_t> near;
    boxes.VisitMeeting(box, [&] (size_t i) { near.push_back(piece_of[i]); });
    std::ranges::sort(near);
    near.erase(std::unique(near.begin(), near.end()), near.end());
    return near;
  }

  Crack::Projection Crack :: NearestOn (size_t i, Point p) const
  {
    auto & piece = *pieces[i];
    double t = piece.Nearest(p), end = piece.End();
    Point off = p-piece.Value(t);
    bool before = !closed && i == 0 && t <= 0 && Dot(off, piece.Derivative(t)) < 0;
    bool after = !closed && i+1 == NumPieces() && t >= end && Dot(off, piece.Derivative(t)) > 0;
    return { i, t, Norm(off), before || after };
  }

  Crack::Projection Crack :: Nearest (Point p) const
  {
    Projection best { NumPieces(), 0, std::numeric_limits<double>::infinity(), false };
    double least = best.distance, round_off = 1e-12*Length();
    boxes.VisitNear(p, least, [&] (size_t box)
    {
      size_t i = piece_of[box];
      if (i != best.piece)
        if (auto here = NearestOn(i, p); here.distance < best.distance || (here.distance == best.distance && i < best.piece)) best = here;
      return best.distance + round_off;
    });
    return best;
  }

  Side Crack :: SideOf (Point p) const
  {
    auto at = Nearest(p);
    size_t i = at.piece;
    double d = IsStraight(i) ? LineDistance(i, p) : Cross(Tangent(at), Point(p-pieces[i]->Value(at.t)));
    // nearest to a kink: the sum of the two normals decides, whichever piece was found first
    bool at_start = at.t <= 0 && (i > 0 || closed), at_end = at.t >= pieces[i]->End() && (i+1 < NumPieces() || closed);
    if (!at.beyond_end && (at_start || at_end))
      {
        size_t after = at_start ? i : (i+1) % NumPieces(), before = at_start ? (i+NumPieces()-1) % NumPieces() : i;
        d = Dot(Point(p-points[after]), Point(Normal(before, arclength[before+1]) + Normal(after, arclength[after])));
      }
    return d >= 0 ? Side::Plus : Side::Minus;
  }

  std::vector<Point> Crack :: Outline (double turn) const
  {
    std::vector<Point> outline { points[0] };
    for (size_t i = 0; i < NumPieces(); i++)
      {
        if (!IsStraight(i))
          {
            auto s = pieces[i]->Samples(turn);
            for (size_t k = 1; k+1 < s.size(); k++) outline.push_back(pieces[i]->PointAt(s[k]));
          }
        outline.push_back(points[i+1]);
      }
    return outline;
  }
}
