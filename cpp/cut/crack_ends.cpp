#include "cut/crack_ends.hpp"
#include <algorithm>
#include <core/exception.hpp>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  namespace
  {
    /// Where a crack starts or ends: a parameter of one of its pieces, perhaps a little beyond its end.
    struct Cut { size_t piece; double t; };

    class CrackEnds
    {
      const Crack & crack;
      const BodyBoundary & boundary;
      std::string name;
      std::vector<std::string> & notes;
      double short_part;                    // of a crack, too short to be told from a point

    public:
      CrackEnds (const Crack & acrack, size_t number, const BodyBoundary & aboundary, std::vector<std::string> & anotes)
        : crack(acrack), boundary(aboundary), name("crack " + acrack.Label(number)), notes(anotes), short_part(1e-7*boundary.SmallestElement()) { }

      Crack Fitted () const
      {
        auto inside = StretchInside();
        Cut cuts[2];
        for (int end : { 0, 1 }) cuts[end] = FittedEnd(end, inside[end]);
        std::vector<PiecePtr> pieces;
        for (size_t i = cuts[0].piece; i <= cuts[1].piece; i++)
          {
            auto & piece = crack.Piece(i);
            double t0 = i == cuts[0].piece ? cuts[0].t : 0, t1 = i == cuts[1].piece ? cuts[1].t : piece.End();
            pieces.push_back(t0 == 0 && t1 == piece.End() ? crack.Pieces()[i] : piece.Between(t0, t1));
          }
        return IsWhole(cuts) ? crack : Crack(pieces).Named(crack.Name());
      }

    private:
      using Meeting = BodyBoundary::Meeting;
      /// Between two meetings with ∂Ω, or an end of the crack.
      struct Stretch { double s0, s1; std::optional<Meeting> from, to; bool inside; };

      bool IsWhole (const Cut (&cuts)[2]) const
      { return cuts[0].piece == 0 && cuts[0].t == 0 && cuts[1].piece+1 == crack.NumPieces() && cuts[1].t == crack.Piece(cuts[1].piece).End(); }

      double ArcLength (const Meeting & m) const { return crack.ArcLength(m.piece) + crack.Piece(m.piece).ArcLength(m.t); }

      std::vector<Stretch> Stretches () const
      {
        auto meetings = boundary.Meetings(crack);
        std::sort(meetings.begin(), meetings.end(), [&] (auto & a, auto & b) { return ArcLength(a) < ArcLength(b); });
        std::vector<Stretch> stretches;
        Stretch next { 0, 0, std::nullopt, std::nullopt, false };
        auto append = [&] (double s, std::optional<Meeting> to)
        {
          next.s1 = s;
          next.to = to;
          Point middle = crack.PointAt(0.5*(next.s0+next.s1));
          next.inside = boundary.Contains(middle) || boundary.Nearest(middle).distance <= boundary.Tolerance();
          if (next.s1-next.s0 > short_part) stretches.push_back(next);
          next = { s, s, to, std::nullopt, false };
        };
        for (auto & m : meetings) append(ArcLength(m), m);
        append(crack.Length(), std::nullopt);
        return stretches;
      }

      /// The meetings at the start and the end of the part in the body; none where an end of the crack is inside.
      std::array<std::optional<Meeting>,2> StretchInside () const
      {
        auto stretches = Stretches();
        std::erase_if(stretches, [] (auto & stretch) { return !stretch.inside; });
        if (stretches.empty())
          throw Exception("CrackedMesh: the crack from " + ToString(crack.Points().front()) + " to " + ToString(crack.Points().back())
                          + " lies outside the body; give its points in the mesh's coordinates");
        for (size_t i = 1; i < stretches.size(); i++)
          if (stretches[i].s0-stretches[i-1].s1 > short_part)
            throw Exception("CrackedMesh: " + name + " leaves the body at " + ToString(crack.PointAt(stretches[i-1].s1)) + " and enters it again at "
                            + ToString(crack.PointAt(stretches[i].s0)) + "; give two cracks, one that ends there and one that starts there");
          else
            throw Exception("CrackedMesh: " + name + " touches the boundary of the body at " + ToString(crack.PointAt(stretches[i].s0))
                            + " on its way; move it off the boundary, or give two cracks with different mouths");
        return { stretches.front().from, stretches.front().to };
      }

      Point EndPoint (int end) const { return end ? crack.Points().back() : crack.Points().front(); }
      std::string EndName (int end) const { return name + ": its " + (end ? "end " : "start ") + ToString(EndPoint(end)); }
      Cut GivenEnd (int end) const
      {
        size_t piece = end ? crack.NumPieces()-1 : 0;
        return { piece, end ? crack.Piece(piece).End() : 0 };
      }

      Cut FittedEnd (int end, std::optional<Meeting> meeting) const
      {
        auto place = boundary.Nearest(EndPoint(end));
        if (place.distance <= boundary.Tolerance() && !(meeting && IsBehind(end, *meeting))) return GivenEnd(end);
        if (meeting) return CutOff(end, *meeting);
        if (place.distance >= least_end_distance*place.h) return GivenEnd(end);
        return Extended(end, place);
      }

      /// Whether the crack leaves the body between an end and a point where it meets ∂Ω.
      bool IsBehind (int end, const Meeting & meeting) const
      {
        auto & piece = crack.Piece(meeting.piece);
        return std::abs(crack.ArcLength(meeting.piece)+piece.ArcLength(meeting.t) - (end ? crack.Length() : 0)) > short_part;
      }

      Cut CutOff (int end, const Meeting & meeting) const
      {
        Cut cut { meeting.piece, meeting.t };
        auto & piece = crack.Piece(cut.piece);
        double passed = piece.ArcLength(cut.t);
        // at a joint of two pieces the one that is left begins or ends there
        if (end && passed < short_part && cut.piece > 0) cut = OnNeighbour(meeting, cut.piece-1, crack.Piece(cut.piece-1).End());
        else if (!end && piece.Length()-passed < short_part && cut.piece+1 < crack.NumPieces()) cut = OnNeighbour(meeting, cut.piece+1, 0);
        notes.push_back(EndName(end) + " lies outside of the body; it is cut off at the boundary, at " + ToString(crack.Piece(cut.piece).Value(cut.t)));
        return cut;
      }

      Cut OnNeighbour (const Meeting & meeting, size_t piece, double t) const
      {
        auto & curve = crack.Piece(piece);
        auto along = boundary.Nearest(curve.Value(t)).along;
        return { piece, boundary.Meet(curve, t, meeting.edge, along).value_or(t) };
      }

      Cut Extended (int end, const BodyBoundary::Place & place) const
      {
        auto [piece, t] = GivenEnd(end);
        auto & curve = crack.Piece(piece);
        double s = end ? crack.Length() : 0, limit = 2*least_end_distance*place.h;
        Point ahead = (end ? 1 : -1)*crack.Tangent(piece, s);
        if (auto hit = boundary.Shoot(EndPoint(end), ahead, -1e-3*place.h, limit))
          {
            double guess = t + (end ? 1 : -1)*hit->tau/Norm(curve.Derivative(t));
            if (auto met = boundary.Meet(curve, guess, hit->edge, hit->along); met && Norm(Point(curve.Value(*met)-EndPoint(end))) <= limit)
              {
                notes.push_back(EndName(end) + " is " + Digits(place.distance) + " from the boundary, less than a tenth of the element there ("
                                + Digits(place.h) + "); it ends on the boundary, at " + ToString(curve.Value(*met))
                                + ". For a tip there refine to elements below " + Digits(place.distance/least_end_distance));
                return { piece, *met };
              }
          }
        throw Exception("CrackedMesh: " + EndName(end) + " is " + Digits(place.distance) + " from the boundary, less than a tenth of the element there ("
                        + Digits(place.h) + "), which no tip can be, and does not run into it; either end the crack on the boundary, at "
                        + ToString(place.point) + ", or refine there to elements below " + Digits(place.distance/least_end_distance));
      }
    };
  }

  Crack FittedToBody (const Crack & crack, size_t number, const BodyBoundary & boundary, std::vector<std::string> & notes)
  { return CrackEnds(crack, number, boundary, notes).Fitted(); }
}
