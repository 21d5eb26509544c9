#include "cut/front.hpp"

namespace ngsxfem_contact
{
  Front :: Front (size_t asheet, size_t aloop, const Plane & aplane, Crack acurve)
    : sheet(asheet), loop(aloop), plane(aplane), curve(std::move(acurve))
  {
    if (curve.IsClosed() && Norm(Point(curve.Tangent(0, 0) - curve.Tangent(curve.NumPieces()-1, curve.Length()))) > 1e-6) corners.push_back(0);
    for (size_t i = 1; i < curve.NumPieces(); i++)
      if (curve.IsKink(i)) corners.push_back(curve.ArcLength(i));
  }

  std::array<Point3,3> Front :: FrameAt (double s) const
  {
    Point tangent = curve.Tangent(curve.PieceAt(s), s);
    return { plane.Direction(Left(tangent)), plane.normal, plane.Direction(tangent) };
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

  Front::TubePoint Front :: Tube (Point3 x) const
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
