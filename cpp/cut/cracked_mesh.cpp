#include "cut/cracked_mesh.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using ngcore::Exception;

  MeshState :: MeshState (MeshAccess & mesh)
    : num_elements(mesh.GetNE(VOL)), num_vertices(mesh.GetNV()), curve_order(mesh.GetCurveOrder()), deformed(mesh.GetDeformation() != nullptr) { }

  CrackedMesh :: CrackedMesh (shared_ptr<MeshAccess> amesh, std::vector<Crack> acracks)
    : mesh(amesh), located_in(*amesh), cracks(std::move(acracks))
  {
    if (located_in.deformed)
      throw Exception("CrackedMesh: the mesh is moved by SetDeformation, which cracks and rules know nothing of; build a mesh of the moved body");
    if (cracks.empty()) throw Exception("CrackedMesh: give at least one crack");
    CheckTriangles(*mesh);
    BodyBoundary boundary(*mesh);
    for (size_t c = 0; c < cracks.size(); c++) cracks[c] = FittedToBody(cracks[c], c, boundary, notes);
    locations.reserve(cracks.size());
    for (auto & crack : cracks)
      locations.emplace_back(*mesh, crack);
    CheckDistinct();
    FindCutElements();
    FindTips(boundary);
  }

  size_t CrackedMesh :: Checked (size_t crack) const
  {
    if (crack >= cracks.size())
      throw Exception("CrackedMesh: there is no crack " + std::to_string(crack) + "; the body has " + std::to_string(cracks.size()));
    return crack;
  }

  std::vector<std::pair<size_t, ngfem::IntegrationPoint>> CrackedMesh :: OnCrack (size_t c, const std::vector<double> & arclengths) const
  {
    CheckMesh();
    auto & crack = GetCrack(c);
    std::vector<std::pair<size_t, ngfem::IntegrationPoint>> points;
    for (double s : arclengths)
      {
        auto element = Location(c).At(crack.Checked(s)).element;
        points.push_back({ element, ElementMap(*mesh, element).PhysicalInReference(crack.PointAt(s), 0) });
      }
    return points;
  }

  void CrackedMesh :: CheckMesh () const
  {
    MeshState now(*mesh);
    if (now == located_in) return;
    string how = now.deformed ? "it is moved by SetDeformation" : now.curve_order != located_in.curve_order ? "it was curved" : "it was refined";
    throw Exception("CrackedMesh: the mesh has changed since the cracks were located in it (" + how + "); build a new CrackedMesh, and all else on it anew");
  }

  void CrackedMesh :: CheckDistinct () const
  {
    for (size_t c = 0; c < cracks.size(); c++)
      for (size_t d = c+1; d < cracks.size(); d++)
        if (auto [distance, place] = Distance(cracks[c], cracks[d]); distance <= locations[c].Tolerance())
          throw Exception("CrackedMesh: cracks " + std::to_string(c) + " and " + std::to_string(d) + " meet near "
                          + ToString(place) + "; crossing and branching are not supported: separate them");
  }

  void CrackedMesh :: FindCutElements ()
  {
    std::map<size_t, std::vector<ElementCrack>> meetings;
    for (size_t c = 0; c < cracks.size(); c++)
      for (auto & location : locations[c].Elements())
        meetings[location.element].push_back({ c, &location, location.kind, location.areas, Side::Plus });
    for (auto & [element, meeting] : meetings)
      cut_elements.emplace(element, CutElement(cracks, std::move(meeting)));
  }

  void CrackedMesh :: FindTips (const BodyBoundary & boundary)
  {
    for (size_t c = 0; c < cracks.size(); c++)
      for (auto & end : locations[c].Ends())
        if (end.kind == EndKind::Tip)
          {
            bool at_end = end.s > 0;
            TipCurve curve(cracks[c], at_end);
            tips.push_back({ c, end.s, curve, end.point, curve.Ahead(), at_end ? 1 : -1, 0, "" });
          }
    for (auto & tip : tips) SetClearance(tip, boundary);
  }

  void CrackedMesh :: SetClearance (Tip & tip, const BodyBoundary & boundary) const
  {
    tip.distances.push_back({ boundary.Nearest(tip.point).distance, "the boundary of the body" });
    for (size_t c = 0; c < cracks.size(); c++)
      if (c != tip.crack) tip.distances.push_back({ cracks[c].Nearest(tip.point).distance, "crack " + std::to_string(c) });
    tip.clearance = std::numeric_limits<double>::infinity();
    auto limit = [&] (double distance, std::string what)
    { if (distance < tip.clearance) { tip.clearance = distance; tip.limit = what; } };
    for (auto & [distance, what] : tip.distances) limit(distance, what);
    LimitByOwnCrack(tip, limit);
    for (auto & other : tips)
      if (&other != &tip) limit(0.5*Norm(Point(other.point-tip.point)), "half the way to the tip at " + ToString(other.point));
  }

  void CrackedMesh :: LimitByOwnCrack (const Tip & tip, const std::function<void(double, std::string)> & limit) const
  {
    limit(tip.curve.CurvatureLimit(), "half of the crack's radius of curvature");
    auto & crack = cracks[tip.crack];
    double followed = tip.curve.ReachLength(), tolerance = 1e-10*crack.Length();
    for (size_t i = 0; i < crack.NumPieces(); i++)
      {
        auto & piece = crack.Piece(i);
        auto [nearer, farther] = std::minmax({ std::abs(crack.ArcLength(i)-tip.s), std::abs(crack.ArcLength(i+1)-tip.s) });
        if (nearer >= followed-tolerance)
          limit(Norm(Point(piece.Value(piece.Nearest(tip.point))-tip.point)), "another piece of the same crack");
        else if (farther > followed+tolerance)
          // a piece that turns back
          for (double s : piece.Samples(0.02))
            if (std::abs(crack.ArcLength(i)+s-tip.s) >= followed-tolerance)
              limit(0.98*Norm(Point(piece.PointAt(s)-tip.point)), "the same crack, which turns back");
      }
  }

  Frame<2> CrackedMesh :: FrameAt (size_t crack, Point x) const
  {
    Point t = cracks[crack].Tangent(cracks[crack].Nearest(x));
    return { Left(t), { t } };
  }

  size_t CrackedMesh :: CrackAt (const ElementCracks * element, Point x) const
  {
    if (element) return static_cast<const CutElement*>(element)->CrackAt(cracks, x).crack;
    return std::ranges::min_element(cracks, {}, [x] (auto & crack) { return crack.Nearest(x).distance; }) - cracks.begin();
  }

  std::vector<size_t> CrackedMesh :: ElementsOf (size_t crack) const
  {
    std::vector<size_t> elements;
    for (auto & location : Location(crack).Elements()) elements.push_back(location.element);
    return elements;
  }

  const CutElement * CrackedMesh :: Find (size_t element) const
  {
    auto it = cut_elements.find(element);
    return it == cut_elements.end() ? nullptr : &it->second;
  }

  shared_ptr<ngcore::BitArray> CrackedMesh :: CrackElements (std::optional<size_t> crack) const
  {
    if (crack) Checked(*crack);
    auto elements = make_shared<ngcore::BitArray>(mesh->GetNE(VOL));
    elements->Clear();
    for (auto & [element, cut] : cut_elements)
      if (!crack || cut.Find(*crack)) elements->SetBit(element);
    return elements;
  }
}
