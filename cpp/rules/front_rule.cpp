#include "rules/front_rule.hpp"
#include "cut/tet_division.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  constexpr double close = 0.15;                 // of the size of an element: nearer fronts are taken to touch it
  constexpr double least_radius = 1.25;          // of curvature, of the size of a part that slices go through: they must not meet in it

  void AppendTet (const Tet & t, int order, PointRule3 & rule)
  {
    double jacobian = 6*Volume(t);
    for (auto & ip : ngfem::SelectIntegrationRule(ngfem::ET_TET, order))
      rule.push_back({ Point3(ip(0)*t[0] + ip(1)*t[1] + ip(2)*t[2] + (1-ip(0)-ip(1)-ip(2))*t[3]), ip.Weight()*jacobian });
  }

  void AppendTriangle (const Triangle3 & t, int order, PointRule3 & rule)
  {
    double jacobian = Norm(Cross(Point3(t[1]-t[0]), Point3(t[2]-t[0])));
    for (auto & ip : ngfem::SelectIntegrationRule(ngfem::ET_TRIG, order == 2 ? 3 : order))
      rule.push_back({ Point3(ip(0)*t[0] + ip(1)*t[1] + (1-ip(0)-ip(1))*t[2]), ip.Weight()*jacobian });
  }

  namespace
  {
    /// 0 for heights that are round-off.
    std::array<double,4> Heights (const Tet & t, const Plane & plane)
    {
      std::array<double,4> heights;
      double round_off = 1e-12*LongestEdge(t);
      for (int i = 0; i < 4; i++) heights[i] = plane.Height(t[i]);
      for (double & d : heights)
        if (std::abs(d) <= round_off) d = 0;
      return heights;
    }

    std::vector<Point3> Samples (const Tet & t)
    {
      std::vector<Point3> points { t.begin(), t.end() };
      for (auto & [i, j] : tet_edges) points.push_back(Lerp(t[i], t[j], 0.5));
      for (int i = 0; i < 4; i++) points.push_back(Point3(1./3*(t[0]+t[1]+t[2]+t[3]-t[i])));
      points.push_back(Centre(t));
      return points;
    }

    /// The least value of f on a front near the arc length s: of several points within a distance, and beside those that are lower than their neighbours.
    template <typename F>
    double LeastNear (const Front & front, double s, double within, F && f)
    {
      double length = front.Length();
      auto at = [&] (double x)
      {
        if (front.IsClosed()) x -= length*std::floor(x/length);
        return f(front.Curve().PointAt(std::clamp(x, 0.0, length)));
      };
      constexpr int n = 12;
      double step = std::min(within, length)/n, least = std::numeric_limits<double>::infinity();
      std::array<double,2*n+1> values;
      for (int i = 0; i <= 2*n; i++) values[i] = at(s+(i-n)*step);
      for (int i = 0; i <= 2*n; i++)
        {
          least = std::min(least, values[i]);
          if ((i > 0 && values[i-1] < values[i]) || (i < 2*n && values[i+1] < values[i])) continue;
          double lo = s+(i-n-1)*step, hi = s+(i-n+1)*step;
          for (int it = 0; it < 20; it++)
            {
              double a = lo + 0.382*(hi-lo), b = lo + 0.618*(hi-lo), fa = at(a), fb = at(b);
              least = std::min({ least, fa, fb });
              (fa < fb ? hi : lo) = fa < fb ? b : a;
            }
        }
      return least;
    }

    /// Where one piece of a front ends and the next one starts: nearer to the first where Distance is negative.
    std::optional<Line> JointAfter (const Front & front, size_t piece)
    {
      auto & curve = front.Curve();
      size_t n = curve.NumPieces(), next = (piece+1) % n;
      if ((next == 0 && !front.IsClosed()) || n == 1) return std::nullopt;
      Point before = curve.Tangent(piece, curve.ArcLength(piece+1)), after = curve.Tangent(next, curve.ArcLength(next)), sum = before+after;
      double size = Norm(sum);
      return Line { curve.Points()[piece+1], size > 1e-6 ? Point(1/size*sum) : before };
    }

    /// The piece of the nearest point; of two that meet there the one on this side of their joint.
    size_t NearestPiece (const Front & front, Point p)
    {
      auto at = front.Curve().Nearest(p);
      size_t n = front.Curve().NumPieces();
      if (at.t >= front.Curve().Piece(at.piece).End())
        if (auto joint = JointAfter(front, at.piece); joint && joint->Distance(p) > 0) return (at.piece+1) % n;
      if (at.t <= 0)
        if (auto joint = JointAfter(front, (at.piece+n-1) % n); joint && joint->Distance(p) < 0) return (at.piece+n-1) % n;
      return at.piece;
    }

    /// Whether slices normal to the front, through the feet of the corners of a part, meet in it: the front turns too sharply for its size.
    bool SlicesMeet (const FrontPiece & piece, const std::vector<Point> & corners, double size)
    {
      std::vector<double> feet;
      for (auto & p : corners) feet.push_back(piece.Foot(p));
      auto [s0, s1] = std::ranges::minmax(feet);
      return piece.LargestCurvature(s0, s1)*size*least_radius > 1;
    }

    /// What divides a body with these corners around a piece: the joint at its start or its end that some corners lie beyond.
    std::optional<Line> DividingJoint (const Front & front, size_t piece, const std::vector<Point> & corners, double size)
    {
      size_t n = front.Curve().NumPieces();
      for (auto & [joint, sign] : { std::pair(JointAfter(front, (piece+n-1) % n), -1.), std::pair(JointAfter(front, piece), 1.) })
        if (joint)
          {
            double lo = 0, hi = 0;
            for (auto & p : corners)
              {
                lo = std::min(lo, joint->Distance(p));
                hi = std::max(hi, joint->Distance(p));
              }
            bool beyond = sign > 0 ? hi > 1e-9*size : lo < -1e-9*size, here = sign > 0 ? lo < -1e-9*size : hi > 1e-9*size;
            if (beyond && here) return joint;
          }
      return std::nullopt;
    }

    std::array<Triangle,4> Refined (const Triangle & t)
    {
      Point a = Lerp(t[0], t[1], 0.5), b = Lerp(t[1], t[2], 0.5), c = Lerp(t[2], t[0], 0.5);
      return { Triangle { t[0], a, c }, Triangle { a, t[1], b }, Triangle { c, b, t[2] }, Triangle { a, b, c } };
    }

    double Size (const Polygon & polygon)
    {
      double size = 0;
      for (auto & p : polygon)
        for (auto & q : polygon) size = std::max(size, Norm(Point(p-q)));
      return size;
    }
  }

  const Front & FrontRule :: Nearest (Point3 x) const
  { return **std::ranges::min_element(fronts, {}, [x] (auto front) { return front->FlatDistance(x); }); }

  double FrontRule :: SampledDistance (const std::vector<Point3> & points) const
  {
    double least = std::numeric_limits<double>::infinity();
    for (auto front : fronts)
      for (auto & x : points) least = std::min(least, front->FlatDistance(x));
    return least;
  }

  bool FrontRule :: IsClose (const Tet & t, const Front & front) const
  {
    double size = LongestEdge(t);
    Point3 centre = Centre(t);
    Point c = front.GetPlane().Project(centre);
    auto at = front.Curve().Nearest(c);
    if (std::hypot(at.distance, front.GetPlane().Height(centre)) > (1+close)*size) return false;
    std::array<Point3,4> out;
    for (int i = 0; i < 4; i++)
      {
        Point3 a = t[(i+1)%4], n = Cross(Point3(t[(i+2)%4]-a), Point3(t[(i+3)%4]-a));
        out[i] = (Dot(Point3(t[i]-a), n) > 0 ? -1 : 1)/Norm(n) * n;
      }
    return LeastNear(front, front.Curve().ArcLength(at), 1.5*size, [&] (Point p)
    {
      Point3 x = front.GetPlane().Value(p);
      double most = -std::numeric_limits<double>::infinity();
      for (int i = 0; i < 4; i++) most = std::max(most, Dot(Point3(x-t[(i+1)%4]), out[i]));
      return most;
    }) < close*size;
  }

  void FrontRule :: AppendTet (const Tet & t, bool divide, int depth, PointRule3 & rule) const
  {
    auto & front = Nearest(Centre(t));
    size_t here = std::ranges::count_if(fronts, [&] (auto some) { return IsClose(t, *some); });
    if (here > 1 && depth > 0)
      {
        for (auto & part : Refined(t)) AppendTet(part, true, depth-1, rule);
        return;
      }
    if (here > 0) return AppendNear(t, front, depth, rule);
    if (!divide) return AppendBeside(t, depth, rule);
    for (auto & half : Split(t, Heights(t, front.GetPlane())))
      for (auto & part : half) AppendBeside(part, depth, rule);
  }

  void FrontRule :: AppendNear (const Tet & t, const Front & front, int depth, PointRule3 & rule) const
  {
    auto & plane = front.GetPlane();
    double size = LongestEdge(t);
    size_t piece = NearestPiece(front, plane.Project(Centre(t)));
    std::vector<Point> corners;
    for (auto & x : t) corners.push_back(plane.Project(x));
    if (depth > 0)
      if (auto joint = DividingJoint(front, piece, corners, size))
        {
          std::array<double,4> d;
          for (int i = 0; i < 4; i++) d[i] = joint->Snapped(corners[i], 1e-9*size);
          for (auto & half : Split(t, d))
            for (auto & part : half)
              if (Volume(part) > 0) AppendTet(part, true, depth-1, rule);
          return;
        }
    FrontPiece here(front, piece);
    if (depth > 0 && SlicesMeet(here, corners, size))
      {
        for (auto & part : Refined(t)) AppendTet(part, true, depth-1, rule);
        return;
      }
    AppendSlices(t, Heights(t, plane), here, demand, rule);
  }

  void FrontRule :: AppendBeside (const Tet & t, int depth, PointRule3 & rule) const
  {
    if (depth > 0 && SampledDistance(Samples(t)) < demand.beta*LongestEdge(t))
      for (auto & part : Refined(t)) AppendBeside(part, depth-1, rule);
    else
      ngsxfem_contact::AppendTet(t, demand.order, rule);
  }

  bool FrontRule :: IsClose (const Polygon & polygon, const Front & front) const
  {
    double size = Size(polygon);
    Point centre = Centre(polygon);
    auto at = front.Curve().Nearest(centre);
    std::vector<Line> out;
    bool turned = Cross(Point(polygon[1]-polygon[0]), Point(polygon[2]-polygon[0])) < 0;
    for (size_t i = 0; i < polygon.size(); i++)
      {
        Point d = polygon[(i+1) % polygon.size()]-polygon[i];
        if (Norm(d) > 1e-13*size) out.push_back({ polygon[i], Point((turned ? 1 : -1)/Norm(d) * Left(d)) });
      }
    return LeastNear(front, front.Curve().ArcLength(at), 1.5*size, [&] (Point p)
    {
      double most = -std::numeric_limits<double>::infinity();
      for (auto & line : out) most = std::max(most, line.Distance(p));
      return most;
    }) < close*size;
  }

  void FrontRule :: AppendPolygon (const Polygon & polygon, const Sheet & sheet, int depth, PointRule & rule) const
  {
    std::vector<const Front*> here;
    std::ranges::copy_if(fronts, std::back_inserter(here), [&] (auto front) { return IsClose(polygon, *front); });
    Point centre = Centre(polygon);
    if (here.empty())
      {
        if (!sheet.Contains(centre)) return;
        for (auto & t : Fan(polygon)) AppendBeside(t, depth, rule);
      }
    else if (here.size() == 1) AppendNear(polygon, sheet, *here[0], depth, rule);
    else if (depth > 0)
      for (auto & t : Fan(polygon))
        for (auto & part : Refined(t)) AppendPolygon({ part.begin(), part.end() }, sheet, depth-1, rule);
    else if (sheet.Contains(centre))
      for (auto & t : Fan(polygon)) ngsxfem_contact::AppendTriangle(t, demand.order, rule);
  }

  void FrontRule :: AppendNear (const Polygon & polygon, const Sheet & sheet, const Front & front, int depth, PointRule & rule) const
  {
    double size = Size(polygon);
    size_t piece = NearestPiece(front, Centre(polygon));
    if (depth > 0)
      if (auto joint = DividingJoint(front, piece, polygon, size))
        {
          std::vector<double> d;
          for (auto & p : polygon) d.push_back(joint->Snapped(p, 1e-9*size));
          for (auto & half : Split(polygon, d))
            if (half.size() > 2) AppendPolygon(half, sheet, depth-1, rule);
          return;
        }
    FrontPiece here(front, piece);
    if (depth > 0 && SlicesMeet(here, polygon, size))
      {
        for (auto & t : Fan(polygon))
          for (auto & part : Refined(t)) AppendPolygon({ part.begin(), part.end() }, sheet, depth-1, rule);
        return;
      }
    AppendPlaneSlices(polygon, here, demand, rule);
  }

  void FrontRule :: AppendBeside (const Triangle & t, int depth, PointRule & rule) const
  {
    double least = std::numeric_limits<double>::infinity();
    for (auto front : fronts)
      for (Point p : { t[0], t[1], t[2], Lerp(t[0], t[1], 0.5), Lerp(t[1], t[2], 0.5), Lerp(t[2], t[0], 0.5), Centre({ t.begin(), t.end() }) })
        least = std::min(least, front->Curve().Nearest(p).distance);
    if (depth > 0 && least < demand.beta*LongestEdge(t))
      for (auto & part : Refined(t)) AppendBeside(part, depth-1, rule);
    else
      ngsxfem_contact::AppendTriangle(t, demand.order, rule);
  }

  void FrontRule :: AppendBoundary (const Triangle3 & t, PointRule3 & rule, int depth) const
  {
    Point3 a = Lerp(t[0], t[1], 0.5), b = Lerp(t[1], t[2], 0.5), c = Lerp(t[2], t[0], 0.5);
    double size = std::max({ Norm(Point3(t[1]-t[0])), Norm(Point3(t[2]-t[1])), Norm(Point3(t[0]-t[2])) });
    if (depth > 0 && SampledDistance({ t[0], t[1], t[2], a, b, c, Point3(1./3*(t[0]+t[1]+t[2])) }) < demand.beta*size)
      for (auto & part : { Triangle3 { t[0], a, c }, Triangle3 { a, t[1], b }, Triangle3 { c, b, t[2] }, Triangle3 { a, b, c } }) AppendBoundary(part, rule, depth-1);
    else
      ngsxfem_contact::AppendTriangle(t, demand.order, rule);
  }
}
