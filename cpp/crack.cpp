#include "crack.hpp"
#include <algorithm>
#include <core/exception.hpp>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  namespace
  {
    bool Cross (Point a, Point b, Point c, Point d)
    {
      // the sign of three points on a line is round-off; segments that touch there are found by their end points
      auto orient = [] (Point p, Point q, Point r)
      {
        double o = ngsxfem_contact::Cross(q-p, r-p);
        return std::abs(o) <= 1e-14*Norm(Point(q-p))*Norm(Point(r-p)) ? 0 : o;
      };
      return orient(a,b,c)*orient(a,b,d) < 0 && orient(c,d,a)*orient(c,d,b) < 0;
    }

    /// The distance of the segments ab and cd, and where: the crossing, or the end that is nearest to the other segment.
    std::pair<double, Point> Approach (Point a, Point b, Point c, Point d)
    {
      if (Cross(a, b, c, d)) return { 0, Lerp(a, b, ngsxfem_contact::Cross(c-a, d-c) / ngsxfem_contact::Cross(b-a, d-c)) };
      std::pair<double, Point> ends[] { { Distance(a,c,d), a }, { Distance(b,c,d), b }, { Distance(c,a,b), c }, { Distance(d,a,b), d } };
      return *std::min_element(std::begin(ends), std::end(ends), [] (auto & p, auto & q) { return p.first < q.first; });
    }

    /// A smaller turn between two pieces, one of them curved, is no kink; nor is one between segments on a line.
    constexpr double smooth_turn = 1e-6, straight_turn = 1e-12;
  }

  Crack :: Crack (std::vector<Point> apoints) : points(std::move(apoints))
  {
    CheckSegments();
    for (size_t i = 0; i+1 < points.size(); i++)
      pieces.push_back(MakeSegment(points[i], points[i+1]));
    Measure();
    CheckSelfContact();
  }

  Crack :: Crack (std::vector<PiecePtr> apieces) : pieces(std::move(apieces))
  {
    if (pieces.empty()) throw Exception("Crack: needs at least one piece; give pieces to Crack.OfPieces, or cracks to Crack.Join");
    points.push_back(pieces[0]->Value(0));
    for (auto & piece : pieces)
      points.push_back(piece->Value(piece->End()));
    CheckSegments();
    CheckContinuous();
    Measure();
    CheckSelfContact();
  }

  void Crack :: Measure ()
  {
    arclength.push_back(0);
    for (size_t i = 0; i < NumSegments(); i++)
      arclength.push_back(arclength[i] + pieces[i]->Length());
    kink.assign(points.size(), false);
    for (size_t i = 1; i < NumSegments(); i++)
      kink[i] = Norm(Point(Tangent(i, arclength[i]) - Tangent(i-1, arclength[i])))
        > (IsStraight(i-1) && IsStraight(i) ? straight_turn : smooth_turn);
    for (auto & piece : pieces)
      {
        constexpr double turn = 0.25;
        auto s = piece->IsStraight() ? std::vector<double> { 0, piece->Length() } : piece->Samples(turn);
        boxes.emplace_back();
        for (size_t i = 0; i+1 < s.size(); i++)
          {
            Point a = piece->PointAt(s[i]), b = piece->PointAt(s[i+1]), lo, hi;
            double sagitta = piece->IsStraight() ? 0 : 0.25*turn*(s[i+1]-s[i]);
            for (int k : { 0, 1 })
              {
                lo(k) = std::min(a(k), b(k)) - sagitta;
                hi(k) = std::max(a(k), b(k)) + sagitta;
              }
            boxes.back().push_back({ lo, hi });
          }
      }
  }

  void Crack :: CheckSegments () const
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
    struct Chord { Point a, b; size_t piece; double sagitta; };
    std::vector<Chord> chords;
    for (size_t i = 0; i < NumSegments(); i++)
      {
        constexpr double turn = 0.02;
        auto s = IsStraight(i) ? std::vector<double> { 0, pieces[i]->Length() } : pieces[i]->Samples(turn);
        for (size_t k = 0; k+1 < s.size(); k++)
          {
            Point a = k == 0 ? points[i] : pieces[i]->PointAt(s[k]), b = k+2 == s.size() ? points[i+1] : pieces[i]->PointAt(s[k+1]);
            chords.push_back({ a, b, i, IsStraight(i) ? 0 : 0.125*turn*(s[k+1]-s[k]) });
          }
      }
    for (size_t i = 0; i < chords.size(); i++)
      for (size_t j = i+1; j < chords.size(); j++)
        {
          auto & c = chords[i], & d = chords[j];
          // neighbours share d.a
          auto [distance, place] = j == i+1 ? std::pair(std::min(Distance(d.b, c.a, c.b), Distance(c.a, d.a, d.b)), d.a)
            : Approach(c.a, c.b, d.a, d.b);
          double sagittas = j == i+1 ? 0 : c.sagitta + d.sagitta;
          if (distance <= geometric_tolerance * Length() + sagittas)
            throw Exception("Crack: segments " + std::to_string(c.piece) + " and " + std::to_string(d.piece) + " meet near "
                            + ToString(place) + "; a crack must not touch or cross itself: split or shorten it");
        }
  }

  Point Crack :: Tangent (size_t i, double s) const
  {
    if (!IsStraight(i)) return pieces[i]->Tangent(s-arclength[i]);
    Point d = points[i+1]-points[i];
    return Point(1/Norm(d) * d);
  }

  size_t Crack :: SegmentAt (double s) const
  {
    size_t i = std::lower_bound(arclength.begin()+1, arclength.end()-1, s) - arclength.begin();
    return i-1;
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

  bool Crack :: MayMeet (size_t i, Point lo, Point hi) const
  {
    for (auto & box : boxes[i])
      if (box.hi(0) >= lo(0) && box.lo(0) <= hi(0) && box.hi(1) >= lo(1) && box.lo(1) <= hi(1)) return true;
    return false;
  }

  double Crack :: DistanceFromBoxes (size_t i, Point p) const
  {
    double distance = std::numeric_limits<double>::infinity();
    for (auto & box : boxes[i])
      {
        auto off = [&] (int k) { return std::max({ box.lo(k)-p(k), p(k)-box.hi(k), 0.0 }); };
        distance = std::min(distance, std::hypot(off(0), off(1)));
      }
    return distance;
  }

  Crack::Projection Crack :: NearestOn (size_t i, Point p) const
  {
    double length = arclength[i+1]-arclength[i], along, clamped, distance;
    if (IsStraight(i))
      {
        along = Dot(Point(p-points[i]), Tangent(i, 0));
        clamped = std::clamp(along, 0.0, length);
        distance = Norm(Point(p - points[i] - clamped*Tangent(i, 0)));
      }
    else
      {
        auto & piece = *pieces[i];
        double t = piece.Nearest(p);
        distance = Norm(Point(p-piece.Value(t)));
        clamped = along = piece.ArcLength(t);
        if (t <= 0) along = Dot(Point(p-piece.Value(0)), piece.Derivative(0));
        if (t >= piece.End()) along = length + Dot(Point(p-piece.Value(t)), piece.Derivative(t));
      }
    return { i, arclength[i]+clamped, distance, (i == 0 && along < 0) || (i+1 == NumSegments() && along > length) };
  }

  Crack::Projection Crack :: Nearest (Point p) const
  {
    Projection best { 0, 0, std::numeric_limits<double>::infinity(), false };
    for (size_t i = 0; i < NumSegments(); i++)
      {
        if (!IsStraight(i) && DistanceFromBoxes(i, p) > best.distance) continue;
        auto here = NearestOn(i, p);
        if (here.distance < best.distance) best = here;
      }
    return best;
  }

  Side Crack :: SideOf (Point p) const
  {
    auto [i, s, distance, beyond] = Nearest(p);
    double d = IsStraight(i) ? LineDistance(i, p) : Dot(Point(p-PointAt(i, s)), Normal(i, s));
    // nearest to a kink: the sum of the two normals decides, whichever segment was found first
    bool at_start = s == arclength[i] && i > 0, at_end = s == arclength[i+1] && i+1 < NumSegments();
    if (!beyond && (at_start || at_end))
      {
        size_t joint = at_start ? i : i+1;
        d = Dot(Point(p-points[joint]), Point(Normal(joint-1, arclength[joint]) + Normal(joint, arclength[joint])));
      }
    return d >= 0 ? Side::Plus : Side::Minus;
  }

  std::vector<Point> Crack :: Outline (double turn) const
  {
    std::vector<Point> outline { points[0] };
    for (size_t i = 0; i < NumSegments(); i++)
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

  std::pair<double, Point> Distance (const Crack & a, const Crack & b)
  {
    std::pair<double, Point> best { std::numeric_limits<double>::infinity(), Point(0,0) };
    auto p = a.Outline(), q = b.Outline();
    for (size_t i = 0; i+1 < p.size(); i++)
      for (size_t j = 0; j+1 < q.size(); j++)
        if (auto here = Approach(p[i], p[i+1], q[j], q[j+1]); here.first < best.first) best = here;
    return best;
  }
}
