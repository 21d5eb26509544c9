#include "cut/front.hpp"

namespace ngsxfem_contact
{
  Front :: Front (size_t anumber, size_t aloop, const Sheet & asheet, Crack acurve)
    : sheet(anumber), loop(aloop), plane(asheet.GetPlane()), surface(asheet.GetSurface()), curve(std::move(acurve))
  {
    if (curve.IsClosed() && Norm(Point(curve.Tangent(0, 0) - curve.Tangent(curve.NumPieces()-1, curve.Length()))) > 1e-6) corners.push_back(0);
    for (size_t i = 1; i < curve.NumPieces(); i++)
      if (curve.IsKink(i)) corners.push_back(curve.ArcLength(i));
  }

  std::array<Point3,3> Front :: FrameAt (double s) const
  {
    if (surface) return LocalAt(s).frame;
    Point tangent = curve.Tangent(curve.PieceAt(s), s);
    return { plane.Direction(Left(tangent)), plane.normal, plane.Direction(tangent) };
  }

  Front::Local Front :: LocalAt (double s) const
  {
    size_t piece = curve.PieceAt(s);
    Point tangent = curve.Tangent(piece, s);
    auto at = surface->At(curve.PointAt(piece, s));
    auto in_space = [&] (Point d) { return Point3(d(0)*at.tangents[0] + d(1)*at.tangents[1]); };
    Point3 along = in_space(tangent);
    along = 1/Norm(along) * along;
    Point3 ahead = Cross(at.normal, along);
    return { { ahead, at.normal, along }, { Dot(in_space(Left(tangent)), ahead), Dot(at.up, ahead), Dot(at.up, at.normal) } };
  }

  Point3 Front :: PointAt (double s) const
  { return surface ? surface->At(curve.PointAt(s)).point : plane.Value(curve.PointAt(s)); }

  std::array<Point3,2> Front :: FlatFrameAt (double s) const
  {
    Point tangent = curve.Tangent(curve.PieceAt(s), s);
    return { plane.Direction(Left(tangent)), plane.Direction(tangent) };
  }

  Front::Local Front :: TurnAt (double s) const
  {
    double step = 1e-5*Length(), from = s-step, to = s+step;
    if (IsClosed()) { from += from < 0 ? Length() : 0; to -= to > Length() ? Length() : 0; }
    else { from = std::max(from, 0.0); to = std::min(to, Length()); step = 0.5*(to-from); }
    auto before = LocalAt(from), after = LocalAt(to);
    for (int k = 0; k < 3; k++)
      {
        after.frame[k] = 0.5/step * (after.frame[k]-before.frame[k]);
        after.stretch[k] = 0.5/step * (after.stretch[k]-before.stretch[k]);
      }
    return after;
  }

  std::optional<size_t> Front :: StretchAt (double s) const
  {
    double tolerance = 1e-9*Length();
    bool closes = IsClosed() && !corners.empty() && corners[0] <= tolerance;       // the first corner is where the curve ends, too
    for (double corner : corners)
      if (std::abs(s-corner) <= tolerance || (closes && corner <= tolerance && Length()-s <= tolerance)) return std::nullopt;
    size_t before = std::ranges::count_if(corners, [&] (double corner) { return corner < s; });
    return IsClosed() && before == corners.size() && !closes ? 0 : before;
  }

  double Front :: CurvatureAt (double s) const
  {
    size_t i = curve.PieceAt(s);
    return -curve.Piece(i).Curvature(s-curve.ArcLength(i));
  }

  Front::TubePoint Front :: FlatTube (Point3 x) const
  {
    Point p = plane.Project(x);
    double height = plane.Height(x), round_off = 1e-15*(Norm(x) + Norm(plane.origin));
    auto at = curve.Nearest(p);
    double x1 = at.distance;
    if (at.beyond_end) x1 = std::abs(Cross(curve.Tangent(at), Point(p-curve.Piece(at.piece).Value(at.t))));
    if (curve.SideOf(p) == Side::Minus) x1 = -x1;
    return { x1, std::abs(height) <= round_off ? 0 : height, curve.ArcLength(at) };
  }
}
