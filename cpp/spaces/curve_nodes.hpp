#pragma once
// The nodes of multipliers on cracks: where the signs of pressures and gaps are taken.

#include "cut/cracked_mesh.hpp"

namespace ngsxfem_contact
{
  /// Nodes crack by crack, in the order of arc length. Only arclengths belong to the plane: cones, laws of friction and active
  /// sets ask for the others.
  struct CurveNodes
  {
    shared_ptr<CrackedMesh> body;
    std::vector<size_t> cracks;                             // of each node its crack
    std::vector<Point> positions;
    std::vector<double> weights;                            // ∫ψ_i, the length of Γ_C that belongs to each
    std::vector<std::array<size_t,2>> neighbours;           // the numbers of two nodes beside each other on a crack
    std::vector<double> arclengths;

    explicit CurveNodes (shared_ptr<CrackedMesh> abody) : body(abody) { }
    /// Of nodes on one crack, or on one arm of it, their arc lengths, increasing, and weights; only these are neighbours.
    void Append (size_t crack, const std::vector<double> & s, const std::vector<double> & length);
  };
}
