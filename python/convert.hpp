#pragma once
// Points and arrays between Python and the core.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <python_ngstd.hpp>
#include <python_comp.hpp>
#include "crack_fespace.hpp"
#include "crack_bilinearform.hpp"
#include "trace_space.hpp"
#include "cut_integral.hpp"
#include "crack_normal.hpp"

namespace ngsxfem_contact
{
  using Pair = std::pair<double,double>;
  inline Pair ToPair (Point p) { return { p(0), p(1) }; }
  inline std::array<Pair,3> ToPairs (const Triangle & t) { return { ToPair(t[0]), ToPair(t[1]), ToPair(t[2]) }; }
  inline Point ToPoint (Pair p) { return Point(p.first, p.second); }

  inline Crack ToCrack (const std::vector<Pair> & pairs)
  {
    std::vector<Point> points;
    for (auto & p : pairs) points.push_back(ToPoint(p));
    return Crack(points);
  }

  inline std::vector<Pair> PointsOf (const Crack & crack)
  {
    std::vector<Pair> pairs;
    for (auto & p : crack.Points()) pairs.push_back(ToPair(p));
    return pairs;
  }
}
