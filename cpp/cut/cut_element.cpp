#include "cut/cut_element.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  namespace
  {
    Polygon CounterClockwise (const Triangle & t)
    {
      Polygon polygon(t.begin(), t.end());
      if (Cross(Point(t[1]-t[0]), Point(t[2]-t[0])) < 0) std::ranges::reverse(polygon);
      return polygon;
    }

    /// Of a crack at a point of its image in the straight triangle.
    double ArcLength (const Crack & crack, const ElementMap & map, const ElementChord & chord, double s)
    {
      Point p = chord.curve->PointAt(chord.here.piece, s);
      return &crack == chord.curve ? s : crack.ArcLength(crack.Nearest(map.Value(p)));
    }
  }

  CutElement :: CutElement (const ElementMap & map, const std::vector<Crack> & aall, const std::vector<ElementChord> & chords)
    : all(aall), corners(map.Corners()), division(CounterClockwise(corners), chords, geometric_tolerance*LongestEdge(corners))
  {
    h = LongestEdge(corners);
    sizes = division.Areas();
    for (auto & [number, s0, s1, plus, minus] : division.Facets())
      {
        auto & chord = chords[number];
        auto & crack = all[chord.crack];
        double from = ArcLength(crack, map, chord, s0), to = ArcLength(crack, map, chord, s1);
        size_t piece = &crack == chord.curve ? chord.here.piece : crack.PieceAt(0.5*(from+to));
        AddFacet(chord.crack, { piece, from, to }, plus, minus, LargerSideOf(chord, plus, minus));
      }
  }

  /// Beside a tip, where both sides belong to one part, by the straight line ahead of it. Of equals the plus side, so that no numbering decides.
  int CutElement :: LargerSideOf (const ElementChord & chord, size_t plus, size_t minus) const
  {
    double above = sizes[plus], below = sizes[minus];
    if (plus == minus)
      {
        above = below = 0;
        for (auto & t : Triangles())
          if (t.part == plus) (chord.curve->SideOf(Centre({ t.triangle.begin(), t.triangle.end() })) == Side::Plus ? above : below) += Area(t);
      }
    return above >= (1-1e-8)*below ? 1 : -1;
  }

  void CutElement :: AddFacet (size_t number, const Chord & chord, size_t plus, size_t minus, int larger_side)
  { facets.push_back({ { number, plus, minus, larger_side }, chord, chord.s1-chord.s0 }); }

  void CutElement :: AddAligned (size_t crack, const Chord & chord, size_t part, Side side, PartOfElement neighbour)
  {
    size_t beyond = NumParts() + (std::ranges::find(across, neighbour) - across.begin());
    if (beyond == NumParts()+across.size()) across.push_back(neighbour);
    bool is_plus = side == Side::Plus;
    AddFacet(crack, chord, is_plus ? part : beyond, is_plus ? beyond : part, int(side));
  }

  size_t CutElement :: PartAt (const ngfem::IntegrationPoint & ip) const
  {
    if (NumParts() == 1) return 0;
    return division.PartAt(Point(corners[2] + ip(0)*(corners[0]-corners[2]) + ip(1)*(corners[1]-corners[2])));
  }

  const ElementCrack & CutElement :: CrackAt (Point x) const
  {
    if (!IsShared()) return cracks[0];
    return *std::ranges::min_element(cracks, {}, [&] (auto & here) { return all[here.crack].Nearest(x).distance; });
  }

  const CrackFacet & CutElement :: FacetAt (Point x) const
  {
    if (facets.size() == 1) return facets[0];
    size_t crack = CrackAt(x).crack;
    double s = all[crack].ArcLength(all[crack].Nearest(x));
    return *std::ranges::min_element(facets, {}, [&] (auto & facet)
    {
      double off = std::max({ 0.0, facet.chord.s0-s, s-facet.chord.s1 });
      return std::pair(facet.crack != crack, off);
    });
  }

  void CutElement :: VisitFacets (const std::function<void(const CrackSides &, double)> & visit) const
  { for (auto & facet : facets) visit(facet, facet.length); }

  bool CutElement :: IsLarger (size_t part, std::optional<size_t> crack) const
  { return std::ranges::any_of(facets, [&] (auto & facet) { return facet.Larger() == part && (!crack || facet.crack == *crack); }); }

  bool CutElement :: IsLarger (const PartTriangle & t, std::optional<size_t> crack) const
  {
    return std::ranges::any_of(facets, [&] (auto & facet)
    {
      if (facet.Larger() != t.part || (crack && facet.crack != *crack)) return false;
      return facet.plus != facet.minus || int(all[facet.crack].SideOf(Centre({ t.triangle.begin(), t.triangle.end() }))) == facet.larger_side;
    });
  }
}
