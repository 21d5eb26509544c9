#include "cut/body_boundary.hpp"
#include <algorithm>
#include <set>

namespace ngsxfem_contact
{
  Point BodyBoundary::Edge :: Derivative (double along) const
  {
    Point d = b-a;
    auto [value, d0, d1] = map.At(Lerp(a, b, along));
    return Point(d(0)*d0 + d(1)*d1);
  }

  BodyBoundary :: BodyBoundary (const MeshAccess & mesh, bool is_part) : smallest(std::numeric_limits<double>::infinity())
  {
    std::set<size_t> bounding;
    for (size_t i = 0; is_part && i < mesh.GetNE(ngfem::BND); i++)
      bounding.insert(mesh.GetElement(ngfem::ElementId(ngfem::BND, i)).Edges()[0]);
    for (size_t i = 0; i < mesh.GetNE(ngfem::VOL); i++)
      {
        ElementMap map(mesh, i);
        double h = LongestEdge(map.Corners());
        smallest = std::min(smallest, h);
        for (auto nr : mesh.GetElement(ngfem::ElementId(ngfem::VOL, i)).Edges())
          {
            ngcore::Array<int> neighbours;
            mesh.GetEdgeElements(nr, neighbours);
            if (neighbours.Size() != 1 || (is_part && !bounding.count(nr))) continue;
            auto [v0, v1] = mesh.GetEdgePNums(nr);
            Edge edge { map, mesh.GetPoint<2>(v0), mesh.GetPoint<2>(v1), {}, h };
            if (Cross(Point(edge.b-edge.a), Point(Centre({ map.Corners().begin(), map.Corners().end() })-edge.a)) < 0) std::swap(edge.a, edge.b);
            int n = map.IsCurved() ? 16 : 1;
            for (int k = 0; k <= n; k++) edge.outline.push_back(k == 0 ? edge.a : k == n ? edge.b : edge.Value(double(k)/n));
            edges.push_back(std::move(edge));
          }
      }
  }

  BodyBoundary::Place BodyBoundary :: Nearest (Point p) const
  {
    Place best { std::numeric_limits<double>::infinity(), p, 0, 0, 0 };
    for (size_t i = 0; i < edges.size(); i++)
      {
        auto & outline = edges[i].outline;
        for (size_t k = 0; k+1 < outline.size(); k++)
          {
            Point ab = outline[k+1]-outline[k];
            double t = std::clamp(Dot(Point(p-outline[k]), ab)/Dot(ab, ab), 0.0, 1.0);
            Point q = Lerp(outline[k], outline[k+1], t);
            if (double d = Norm(Point(p-q)); d < best.distance) best = { d, q, i, (k+t)/(outline.size()-1), edges[i].SizeAcross() };
          }
      }
    auto & edge = edges[best.edge];
    if (!edge.map.IsCurved()) return best;
    for (int it = 0; it < 5; it++)                      // from the outline to the curve
      {
        Point d = edge.Derivative(best.along);
        best.along = std::clamp(best.along + Dot(Point(p-edge.Value(best.along)), d)/Dot(d, d), 0.0, 1.0);
      }
    best.point = edge.Value(best.along);
    best.distance = Norm(Point(p-best.point));
    return best;
  }

  /// By the number of turns of ∂Ω around it.
  bool BodyBoundary :: Contains (Point p) const
  {
    double angle = 0;
    for (auto & edge : edges)
      for (size_t k = 0; k+1 < edge.outline.size(); k++)
        {
          Point a = edge.outline[k]-p, b = edge.outline[k+1]-p;
          angle += atan2(Cross(a, b), Dot(a, b));
        }
    return angle > M_PI;
  }

  std::vector<BodyBoundary::Meeting> BodyBoundary :: Meetings (const Crack & crack) const
  {
    std::vector<Meeting> meetings;
    for (size_t i = 0; i < edges.size(); i++)
      {
        auto & outline = edges[i].outline;
        for (size_t k = 0; k+1 < outline.size(); k++)
          {
            Point a = outline[k], ab = outline[k+1]-a;
            Box box;
            for (Point p : { a, outline[k+1] }) box.Add(p);
            for (size_t piece : crack.PiecesNear(box.Grown(1e-6*edges[i].h)))
              {
                auto & curve = crack.Piece(piece);
                std::vector<double> crossings;
                curve.AppendCrossings(a, Left(Point(1/Norm(ab) * ab)), crossings);
                for (double t : crossings)
                  if (double along = Dot(Point(curve.Value(t)-a), ab)/Dot(ab, ab); along > -1e-9 && along < 1+1e-9)
                    meetings.push_back({ piece, Meet(curve, t, i, (k+along)/(outline.size()-1)).value_or(t), i });
              }
          }
      }
    return meetings;
  }

  std::optional<double> BodyBoundary :: Meet (const CurvePiece & piece, double t, size_t number, double along) const
  {
    auto & edge = edges[number];
    for (int it = 0; it < 20; it++)
      {
        Point r = piece.Value(t)-edge.Value(along), dt = piece.Derivative(t), da = edge.Derivative(along);
        double det = Cross(dt, da);
        if (!(std::abs(det) > 1e-6*Norm(dt)*Norm(da))) return std::nullopt;
        double step = -Cross(r, da)/det, slide = -Cross(r, dt)/det;
        t += step;
        along += slide;
        if (std::abs(step)*Norm(dt) <= 1e-14*edge.h + 1e-15*Norm(edge.a))
          return along > -1e-6 && along < 1+1e-6 ? std::optional(t) : std::nullopt;
      }
    return std::nullopt;
  }

  std::optional<BodyBoundary::Hit> BodyBoundary :: Shoot (Point p, Point d, double from, double to) const
  {
    std::optional<Hit> best;
    for (size_t i = 0; i < edges.size(); i++)
      {
        auto & outline = edges[i].outline;
        if (Norm(Point(edges[i].a-p)) > to + 2*edges[i].h) continue;
        for (size_t k = 0; k+1 < outline.size(); k++)
          {
            Point a = outline[k]-p, ab = outline[k+1]-outline[k];
            double det = Cross(d, ab), tau = Cross(a, ab)/det, along = Cross(a, d)/det;
            if (!(tau >= from && tau <= to && along > -1e-9 && along < 1+1e-9)) continue;
            if (!best || tau < best->tau) best = Hit { tau, i, (k+along)/(outline.size()-1) };
          }
      }
    return best;
  }
}
