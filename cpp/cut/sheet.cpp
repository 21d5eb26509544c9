#include "cut/sheet.hpp"
#include "cut/crack_meetings.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  namespace
  {
    /// ½ ∮ x × dx: positive where the curve runs counter-clockwise.
    double SignedArea (const Crack & loop)
    {
      double area = 0;
      Point centre = loop.Points()[0];
      for (auto & piece : loop.Pieces())
        {
          int n = piece->GaussPoints(2, 0, piece->End());
          for (auto & ip : ngfem::SelectIntegrationRule(ngfem::ET_SEGM, 2*n-1))
            {
              double t = ip(0)*piece->End();
              area += 0.5*ip.Weight()*piece->End()*Cross(Point(piece->Value(t)-centre), piece->Derivative(t));
            }
        }
      return area;
    }

    Crack Reversed (const Crack & loop)
    {
      std::vector<PiecePtr> pieces;
      for (size_t i = loop.NumPieces(); i-- > 0; ) pieces.push_back(loop.Piece(i).Between(loop.Piece(i).End(), 0));
      return Crack::Unchecked(pieces);
    }

    string NameOf (size_t loop) { return loop == 0 ? "the outer curve" : "the curve of hole " + std::to_string(loop-1); }

    const Plane flat { Point3(0., 0., 0.), { Point3(1., 0., 0.), Point3(0., 1., 0.) }, Point3(0., 0., 1.) };
  }

  Sheet :: Sheet (Point3 origin, std::array<Point3,2> axes, std::vector<Crack> aloops) : plane(PlaneOf(origin, axes, "Sheet")), loops(std::move(aloops))
  { CheckLoops(); }

  Sheet :: Sheet (std::shared_ptr<const Surface> asurface, std::vector<Crack> aloops) : plane(flat), surface(std::move(asurface)), loops(std::move(aloops))
  { CheckLoops(); }

  void Sheet :: CheckLoops ()
  {
    if (loops.empty()) throw Exception("Sheet: give the closed curve that bounds it");
    for (size_t i = 0; i < loops.size(); i++)
      {
        if (!loops[i].IsClosed())
          throw Exception("Sheet: " + NameOf(i) + " starts at " + ToString(loops[i].Points().front()) + " and ends at " + ToString(loops[i].Points().back())
                          + "; a sheet is bounded by closed curves. A crack that reaches the boundary of the body goes on beyond it");
        if ((SignedArea(loops[i]) > 0) == (i == 0)) loops[i] = Reversed(loops[i]);
      }
    size = 0;
    for (auto & p : loops[0].Outline(0.2)) size = std::max(size, Norm(Point(p-loops[0].Points()[0])));
    auto meetings = AllMeetings(loops, geometric_tolerance*size);
    for (size_t i = 0; i < loops.size(); i++)
      if (!meetings[i].empty())
        throw Exception("Sheet: " + NameOf(i) + " meets another one near " + ToString(loops[i].PointAt(meetings[i][0])) + "; the curves that bound a sheet keep apart");
    for (size_t i = 1; i < loops.size(); i++)
      for (size_t k = 0; k < loops.size(); k++)
        if (Point p = loops[i].Points()[0]; k != i && loops[k].SideOf(p) != Side::Minus)
          throw Exception("Sheet: " + NameOf(i) + " lies " + (k == 0 ? "outside of the outer one" : "inside of that of hole " + std::to_string(k-1)) + " near " + ToString(p)
                          + "; the first curve is the outer one, the others are holes side by side in it. Give regions that do not hang together as several sheets");
  }

  size_t Sheet :: NearestLoop (Point p) const
  {
    if (loops.size() == 1) return 0;
    return std::ranges::min_element(loops, {}, [p] (auto & loop) { return loop.Nearest(p).distance; }) - loops.begin();
  }

  std::array<Point3,3> Sheet :: FrameAt (Point p) const
  {
    if (!surface) return { plane.normal, plane.axes[0], plane.axes[1] };
    auto at = surface->At(p);
    Point3 first = 1/Norm(at.tangents[0]) * at.tangents[0];
    return { at.normal, first, Cross(at.normal, first) };
  }

  double Sheet :: Area () const
  {
    double area = 0;
    for (auto & loop : loops) area -= SignedArea(loop);
    return area;
  }

  std::array<Point3,2> Sheet :: Bounds () const
  {
    Box box;
    for (auto & arc : loops[0].Arcs(0.25))
      {
        auto [lo, hi] = BoxOf(std::array { arc.a, arc.b }).Grown(2*arc.sagitta);
        box.Add(lo);
        box.Add(hi);
      }
    if (surface) return surface->Bounds(box.lo, box.hi);
    return BoxOfPlane(plane, box.lo, box.hi, 0, 0);
  }
}
