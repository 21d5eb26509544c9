#pragma once
// Points and arrays between Python and the core.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <python_ngstd.hpp>
#include <python_comp.hpp>
#include "spaces/crack_fespace.hpp"
#include "spaces/crack_bilinearform.hpp"
#include "spaces/stress_power.hpp"
#include "spaces/trace_space.hpp"
#include "curve/piece_description.hpp"
#include "forms/cut_integral.hpp"
#include "forms/crack_normal.hpp"

namespace ngsxfem_contact
{
  using Pair = std::pair<double,double>;
  inline Pair ToPair (Point p) { return { p(0), p(1) }; }
  inline std::array<Pair,3> ToPairs (const Triangle & t) { return { ToPair(t[0]), ToPair(t[1]), ToPair(t[2]) }; }
  inline Point ToPoint (Pair p) { return Point(p.first, p.second); }

  /// Points of the plane, as an argument that says what it takes.
  struct PlanePoints { std::vector<Pair> pairs; };

  inline Crack ToCrack (const PlanePoints & given, const std::string & name)
  {
    std::vector<Point> points;
    for (auto & p : given.pairs) points.push_back(ToPoint(p));
    return Crack(points).Named(name);
  }

  inline std::vector<Pair> ToPairs (const std::vector<Point> & points)
  {
    std::vector<Pair> pairs;
    for (auto & p : points) pairs.push_back(ToPair(p));
    return pairs;
  }

  inline std::vector<Pair> PointsOf (const Crack & crack) { return ToPairs(crack.Points()); }

  /// Pieces as ("segment", [a, b]), ("arc", [start, through, end]) or ("cubic", [p0, d0, p1, d1]).
  using PieceDescriptions = std::vector<std::pair<std::string, std::vector<Pair>>>;

  inline PieceDescriptions PiecesOf (const Crack & crack)
  {
    PieceDescriptions pieces;
    for (auto & piece : crack.Pieces())
      {
        auto [kind, points] = piece->Description();
        pieces.push_back({ kind, ToPairs(points) });
      }
    return pieces;
  }

  inline Crack CrackOfPieces (const PieceDescriptions & descriptions, const std::string & name)
  {
    std::vector<PiecePtr> pieces;
    for (auto & [kind, pairs] : descriptions)
      {
        std::vector<Point> p;
        for (auto & pair : pairs) p.push_back(ToPoint(pair));
        for (auto & piece : MakePieces(kind, p)) pieces.push_back(piece);
      }
    return Crack(pieces).Named(name);
  }

  /// A crack of a body, by its number or its name.
  using CrackKey = std::variant<size_t, std::string>;

  inline size_t NumberOf (const CrackedBody & body, const CrackKey & crack)
  { return std::holds_alternative<size_t>(crack) ? std::get<size_t>(crack) : body.CrackNumber(std::get<std::string>(crack)); }
}

template <>
struct pybind11::detail::type_caster<ngsxfem_contact::PlanePoints>
{
  using Pairs = make_caster<std::vector<ngsxfem_contact::Pair>>;
  PYBIND11_TYPE_CASTER(ngsxfem_contact::PlanePoints, Pairs::name);

  /// Raises TypeError for anything else, since the types that pybind11 would list do not say what is wrong.
  bool load (handle source, bool convert)
  {
    Pairs pairs;
    if (!pairs.load(source, convert))
      throw type_error("points are pairs (x, y), not " + std::string(repr(source)) + "; in space a crack is a surface: Sheet.Polygon(points), or Sheet.Extrude of a Crack");
    value.pairs = cast_op<std::vector<ngsxfem_contact::Pair> &&>(std::move(pairs));
    return true;
  }
};
