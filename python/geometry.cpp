#include "convert.hpp"
#include <algorithm>

using namespace ngsxfem_contact;
using ngcomp::MeshAccess;

/// An item of *args as a Crack.
static const Crack & AsCrack (py::handle item, const char * who)
{
  if (!py::isinstance<Crack>(item))
    throw py::type_error(string(who) + ": " + string(py::repr(item)) + " is not a Crack; give cracks one by one, a list as " + who + "(..., *cracks)");
  return item.cast<const Crack &>();
}

static Point FinitePoint (Pair p)
{
  if (!std::isfinite(p.first) || !std::isfinite(p.second)) throw ngcore::Exception("Crack: the point " + ToString(ToPoint(p)) + " is not finite");
  return ToPoint(p);
}

static Crack JoinCracks (py::args parts, const string & name)
{
  std::vector<PiecePtr> pieces;
  for (auto part : parts)
    for (auto & piece : AsCrack(part, "Crack.Join").Pieces()) pieces.push_back(piece);
  return Crack(pieces).Named(name);
}

static void ExportCrack (py::module & m)
{
  py::enum_<Side>(m, "Side", "The side of a crack: Plus to the left of its direction of travel, Minus to the right.").value("Minus", Side::Minus).value("Plus", Side::Plus);
  py::class_<Crack>(m, "Crack",
      "An oriented curve Γ_C in the plane, in the coordinates of the mesh. Its normal n points to the left of the direction of travel t, from the\n"
      "minus to the plus side. Where it ends inside the body it has a tip, on the boundary a mouth,\non another crack a junction; a closed one has no ends.\n\nParameters\n"
      "----------\npoints\n"
      "    The corners (x, y) of a polyline, two or more. Crack.Arc, Crack.Spline, Crack.Curve and Crack.LevelSet make true curves, Crack.Join one crack of\n"
      "    several.\nname\n    What it is called, in arguments that ask for a crack, in messages and tables; default nothing.\n\nRaises\n------\nException\n"
      "    For coordinates that are not finite, points that coincide, and a curve that touches or crosses itself elsewhere than at its two ends.\n\n"
      "Examples\n--------\n>>> crack = Crack([(0, 0), (3, 4)])\n>>> crack.length, crack.points\n"
      "(5.0, [(0.0, 0.0), (3.0, 4.0)])\n>>> crack.SideOf((0, 1))\n<Side.Plus: 1>")
    .def(py::init(&ToCrack), py::arg("points"), py::arg("name") = "")
    .def_static("Arc", [] (Pair start, Pair through, Pair end, const string & name)
                { return Crack({ MakeArc(ToPoint(start), ToPoint(through), ToPoint(end)) }).Named(name); },
                py::arg("start"), py::arg("through"), py::arg("end"), py::arg("name") = "",
                "The circular arc from start to end through a third point. Raises an Exception for three points on a line.")
    .def_static("Join", &JoinCracks, py::arg("name") = "", "Cracks end to end as one: a kink where the direction jumps. Raises an Exception for a gap.")
    .def_static("OfPieces", &CrackOfPieces, py::arg("pieces"), py::arg("name") = "",
                "Pieces (kind, points): ('segment', [a, b]), ('arc', [start, through, end]), ('cubic', [p0, d0, p1, d1]) with values and derivatives at t = 0 and 1,\n"
                "('ellipse', [centre, a, b, (t0, t1)]): centre + cos(t) a + sin(t) b.")
    .def_property_readonly("name", &Crack::Name, "What it is called in arguments, messages and tables; empty: nothing.")
    .def_property_readonly("points", &PointsOf, "The points of a polyline; of a curve the ends of its pieces.")
    .def_property_readonly("pieces", &PiecesOf, "What OfPieces takes.")
    .def_property_readonly("kinks", [] (const Crack & c)
         {
           std::vector<double> kinks;
           for (size_t i = 0; i <= c.NumPieces(); i++) if (c.IsKink(i)) kinks.push_back(c.ArcLength(i));
           return kinks;
         }, "Arc lengths at which the direction jumps; of a polyline all inner points.")
    .def_property_readonly("closed", &Crack::IsClosed, "Whether the crack ends where it starts, without a tip or a mouth.")
    .def_property_readonly("length", &Crack::Length, "The arc length from end to end, in the user's unit of length.")
    .def("PointAt", [] (const Crack & c, double s) { return ToPair(c.PointAt(c.Checked(s))); }, py::arg("s"), "The point (x, y) at arc length s, 0 ≤ s ≤ length.")
    .def("TangentAt", [] (const Crack & c, double s) { s = c.Checked(s); return ToPair(c.Tangent(c.PieceAt(s), s)); }, py::arg("s"), "The unit tangent at arc length s.")
    .def("CurvatureAt", [] (const Crack & c, double s) { s = c.Checked(s); size_t i = c.PieceAt(s); return c.Piece(i).Curvature(s-c.ArcLength(i)); },
         py::arg("s"), "The curvature at arc length s, > 0 where the crack turns left.")
    .def("Outline", [] (const Crack & c, double turn) { return ToPairs(c.Outline(turn)); }, py::arg("turn") = Crack::turn_in_pictures,
         "Points for pictures: a polyline that follows the crack, with kinks of about the angle turn where it is curved.")
    .def("ArcLength", [] (const Crack & c, Pair p) { return c.ArcLength(c.Nearest(FinitePoint(p))); }, py::arg("point"), "Arc length of the nearest point of the crack.")
    .def("Distance", [] (const Crack & c, Pair p) { return c.Nearest(FinitePoint(p)).distance; }, py::arg("point"), "Distance to the nearest point of the crack.")
    .def("SideOf", [] (const Crack & c, Pair p) { return c.SideOf(FinitePoint(p)); }, py::arg("point"),
         "The Side of a point (x, y) with respect to the crack and, beyond its ends, to their straight extensions; Plus on the crack itself.")
    .def_property_readonly("side", [] (const Crack & c) -> shared_ptr<CoefficientFunction> { return make_shared<CrackSide>(c); },
                           "H: +1 on the plus side, -1 on the minus side, a CoefficientFunction.")
    .def("__repr__", [] (const Crack & c)
         {
           auto name = c.Name().empty() ? py::str("") : py::str(", name={!r}").format(c.Name());
           return c.IsPolyline() ? py::str("Crack({}{})").format(PointsOf(c), name) : py::str("Crack.OfPieces({}{})").format(PiecesOf(c), name);
         })
    .def(py::pickle([] (const Crack & c) { return py::make_tuple(PiecesOf(c), c.Name()); },
                    [] (py::tuple state) { return CrackOfPieces(state[0].cast<PieceDescriptions>(), state[1].cast<string>()); }));
  ngcore::RegisterPyArchiveCaster<Crack>();               // coefficient functions hold cracks and bodies, and are pickled with them
}

static std::vector<Pair> OutlineOf (const PartTriangle & part, double turn)
{
  if (!part.curved) return ToPairs(std::vector<Point>(part.triangle.begin(), part.triangle.end()));
  auto & [curve, chord] = *part.curved;
  auto [piece, s0, s1] = chord;
  double largest = 0;
  for (int i = 0; i <= 4; i++) largest = std::max(largest, std::abs(curve->Piece(piece).Curvature(s0 + 0.25*i*(s1-s0) - curve->ArcLength(piece))));
  int n = int(std::ceil(1e-3 + largest*(s1-s0)/turn));
  std::vector<Pair> points { ToPair(part.triangle[0]) };
  for (int i = 0; i <= n; i++) points.push_back(ToPair(curve->PointAt(piece, s0 + double(i)/n*(s1-s0))));
  return points;
}

static void ExportLocation (py::module & m)
{
  py::enum_<ElementKind>(m, "ElementKind", "How a crack meets an element: Uncut, Cut through, Tip inside, or Aligned with an edge that the element carries.")
    .value("Uncut", ElementKind::Uncut).value("Cut", ElementKind::Cut).value("Tip", ElementKind::Tip).value("Aligned", ElementKind::Aligned);
  py::class_<Degeneracy>(m, "Degeneracy", "The special positions of a crack in an element; each holds to within 1e-10 of the smallest element beside the crack.")
    .def_readonly("through_vertex", &Degeneracy::through_vertex, "Whether the crack passes through a vertex of the element.")
    .def_readonly("along_edge", &Degeneracy::along_edge, "Whether it runs along an edge.")
    .def_readonly("tip_on_edge", &Degeneracy::tip_on_edge, "Whether it ends on an edge.")
    .def_readonly("tip_on_vertex", &Degeneracy::tip_on_vertex, "Whether it ends in a vertex.")
    .def_readonly("kink_inside", &Degeneracy::kink_inside, "Whether its direction jumps inside the element.");
  py::class_<ElementLocation>(m, "ElementLocation", "Where an element lies with respect to the crack that meets it.")
    .def_readonly("element", &ElementLocation::element, "The number of the element in the mesh.")
    .def_readonly("kind", &ElementLocation::kind, "Its ElementKind: Cut, Tip or Aligned.")
    .def_readonly("degeneracy", &ElementLocation::degeneracy, "The special positions that hold.")
    .def_readonly("h", &ElementLocation::h, "The longest edge h_T, in the user's unit of length.")
    .def_readonly("curved", &ElementLocation::curved, "Whether the element is curved. Its triangle is then that of its corners.")
    .def_property_readonly("chords", [] (const ElementLocation & l)
         {
           std::vector<Pair> chords;
           for (auto & chord : l.chords) chords.push_back({ chord.s0, chord.s1 });
           return chords;
         }, "Arc lengths between which the crack is in the element.")
    .def_property_readonly("arclength", [] (const ElementLocation & l) { return std::pair(l.S0(), l.S1()); }, "Arc lengths at which the crack enters and leaves it.")
    .def_property_readonly("triangle", [] (const ElementLocation & l) { return ToPairs(l.triangle); }, "The three corners (x, y) of the element.");
  py::class_<PartTriangle>(m, "PartTriangle", "A triangle inside a connected part of an element; of a curved element in its straight triangle.")
    .def_property_readonly("triangle", [] (const PartTriangle & p) { return ToPairs(p.triangle); }, "The three corners (x, y).")
    .def_readonly("part", &PartTriangle::part, "The number of the part in its element, from 0.")
    .def_property_readonly("area", [] (const PartTriangle & p) { return Area(p); }, "Its area; with a curved side that of the cone over it.")
    .def("Outline", &OutlineOf, py::arg("turn") = Crack::turn_in_pictures,
         "The corners, and between the last two points of the curved side, between which it turns by about turn.");
  py::class_<CrackFacet>(m, "CrackFacet", "A stretch of a crack in an element, between two parts: those of the element, and behind them those of neighbours across its edges.")
    .def_readonly("crack", &CrackFacet::crack, "The number of the crack.")
    .def_readonly("plus", &CrackFacet::plus, "The part on its plus side.")
    .def_readonly("minus", &CrackFacet::minus, "The part on its minus side, the same one beside a tip.")
    .def_property_readonly("larger", [] (const CrackFacet & f) { return Side(f.larger_side); }, "The Side of the larger one of the two, of equal ones Plus: the one whose stress is R_h.")
    .def_property_readonly("arclength", [] (const CrackFacet & f) { return std::pair(f.chord.s0, f.chord.s1); }, "Where it starts and ends on the crack.");
  py::enum_<EndKind>(m, "EndKind", "An end of a crack: a Tip inside the body, a Mouth on its boundary, or a Junction on another crack, or where a closed crack starts.")
    .value("Tip", EndKind::Tip).value("Mouth", EndKind::Mouth).value("Junction", EndKind::Junction);
  py::class_<CrackEnd>(m, "CrackEnd", "An end of a crack in a mesh.")
    .def_readonly("kind", &CrackEnd::kind, "Its EndKind: Tip inside the body, Mouth on its boundary, Junction on another crack.")
    .def_readonly("s", &CrackEnd::s, "Its arc length: 0 or the length of the crack.")
    .def_property_readonly("point", [] (const CrackEnd & e) { return ToPair(e.point); }, "Its place (x, y).");
  py::class_<Tip>(m, "Tip", "A crack end inside the body: point, crack number, direction ahead, and the clearance that a disk of singular functions has.")
    .def_readonly("crack", &Tip::crack, "The number of its crack in body.cracks.")
    .def_readonly("s", &Tip::s, "Its arc length: 0 or the length of the crack.")
    .def_readonly("clearance", &Tip::clearance,
                  "The largest radius of a disk of singular functions: the least of the distances to the boundary, to other cracks and to the next kink, of\n"
                  "half the distance to other tips and of half the radius of curvature.")
    .def_readonly("limit", &Tip::limit, "What sets the clearance, in words.")
    .def_readonly("distances", &Tip::distances, "Pairs (distance, what is there, in words): of the boundary of the body and of the other cracks.")
    .def_property_readonly("point", [] (const Tip & t) { return ToPair(t.point); }, "Its place (x, y).")
    .def_property_readonly("ahead", [] (const Tip & t) { return ToPair(t.ahead); }, "The unit direction in which the crack would grow straight on.")
    .def("__repr__", [] (const Tip & t) { return py::str("Tip(point={}, crack={}, clearance={:.6g})").format(ToPair(t.point), t.crack, t.clearance); });
}

static py::tuple OnCrack (const CrackedMesh & body, const CrackKey & crack, const std::vector<double> & arclengths)
{
  std::vector<size_t> elements;
  std::vector<double> xi, eta;
  for (auto & [element, point] : body.OnCrack(NumberOf(body, crack), arclengths))
    {
      elements.push_back(element);
      xi.push_back(point(0));
      eta.push_back(point(1));
    }
  return py::make_tuple(elements, xi, eta);
}

static shared_ptr<CrackedMesh> MakeCrackedMesh (shared_ptr<MeshAccess> mesh, const std::vector<Crack> & cracks, bool is_part = false)
{ return make_shared<CrackedMesh>(mesh, cracks, is_part); }

static void ExportCrackedMesh (py::module & m)
{
  py::class_<CrackedMesh, shared_ptr<CrackedMesh>>(m, "CrackedMesh",
      "A mesh with its cracks; ngsxfem_contact.CrackedMesh says more.")
    .def(py::init([] (shared_ptr<MeshAccess> mesh, py::args cracks, bool is_part)
                  {
                    std::vector<Crack> all;
                    for (auto crack : cracks) all.push_back(AsCrack(crack, "CrackedMesh"));
                    return MakeCrackedMesh(mesh, all, is_part);
                  }), py::arg("mesh"), py::kw_only(), py::arg("is_part") = false)
    .def_property_readonly("mesh", &CrackedMesh::GetMesh, "The mesh of NGSolve.")
    .def_property_readonly("cracks", &CrackedMesh::Cracks, "The Cracks, in the order in which they were given, with their ends fitted to the body.")
    .def_property_readonly("tips", &CrackedMesh::Tips, "The Tips of all cracks: for each crack that of its start, then that of its end, where they lie inside the body.")
    .def_property_readonly("notes", &CrackedMesh::Notes, "Sentences on the ends that were cut off or moved, none where all is as given.")
    .def("CheckMesh", &CrackedMesh::CheckMesh, "Raises an Exception if the mesh was refined, curved or deformed after the cracks were located in it.")
    .def("CrackNumber", [] (const CrackedMesh & b, const CrackKey & c) { return NumberOf(b, c); }, py::arg("crack"),
         "The number of a crack, from 0, by its name. Raises ValueError for a name that no crack has.")
    .def("Meetings", [] (const CrackedMesh & b, const CrackKey & c) { return b.Location(NumberOf(b, c)).Meetings(); }, py::arg("crack"),
         "Arc lengths at which a crack meets others, its junctions among them.")
    .def("Ends", [] (const CrackedMesh & b, const CrackKey & c) { return b.Location(NumberOf(b, c)).Ends(); }, py::arg("crack"), "The two CrackEnds of a crack, its start first.")
    .def("Elements", [] (const CrackedMesh & b, const CrackKey & c) { b.CheckMesh(); return b.Location(NumberOf(b, c)).Elements(); }, py::arg("crack"), "The ElementLocations of the elements that a crack meets.")
    .def("Parts", [] (py::object self, size_t element)
         {
           auto & body = self.cast<const CrackedMesh &>();
           body.CheckMesh();
           py::list parts;
           if (auto cut = body.Find(element))
             for (auto & part : cut->Triangles())
               {
                 parts.append(py::cast(part));
                 py::detail::keep_alive_impl(parts[parts.size()-1], self);      // its curved side belongs to the body
               }
           return parts;
         }, py::arg("element"), "The PartTriangles into which the cracks divide an element, a list; none if no crack meets it.")
    .def("PartSizes", [] (const CrackedMesh & b, size_t element)
         {
           b.CheckMesh();
           auto cut = b.Find(element);
           return cut ? cut->sizes : std::vector<double> { 1 };
         }, py::arg("element"), "The areas of the connected parts of an element (of a curved one in its straight triangle); [1] if no crack meets it.")
    .def("Facets", [] (const CrackedMesh & b, size_t element)
         {
           b.CheckMesh();
           auto cut = b.Find(element);
           return cut ? cut->Facets() : std::vector<CrackFacet>();
         }, py::arg("element"), "The CrackFacets in an element, and on those of its edges that it carries for a neighbour, too.")
    .def("Links", &CrackedMesh::Links, py::arg("edge"), "Pairs of parts of the two elements beside an edge of the mesh that hang together across it.")
    .def("CracksOf", [] (const CrackedMesh & b, size_t element)
         {
           std::vector<size_t> numbers;
           if (auto cut = b.Find(element)) for (auto & here : cut->cracks) numbers.push_back(here.crack);
           return numbers;
         }, py::arg("element"), "Numbers of the cracks that meet an element.")
    .def("CutBoundaryElements", [] (const CrackedMesh & b, const CrackKey & c)
         {
           std::vector<size_t> elements;
           for (auto & [nr, edge] : b.Location(NumberOf(b, c)).BoundaryEdges()) elements.push_back(nr);
           return elements;
         }, py::arg("crack"), "Numbers of the boundary elements that a crack cuts.")
    .def("CutBoundaryPoints", [] (const CrackedMesh & b, const CrackKey & c)
         {
           std::vector<std::pair<size_t, Pair>> points;
           for (auto & [nr, edge] : b.Location(NumberOf(b, c)).BoundaryEdges()) points.push_back({ nr, ToPair(edge.crossing) });
           return points;
         }, py::arg("crack"), "The boundary elements that a crack cuts, with the points (x, y) at which it cuts them: a list of (number, point).")
    .def("CrackElements", [] (const CrackedMesh & b, const std::optional<CrackKey> & c) { return b.CrackElements(c ? std::optional(NumberOf(b, *c)) : std::nullopt); }, py::arg("crack"), "BitArray of the elements that carry a part of a crack (None: of any).")
    .def("MeshNodes", [] (const CrackedMesh & b, const CrackKey & c, bool kinks) { return MeshNodes(b, NumberOf(b, c), kinks); }, py::arg("crack"), py::arg("kinks"), "Arc lengths at which the crack meets mesh edges, and of its ends (and kinks).")
    .def("OnCrack", &OnCrack, py::arg("crack"), py::arg("arclengths"), "(elements, xi, eta): element numbers and reference coordinates of points on a crack. Raises an Exception for arc lengths beyond its ends.")
    .def_property_readonly("normal", [] (shared_ptr<CrackedMesh> b) -> shared_ptr<CoefficientFunction> { return make_shared<CrackFrame<CrackedMesh>>(b, false); },
                           "The unit normal n on the cracks, from the minus to the plus side: a CoefficientFunction, for forms over dcrack.")
    .def_property_readonly("tangent", [] (shared_ptr<CrackedMesh> b) -> shared_ptr<CoefficientFunction> { return make_shared<CrackFrame<CrackedMesh>>(b, true); },
                           "The unit tangent t on the cracks, in the direction of travel: a CoefficientFunction, for forms over dcrack.")
    .def_property_readonly("larger_side", [] (shared_ptr<CrackedMesh> b) -> shared_ptr<CoefficientFunction>
         { return make_shared<CrackLabel<CrackedMesh>>(b, Label::LargerSide); },
         "On the cracks +1 or -1, the side of the larger part of the element, whose stress is R_h: a CoefficientFunction.")
    .def("InLargerPart", [] (shared_ptr<CrackedMesh> b, std::optional<std::string> side) -> shared_ptr<CoefficientFunction>
         {
           if (!side) return make_shared<LargerPart>(b);
           if (*side != "plus" && *side != "minus") throw py::value_error("CrackedMesh.InLargerPart: side='" + *side + "' is neither 'plus' nor 'minus'");
           return make_shared<CrackLabel<CrackedMesh>>(b, *side == "plus" ? Label::LargerIsPlus : Label::LargerIsMinus);
         }, py::arg("side"),
         "1 in the larger parts beside the cracks, 0 elsewhere, a CoefficientFunction: by the position of a point (None), on the cracks for their \"plus\" or \"minus\" side.\n"
         "\nRaises\n------\nValueError\n    For another side.")
    .def("LimitOnCrack", [] (shared_ptr<CrackedMesh> b, shared_ptr<CoefficientFunction> function, int side) -> shared_ptr<CoefficientFunction>
         { return make_shared<CrackLimit<CrackedMesh>>(b, function, side); }, py::arg("function"), py::arg("side"),
         "The limit of a function on the cracks from the plus (1) or minus side (-1), or that of the larger part (0): a CoefficientFunction, for functions that jump there.")
    .def_property_readonly("crack_number", [] (shared_ptr<CrackedMesh> b) -> shared_ptr<CoefficientFunction>
         { return make_shared<CrackLabel<CrackedMesh>>(b, Label::CrackNumber); },
         "On the cracks the number of the crack: a CoefficientFunction.")
    .def_property_readonly("dx", [] (shared_ptr<CrackedMesh> b) { return CutDifferentialSymbol(Measure { b, {} }, VOL); }, "The measure on the body without the cracks.")
    .def_property_readonly("ds", [] (shared_ptr<CrackedMesh> b) { return CutDifferentialSymbol(Measure { b, {} }, BND); }, "The measure on the boundary, divided at mouths.")
    .def_property_readonly("dlarger", [] (shared_ptr<CrackedMesh> b) { return CutDifferentialSymbol::OnCracks(Measure { b, { Domain::Larger } }); }, "The measure on the larger part of each element that a crack meets.")
    .def_property_readonly("dcrack", [] (shared_ptr<CrackedMesh> b) { return CutDifferentialSymbol::OnCracks(Measure { b, { Domain::Crack } }); }, "The measure on the cracks.")
    .def(py::pickle([] (const CrackedMesh & b) { return py::make_tuple(b.GetMesh(), b.Cracks()); },
                    [] (py::tuple state) { return MakeCrackedMesh(state[0].cast<shared_ptr<MeshAccess>>(), state[1].cast<std::vector<Crack>>()); }));
  ngcore::RegisterPyArchiveCaster<CrackedMesh>();
}

void ExportGeometry (py::module & m)
{
  ExportCrack(m);
  ExportLocation(m);
  ExportCrackedMesh(m);
  m.def("ElementsBeside", [] (const MeshAccess & mesh, const Crack & crack) { return ElementsBeside(mesh, crack); }, py::arg("mesh"), py::arg("crack"),
        "Numbers of the elements of a mesh that a crack may meet, by boxes around both.");
  m.def("GlobalVertexNumbers", [] (const MeshAccess & mesh)
        {
          std::vector<size_t> numbers(mesh.GetNV());
          for (size_t v = 0; v < numbers.size(); v++) numbers[v] = mesh.GetGlobalVertexNum(v);
          return numbers;
        }, py::arg("mesh"), "Of the vertices of a mesh that processes share their numbers in the whole mesh, on which all agree.");
  m.def("NumKeptRules", &NumKeptRules, py::arg("body"), "How many sets of rules of a body, for different disks around its tips, spaces, measures and forms keep.");
}
