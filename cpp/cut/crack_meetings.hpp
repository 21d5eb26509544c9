#pragma once
// Where cracks cross, end on each other, or start at one point.

#include "cut/body_boundary.hpp"

namespace ngsxfem_contact
{
  /// Ends of cracks inside the body that nearly reach another crack, or reach beyond it by as little, end on it: the mesh sees no thinner ligament
  /// (least_end_distance). Appends a sentence for each end that moved.
  void FitToEachOther (std::vector<Crack> & cracks, const MeshAccess & mesh, const BodyBoundary & boundary, std::vector<std::string> & notes);

  /// For each crack the arc lengths at which it meets others, increasing. Throws where cracks share a stretch, or touch without crossing.
  std::vector<std::vector<double>> AllMeetings (const std::vector<Crack> & cracks, double tolerance);
}
