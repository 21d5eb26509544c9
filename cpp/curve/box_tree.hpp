#pragma once
// Boxes in the plane, and a tree of them that finds those near a place in logarithmic time.

#include "curve/curve_piece.hpp"
#include <algorithm>
#include <limits>

namespace ngsxfem_contact
{
  struct Box
  {
    Point lo { std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity() };
    Point hi = -1*lo;

    void Add (Point p)
    { for (int k : { 0, 1 }) { lo(k) = std::min(lo(k), p(k)); hi(k) = std::max(hi(k), p(k)); } }
    Box Grown (double by) const { return { Point(lo - Point(by, by)), Point(hi + Point(by, by)) }; }

    bool Meets (const Box & other) const
    { return hi(0) >= other.lo(0) && lo(0) <= other.hi(0) && hi(1) >= other.lo(1) && lo(1) <= other.hi(1); }
    double DistanceTo (const Box & other) const
    {
      auto off = [&] (int k) { return std::max({ lo(k)-other.hi(k), other.lo(k)-hi(k), 0.0 }); };
      double dx = off(0), dy = off(1);
      return sqrt(dx*dx + dy*dy);
    }
    double DistanceTo (Point p) const { return DistanceTo(Box { p, p }); }
  };

  template <typename POINTS>
  Box BoxOf (const POINTS & points)
  {
    Box box;
    for (auto & p : points) box.Add(p);
    return box;
  }

  class BoxTree
  {
    size_t size = 0;
    std::vector<Box> nodes;                   // nodes[size+i]: the i-th box; nodes[i] holds nodes[2i] and nodes[2i+1]

  public:
    BoxTree () = default;
    explicit BoxTree (const std::vector<Box> & boxes) : size(boxes.size()), nodes(size)
    {
      nodes.insert(nodes.end(), boxes.begin(), boxes.end());
      for (size_t i = size; i-- > 1; )
        for (auto & child : { nodes[2*i], nodes[2*i+1] }) { nodes[i].Add(child.lo); nodes[i].Add(child.hi); }
    }

    /// visit(i) for every box that meets another one.
    template <typename F>
    void VisitMeeting (const Box & box, F && visit, size_t node = 1) const
    {
      if (!nodes[node].Meets(box)) return;
      if (node >= size) return visit(node-size);
      VisitMeeting(box, visit, 2*node);
      VisitMeeting(box, visit, 2*node+1);
    }

    /// visit(i), about nearest first, returns the least distance of p, a point or a box, that is known by then; boxes farther away than
    /// that are left out.
    template <typename P, typename F>
    void VisitNear (const P & p, double & least, F && visit, size_t node = 1) const
    {
      if (node >= size) { least = visit(node-size); return; }
      size_t near = 2*node, far = near+1;
      double to_near = nodes[near].DistanceTo(p), to_far = nodes[far].DistanceTo(p);
      if (to_far < to_near) { std::swap(near, far); std::swap(to_near, to_far); }
      if (to_near <= least) VisitNear(p, least, visit, near);
      if (to_far <= least) VisitNear(p, least, visit, far);
    }
  };
}
