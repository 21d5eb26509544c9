#include "cut/crack_meetings.hpp"
#include "cut/crack_ends.hpp"
#include <algorithm>
#include <core/exception.hpp>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  namespace
  {
    using Arc = Crack::Arc;

    /// The arc lengths at which two cracks meet.
    struct Meeting { double s, t; };

    class PairOfCracks
    {
      const Crack & a, & b;
      double tolerance;

    public:
      std::vector<Meeting> meetings;
      std::string conflict;                        // what else they do, and where

      PairOfCracks (const Crack & aa, const Crack & ab, double atolerance) : a(aa), b(ab), tolerance(atolerance)
      {
        constexpr double turn = 0.02;
        auto of_a = a.Arcs(turn), of_b = b.Arcs(turn);
        std::vector<Box> boxes;
        for (auto & arc : of_b) boxes.push_back(BoxOf(std::array { arc.a, arc.b }).Grown(2*arc.sagitta + 2*tolerance));
        BoxTree tree(boxes);
        for (auto & arc : of_a)
          tree.VisitMeeting(BoxOf(std::array { arc.a, arc.b }).Grown(2*arc.sagitta + 2*tolerance), [&] (size_t j) { Meet(arc, of_b[j]); });
      }

    private:
      void Add (double s, double t)
      {
        auto snapped = [&] (double at, double length) { return at <= 2*tolerance ? 0 : at >= length-2*tolerance ? length : at; };
        Meeting meeting { snapped(s, a.Length()), snapped(t, b.Length()) };
        for (auto & known : meetings)
          if (std::abs(known.s-meeting.s) <= 4*tolerance && std::abs(known.t-meeting.t) <= 4*tolerance) return;
        meetings.push_back(meeting);
      }

      /// Ends of arcs on the other one, then a crossing.
      void Meet (const Arc & x, const Arc & y)
      {
        std::vector<double> shared;
        auto touch = [&] (Point p, const Crack & other)
        {
          auto nearest = other.Nearest(p);
          return nearest.distance <= 2*tolerance ? std::optional(other.ArcLength(nearest)) : std::nullopt;
        };
        for (auto [p, s] : { std::pair(x.a, x.s0), std::pair(x.b, x.s1) })
          if (auto t = touch(p, b); t && *t >= y.s0-2*tolerance && *t <= y.s1+2*tolerance) { Add(s, *t); shared.push_back(s); }
        for (auto [p, t] : { std::pair(y.a, y.s0), std::pair(y.b, y.s1) })
          if (auto s = touch(p, a); s && *s >= x.s0-2*tolerance && *s <= x.s1+2*tolerance) { Add(*s, t); shared.push_back(*s); }
        if (shared.size() > 1)
          if (auto [from, to] = std::ranges::minmax(shared); to-from > 100*tolerance) CheckApart(x, 0.5*(from+to));
        if (shared.empty()) Cross(x, y);
      }

      /// Arcs that meet at two points may share what lies between.
      void CheckApart (const Arc & x, double s)
      {
        Point p = a.PointAt(x.piece, s);
        if (auto nearest = b.Nearest(p); nearest.distance <= 2*tolerance) conflict = "coincide near " + ToString(p) + "; give what they share once";
      }

      /// Newton's method for a(s) = b(t).
      void Cross (const Arc & x, const Arc & y)
      {
        double s = 0.5*(x.s0+x.s1), t = 0.5*(y.s0+y.s1), reach = std::max(x.s1-x.s0, y.s1-y.s0);
        for (int it = 0; it < 30; it++)
          {
            Point r = PointNear(a, x, s)-PointNear(b, y, t), u = Unit(a.Tangent(x.piece, std::clamp(s, x.s0, x.s1))), v = Unit(b.Tangent(y.piece, std::clamp(t, y.s0, y.s1)));
            double det = ngsxfem_contact::Cross(u, v);
            if (std::abs(det) < 1e-9) return CheckTouching(x, y);
            double ds = -ngsxfem_contact::Cross(r, v)/det, dt = -ngsxfem_contact::Cross(r, u)/det;
            s += ds;
            t += dt;
            if (std::abs(s-x.s0) > 10*reach || std::abs(t-y.s0) > 10*reach) return;
            if (std::abs(ds)+std::abs(dt) <= 1e-15*(a.Length()+b.Length()) || it == 29) break;
          }
        bool inside = s >= x.s0-tolerance && s <= x.s1+tolerance && t >= y.s0-tolerance && t <= y.s1+tolerance;
        if (inside && Norm(Point(PointNear(a, x, s)-PointNear(b, y, t))) <= tolerance) Add(s, t);
      }

      void CheckTouching (const Arc & x, const Arc & y)
      {
        if (x.sagitta == 0 && y.sagitta == 0) return;                // parallel
        for (int i = 0; i <= 64; i++)
          {
            Point p = a.PointAt(x.piece, x.s0 + i/64.*(x.s1-x.s0));
            if (b.Nearest(p).distance <= 2*tolerance) conflict = "touch near " + ToString(p) + " without crossing; separate them, or let them cross";
          }
      }

      static Point Unit (Point d) { return Point(1/Norm(d) * d); }
      /// Straight on beyond the ends of an arc.
      static Point PointNear (const Crack & crack, const Arc & arc, double s)
      {
        double inside = std::clamp(s, arc.s0, arc.s1);
        return Point(crack.PointAt(arc.piece, inside) + (s-inside)*Unit(crack.Tangent(arc.piece, inside)));
      }
    };

    /// The longest edge of the element at a point; 0 outside of the mesh.
    double SizeAt (const MeshAccess & mesh, Point p)
    {
      for (size_t element = 0; element < mesh.GetNE(ngfem::VOL); element++)
        {
          auto t = VerticesOf(mesh, element);
          auto side = [&] (int i) { return Cross(Point(t[(i+1)%3]-t[i]), Point(p-t[i])) >= 0; };
          if (side(0) == side(1) && side(1) == side(2)) return LongestEdge(t);
        }
      return 0;
    }

    class EndOfCrack
    {
      const std::vector<Crack> & cracks;
      size_t number;
      bool at_end;
      double h, tolerance;

    public:
      EndOfCrack (const std::vector<Crack> & acracks, size_t anumber, bool aat_end, double ah, double atolerance)
        : cracks(acracks), number(anumber), at_end(aat_end), h(ah), tolerance(atolerance) { }

      /// The crack with its end on another one, if it nearly was there.
      std::optional<Crack> Fitted () const
      {
        auto & crack = cracks[number];
        double reach = 2*least_end_distance*h;
        auto & piece = crack.Piece(Piece());
        double speed = Norm(piece.Derivative(at_end ? piece.End() : 0));
        auto extended = Replaced(at_end ? piece.Between(0, piece.End()+reach/speed) : piece.Between(-reach/speed, piece.End()));
        double end = at_end ? extended.Length()-ExtraLength(extended) : ExtraLength(extended), best = std::numeric_limits<double>::infinity();
        for (size_t other = 0; other < cracks.size(); other++)
          {
            auto nearest = cracks[other].Nearest(EndPoint());
            if (other == number || nearest.distance >= least_end_distance*h) continue;
            if (nearest.distance <= tolerance) return std::nullopt;
            PairOfCracks both(extended, cracks[other], tolerance);
            if (both.conflict.size()) continue;
            for (auto [s, t] : both.meetings)
              if (bool beyond = at_end ? s > end : s < end; std::abs(s-end) < std::abs(best-end) && std::abs(s-end) <= (beyond ? reach : least_end_distance*h)) best = s;
          }
        if (!(best < std::numeric_limits<double>::infinity())) return std::nullopt;
        return Cut(extended, best);
      }

      Point EndPoint () const { return at_end ? cracks[number].Points().back() : cracks[number].Points().front(); }

    private:
      size_t Piece () const { return at_end ? cracks[number].NumPieces()-1 : 0; }
      double ExtraLength (const Crack & extended) const { return extended.Length()-cracks[number].Length(); }

      Crack Replaced (PiecePtr piece) const
      {
        auto pieces = cracks[number].Pieces();
        pieces[Piece()] = piece;
        return Crack::Unchecked(pieces).Named(cracks[number].Name());
      }

      /// Up to, or from an arc length.
      Crack Cut (const Crack & extended, double s) const
      {
        size_t last = extended.PieceAt(s);
        double t = extended.Piece(last).Parameter(s-extended.ArcLength(last));
        auto pieces = extended.Pieces();
        pieces[last] = at_end ? pieces[last]->Between(0, t) : pieces[last]->Between(t, pieces[last]->End());
        if (at_end) pieces.resize(last+1);
        else pieces.erase(pieces.begin(), pieces.begin()+last);
        return Crack(pieces).Named(extended.Name());
      }
    };
  }

  void FitToEachOther (std::vector<Crack> & cracks, const MeshAccess & mesh, const BodyBoundary & boundary, std::vector<std::string> & notes)
  {
    if (cracks.size() < 2) return;
    for (size_t c = 0; c < cracks.size(); c++)
      for (bool at_end : { false, true })
        {
          if (cracks[c].IsClosed()) continue;
          Point given = at_end ? cracks[c].Points().back() : cracks[c].Points().front();
          if (boundary.Nearest(given).distance <= boundary.Tolerance()) continue;
          double h = SizeAt(mesh, given);
          auto fitted = EndOfCrack(cracks, c, at_end, h, boundary.Tolerance()).Fitted();
          if (!fitted) continue;
          cracks[c] = *fitted;
          Point now = at_end ? fitted->Points().back() : fitted->Points().front();
          notes.push_back("crack " + fitted->Label(c) + ": its " + (at_end ? "end " : "start ") + ToString(given) + " is nearer to another crack than a tenth of the element there ("
                          + Digits(h) + "); it ends on that crack, at " + ToString(now));
        }
  }

  std::vector<std::vector<double>> AllMeetings (const std::vector<Crack> & cracks, double tolerance)
  {
    std::vector<std::vector<double>> meetings(cracks.size());
    for (size_t c = 0; c < cracks.size(); c++)
      for (size_t d = c+1; d < cracks.size(); d++)
        {
          PairOfCracks both(cracks[c], cracks[d], tolerance);
          if (both.conflict.size())
            throw Exception("CrackedMesh: cracks " + cracks[c].Label(c) + " and " + cracks[d].Label(d) + " " + both.conflict);
          for (auto [s, t] : both.meetings)
            {
              meetings[c].push_back(s);
              meetings[d].push_back(t);
            }
        }
    for (auto & some : meetings)
      {
        std::ranges::sort(some);
        some.erase(std::unique(some.begin(), some.end(), [&] (double s, double t) { return t-s <= 4*tolerance; }), some.end());
      }
    return meetings;
  }
}
