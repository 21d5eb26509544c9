#include "convert.hpp"
#include <pybind11/numpy.h>
#include "cut/height_field.hpp"
#include "forms/front_tube.hpp"

using namespace ngsxfem_contact;
using ngcomp::MeshAccess;

using Triple = std::array<double,3>;
static Triple ToTriple (Point3 p) { return { p(0), p(1), p(2) }; }
static Point3 ToPoint (Triple p) { return Point3(p[0], p[1], p[2]); }

static std::array<Triple,2> AxesOf (const Plane & plane) { return { ToTriple(plane.axes[0]), ToTriple(plane.axes[1]) }; }

static std::vector<PieceDescriptions> PiecesOf (const Sheet & s)
{
  std::vector<PieceDescriptions> all;
  for (auto & loop : s.Loops()) all.push_back(PiecesOf(loop));
  return all;
}

static Sheet MakeSheet (const std::vector<Crack> & loops, Triple origin, std::array<Triple,2> axes, std::optional<Crack> curve, std::optional<HeightField> heights)
{
  std::array<Point3,2> vectors { ToPoint(axes[0]), ToPoint(axes[1]) };
  if (curve && heights) throw ngcore::Exception("Sheet: give either a curve that is extruded, or heights over the plane");
  if (heights) return Sheet(std::make_shared<GraphSurface>(ToPoint(origin), vectors, *heights), loops);
  if (curve) return Sheet(std::make_shared<ExtrudedCurve>(*curve, ToPoint(origin), vectors), loops);
  return Sheet(ToPoint(origin), vectors, loops);
}

static std::shared_ptr<const ExtrudedCurve> ExtrusionOf (const Sheet & s) { return std::dynamic_pointer_cast<const ExtrudedCurve>(s.GetSurface()); }

static std::shared_ptr<const GraphSurface> GraphOf (const Sheet & s) { return std::dynamic_pointer_cast<const GraphSurface>(s.GetSurface()); }

static const Plane & PlaneBelow (const Sheet & s) { return s.IsPlanar() ? s.GetPlane() : s.GetSurface()->GetPlane(); }

static void CheckPlanar (const Sheet & s, const char * what)
{
  if (!s.IsPlanar()) throw ngcore::Exception(string("Sheet: a curved sheet has no ") + what + " of its own; ask FrameAt, Flat and PointAt");
}

void ExportFrontDemand (py::module & m)
{
  FrontDemand usual;
  py::class_<FrontDemand>(m, "FrontDemand",
      "What functions that are singular at the fronts of a solid ask of the rules of a measure: `body.dx(fronts=FrontDemand())`.\n\nParameters\n----------\n"
      "radius\n    Elements that come nearer to a front get rules of their own, beside those that share a vertex with an element that a front is in.\nalong, angular, radial\n"
      "    Gauss points in s, in θ, in √r, in elements that a front is in, for each interval on which their slices normal to the front are smooth.\norder\n"
      "    Of Gauss beside the front, in parts of an element.\nbeta\n    These parts keep the multiple beta of their size from the front.")
    .def(py::init([] (double radius, int along, int angular, int radial, int order, double beta)
         { return FrontDemand { radius, along, angular, radial, order, beta }; }),
         py::arg("radius") = usual.radius, py::arg("along") = usual.along, py::arg("angular") = usual.angular, py::arg("radial") = usual.radial, py::arg("order") = usual.order, py::arg("beta") = usual.beta)
    .def_readonly("radius", &FrontDemand::radius, "Elements that come nearer to a front get rules of their own, beside those around it.")
    .def_readonly("along", &FrontDemand::along, "Gauss points in s.")
    .def_readonly("angular", &FrontDemand::angular, "Gauss points in the angle.")
    .def_readonly("radial", &FrontDemand::radial, "Gauss points in √r.")
    .def_readonly("order", &FrontDemand::order, "The order of Gauss beside the front.")
    .def_readonly("beta", &FrontDemand::beta, "The least distance of a part from the front, relative to its size.")
    .def(py::pickle([] (const FrontDemand & d) { return py::make_tuple(d.radius, d.along, d.angular, d.radial, d.order, d.beta); },
                    [] (py::tuple t) { return FrontDemand { t[0].cast<double>(), t[1].cast<int>(), t[2].cast<int>(), t[3].cast<int>(), t[4].cast<int>(), t[5].cast<double>() }; }));
}

static void ExportHeightField (py::module & m)
{
  py::class_<HeightField>(m, "HeightField",
      "Heights f(p1, p2) over a plane, a sum of cubic B-splines on a regular grid: two times continuously differentiable, linear beyond the grid. Sheet.FromTriangles fits one.\n\n"
      "Parameters\n----------\nlower\n    (p1, p2) of the first knot of the grid.\nspacing\n    The distances of its knots in both directions.\ncoefficients\n"
      "    (n1, n2), of each B-spline: three more than intervals in each direction.\n\nRaises\n------\nException\n    For fewer than 4 coefficients in a direction, and numbers that are not finite.")
    .def(py::init([] (std::array<double,2> lower, std::array<double,2> spacing, py::array_t<double, py::array::c_style | py::array::forcecast> coefficients)
         {
           if (coefficients.ndim() != 2) throw ngcore::Exception("HeightField: the coefficients must be a matrix");
           HeightField field { Point(lower[0], lower[1]), Point(spacing[0], spacing[1]), { size_t(coefficients.shape(0)), size_t(coefficients.shape(1)) },
                               { coefficients.data(), coefficients.data()+coefficients.size() } };
           field.Check();
           return field;
         }), py::arg("lower"), py::arg("spacing"), py::arg("coefficients"))
    .def("At", [] (const HeightField & f, double p1, double p2) { auto at = f.At(Point(p1, p2)); return std::tuple(at[0], at[1], at[2]); }, py::arg("p1"), py::arg("p2"),
         "The height, and its derivatives by p1 and p2.")
    .def_property_readonly("lower", [] (const HeightField & f) { return ToPair(f.lower); }, "(p1, p2) of the first knot of the grid.")
    .def_property_readonly("spacing", [] (const HeightField & f) { return ToPair(f.spacing); }, "The distances of its knots in both directions.")
    .def_property_readonly("coefficients", [] (const HeightField & f) { return py::array_t<double>({ f.size[0], f.size[1] }, f.coefficients.data()); },
                           "(n1, n2), of each B-spline.")
    .def("__repr__", [] (const HeightField & f) { return py::str("HeightField({} x {} coefficients)").format(f.size[0], f.size[1]); })
    .def(py::pickle([] (const HeightField & f) { return py::make_tuple(ToPair(f.lower), ToPair(f.spacing), f.size, f.coefficients); },
                    [] (py::tuple t)
                    {
                      auto lower = t[0].cast<std::array<double,2>>(), spacing = t[1].cast<std::array<double,2>>();
                      return HeightField { Point(lower[0], lower[1]), Point(spacing[0], spacing[1]), t[2].cast<std::array<size_t,2>>(), t[3].cast<std::vector<double>>() };
                    }));
}

static void ExportSheet (py::module & m)
{
  py::class_<Sheet>(m, "Sheet",
      "A crack in space: the part of a plane that closed curves bound. Its unit normal n = a1 × a2 points from the minus to the plus side. With a curve it is the part of the\n"
      "curved surface that the curve of the plane sweeps along n = a1 × a2, and the normal is that of the curve.\n"
      "Sheet.Disk, Sheet.Ellipse, Sheet.Polygon, Sheet.Ring and Sheet.Extrude make common ones. What lies outside of the body is cut off: a sheet that reaches the boundary of the\n"
      "body has a mouth there, inside the body it has a front.\n\nParameters\n----------\nloops\n"
      "    Closed Cracks in the coordinates (p1, p2) of the plane, x = origin + p1 a1 + p2 a2: the outer curve first, then those of holes, in any direction of travel.\n"
      "origin\n    A point (x, y, z) of the plane.\naxes\n"
      "    Two directions (x, y, z), made perpendicular and of unit length.\ncurve\n"
      "    An open Crack in the plane of the axes. Then the loops are curves in the coordinates p1, the distance along a1 × a2, and p2, the arc length on the curve,\n"
      "    which goes on straight beyond its ends. Fronts keep from its kinks.\nheights\n"
      "    A HeightField over the plane: the sheet lies at these heights over what the loops bound, and its normal is on the side of a1 × a2.\n\nRaises\n------\nException\n"
      "    For loops that are not closed or meet each other, for holes that lie outside, for axes that are parallel, and for a curve that is closed.\n\n"
      "Examples\n--------\n>>> square = Crack([(0, 0), (2, 0), (2, 2), (0, 2), (0, 0)])\n>>> sheet = Sheet([square], origin=(0, 0, 1))\n"
      ">>> sheet.normal, sheet.area\n((0.0, 0.0, 1.0), 4.0)")
    .def(py::init(&MakeSheet), py::arg("loops"), py::arg("origin") = Triple { 0, 0, 0 }, py::arg("axes") = std::array<Triple,2> { Triple { 1, 0, 0 }, Triple { 0, 1, 0 } }, py::arg("curve") = py::none(), py::arg("heights") = py::none())
    .def_property_readonly("loops", [] (const Sheet & s) { return s.Loops(); }, "The curves in the plane, of a curved sheet in its coordinates (p1, p2), with the sheet to their right: the outer one, then those of holes.")
    .def_property_readonly("curve", [] (const Sheet & s) { return ExtrusionOf(s) ? std::optional(ExtrusionOf(s)->Curve()) : std::nullopt; }, "The Crack that is extruded, or None.")
    .def_property_readonly("heights", [] (const Sheet & s) { return GraphOf(s) ? std::optional(GraphOf(s)->Field()) : std::nullopt; }, "The HeightField over the plane, or None.")
    .def_property_readonly("planar", &Sheet::IsPlanar, "Whether it lies in a plane.")
    .def_property_readonly("origin", [] (const Sheet & s) { auto p = PlaneBelow(s).origin; return std::tuple(p(0), p(1), p(2)); }, "The point (x, y, z) of the plane with p1 = p2 = 0; of a curved sheet the origin of the plane of its curve.")
    .def_property_readonly("axes", [] (const Sheet & s) { return AxesOf(PlaneBelow(s)); }, "The unit vectors a1 and a2 of the plane's coordinates; of a curved sheet those of the plane of its curve.")
    .def_property_readonly("normal", [] (const Sheet & s) { CheckPlanar(s, "normal"); auto p = s.GetPlane().normal; return std::tuple(p(0), p(1), p(2)); },
                           "The unit normal n, from the minus to the plus side.\n\nRaises\n------\nException\n    Of a curved sheet, where it is not one vector.")
    .def_property_readonly("name", [] (const Sheet &) { return string(); }, "Empty: sheets have numbers only.")
    .def_property_readonly("area", &Sheet::Area, "Its area, also of what lies outside of a body; of one with heights that of its projection.")
    .def("Contains", [] (const Sheet & s, Triple p) { return s.Contains(s.GetPlane().Project(s.Flat(ToPoint(p)))); }, py::arg("point"), "Whether the foot of a point (x, y, z) on the plane, or the nearest point of the curved surface, lies in the sheet.")
    .def("Flat", [] (const Sheet & s, Triple p)
         {
           Point3 flat = s.Flat(ToPoint(p));
           Point at = s.GetPlane().Project(flat);
           return std::tuple(at(0), at(1), s.GetPlane().Height(flat));
         }, py::arg("point"), "(p1, p2, height) of a point (x, y, z): the coordinates of its foot, and its distance, positive on the plus side.")
    .def("PointAt", [] (const Sheet & s, double p1, double p2) { return ToTriple(s.PointAt(Point(p1, p2))); }, py::arg("p1"), py::arg("p2"), "The point (x, y, z) with coordinates p1, p2.")
    .def("FrameAt", [] (const Sheet & s, double p1, double p2)
         {
           auto frame = s.FrameAt(Point(p1, p2));
           return std::array { ToTriple(frame[0]), ToTriple(frame[1]), ToTriple(frame[2]) };
         }, py::arg("p1"), py::arg("p2"), "The unit normal and the unit tangents along p1 and p2 at the point with coordinates p1, p2.")
    .def("__repr__", [] (const Sheet & s) -> py::str
         {
           auto & plane = PlaneBelow(s);
           if (s.IsPlanar()) return py::str("Sheet({}, origin={}, axes={})").format(s.Loops(), ToTriple(plane.origin), AxesOf(plane));
           if (GraphOf(s)) return py::str("Sheet({}, origin={}, axes={}, heights={})").format(s.Loops(), ToTriple(plane.origin), AxesOf(plane), GraphOf(s)->Field());
           return py::str("Sheet({}, origin={}, axes={}, curve={})").format(s.Loops(), ToTriple(plane.origin), AxesOf(plane), ExtrusionOf(s)->Curve());
         })
    .def(py::pickle([] (const Sheet & s)
                    {
                      auto & plane = PlaneBelow(s);
                      auto state = py::make_tuple(PiecesOf(s), ToTriple(plane.origin), AxesOf(plane));
                      if (GraphOf(s)) return py::tuple(state + py::make_tuple(py::none(), GraphOf(s)->Field()));
                      return s.IsPlanar() ? state : py::tuple(state + py::make_tuple(PiecesOf(ExtrusionOf(s)->Curve())));
                    },
                    [] (py::tuple state)
                    {
                      std::vector<Crack> loops;
                      for (auto & pieces : state[0].cast<std::vector<PieceDescriptions>>()) loops.push_back(CrackOfPieces(pieces, ""));
                      std::optional<Crack> curve;
                      std::optional<HeightField> heights;
                      if (state.size() == 4) curve = CrackOfPieces(state[3].cast<PieceDescriptions>(), "");
                      if (state.size() == 5) heights = state[4].cast<HeightField>();
                      return MakeSheet(loops, state[1].cast<Triple>(), state[2].cast<std::array<Triple,2>>(), curve, heights);
                    }));
}

static double Checked (const Front & f, double s) { return f.Curve().Checked(s); }

static void ExportFront (py::module & m)
{
  py::class_<Front>(m, "Front",
      "Where a sheet ends inside the body: a curve C(s) with the frame e1 ahead, out of the sheet, e2 = n and e3 = e1 × e2, the direction in which s grows.")
    .def_property_readonly("sheet", &Front::SheetNumber, "The number of its sheet in body.cracks.")
    .def_property_readonly("loop", &Front::Loop, "The number of the curve of the sheet that it is a part of.")
    .def_property_readonly("closed", &Front::IsClosed, "Whether it is a whole closed curve; else it ends on the boundary of the body.")
    .def_property_readonly("length", &Front::Length, "The arc length, in the user's unit of length.")
    .def_property_readonly("corners", &Front::Corners, "Arc lengths at which its direction jumps.")
    .def("PointAt", [] (const Front & f, double s) { return ToTriple(f.PointAt(Checked(f, s))); }, py::arg("s"), "The point (x, y, z) at arc length s, 0 ≤ s ≤ length.")
    .def("FrameAt", [] (const Front & f, double s)
         {
           auto frame = f.FrameAt(Checked(f, s));
           return std::array { ToTriple(frame[0]), ToTriple(frame[1]), ToTriple(frame[2]) };
         }, py::arg("s"), "The unit vectors e1, e2, e3 at arc length s.")
    .def("CurvatureAt", [] (const Front & f, double s) { return f.CurvatureAt(Checked(f, s)); }, py::arg("s"), "The curvature at arc length s, > 0 where the sheet is convex.")
    .def("Distance", [] (const Front & f, Triple p) { return f.Distance(ToPoint(p)); }, py::arg("point"), "The distance of a point (x, y, z).")
    .def("Tube", [] (const Front & f, Triple p) { auto at = f.Tube(ToPoint(p)); return std::tuple(at.x1, at.x2, at.s); }, py::arg("point"),
         "(x1, x2, s) of a point (x, y, z) = C(s) + x1 e1 + x2 e2, C(s) the nearest point; x2 is exactly 0 on the sheet.")
    .def_property_readonly("tube", [] (const Front & f) -> shared_ptr<CoefficientFunction> { return make_shared<FrontTube>(f); },
                           "The coordinates (x1, x2, s) of Tube: a CoefficientFunction.")
    .def("__repr__", [] (const Front & f) { return py::str("Front(sheet={}, length={:.6g}, closed={})").format(f.SheetNumber(), f.Length(), f.IsClosed()); });
}

static void ExportCutTet (py::module & m)
{
  py::class_<SheetCell>(m, "SheetCell", "What a sheet's plane cuts out of an element, or a face of the mesh on the plane.")
    .def_readonly("element", &SheetCell::element, "The number of the element in the mesh.")
    .def_property_readonly("h", [] (const SheetCell & c) { return LongestEdge(c.in_space); }, "The longest edge of the element.")
    .def_readonly("neighbour", &SheetCell::neighbour, "The element on the other side of a face on the plane, which this one carries for both, or None.")
    .def_readonly("kind", &SheetCell::kind, "Its ElementKind: Cut, Tip (a front is inside) or Aligned.")
    .def_property_readonly("polygon", [] (const SheetCell & c) { return ToPairs(c.polygon); }, "The corners in the plane's coordinates, counter-clockwise.")
    .def_property_readonly("points", [] (const SheetCell & c)
         {
           std::vector<Triple> points;
           for (auto [i, j] : c.nodes)
             {
               auto number = [&] (size_t v) { return std::ranges::find(c.corners, v) - c.corners.begin(); };
               size_t a = number(i), b = number(j);
               points.push_back(ToTriple(a == b ? c.in_space[a] : Lerp(c.in_space[a], c.in_space[b], c.heights[a]/(c.heights[a]-c.heights[b]))));
             }
           return points;
         }, "The corners (x, y, z).")
    .def_property_readonly("nodes", [] (const SheetCell & c) { return c.nodes; },
                           "Of each corner of the polygon the two vertices of the mesh, in the order of their numbers, between which the plane cuts the edge; twice the same one on the plane.")
    .def_property_readonly("chords", [] (const SheetCell & c)
         {
           std::vector<std::tuple<size_t,double,double>> chords;
           for (auto & [loop, chord] : c.chords) chords.push_back({ loop, chord.s0, chord.s1 });
           return chords;
         }, "Where the curves that bound the sheet run through the polygon: numbers of loops, and arc lengths from and to.")
    .def_property_readonly("heights", [] (const SheetCell & c) { return c.heights; }, "Heights of the element's corners over the plane, by the numbers of the vertices; 0 on the plane.");
}

static shared_ptr<CrackedSolid> MakeSolid (shared_ptr<MeshAccess> mesh, const std::vector<Sheet> & sheets) { return make_shared<CrackedSolid>(mesh, sheets); }

/// Coefficient functions hold bodies, and are pickled with them: as pointers, which RegisterPyArchiveCaster takes for types that cannot be copied only.
static void RegisterForArchives ()
{
  using Body = shared_ptr<CrackedSolid>;
  ngcore::detail::PyArchiveCasters casters;
  casters.shared_to_py = [] (shared_ptr<void> body) -> py::object { return py::cast(std::static_pointer_cast<CrackedSolid>(body)); };
  casters.py_to_shared = [] (py::handle body) -> shared_ptr<void> { return body.cast<Body>(); };
  casters.any_to_py = [] (const std::any & body) -> py::object { return py::cast(std::any_cast<Body>(body)); };
  casters.py_to_any = [] (py::handle body) { return std::any { body.cast<Body>() }; };
  ngcore::detail::SetPyArchiveCasters(typeid(Body), casters);
  ngcore::detail::SetPyArchiveCasters(typeid(CrackedSolid), casters);
}

static void ExportSolid (py::module & m)
{
  using Solid = CrackedSolid;
  using Body = shared_ptr<CrackedSolid>;
  py::class_<Solid, Body>(m, "CrackedSolid", py::dynamic_attr(), "What CrackedMesh(mesh, sheet, ...) makes of a mesh of tetrahedra: the body with its sheets, with the measures dx, ds, dcrack and dlarger as in the plane.")
    .def(py::init(&MakeSolid), py::arg("mesh"), py::arg("sheets"))
    .def_property_readonly("mesh", &Solid::GetMesh, "The mesh of NGSolve.")
    .def_property_readonly("cracks", &Solid::Sheets, "The Sheets, in the order in which they were given.")
    .def_property_readonly("fronts", &Solid::Fronts, "The Fronts of all sheets, those of the first sheet first.")
    .def_property_readonly("tips", [] (const Solid &) { return py::list(); }, "None: a body in space has fronts.")
    .def_property_readonly("notes", [] (const Solid &) { return std::vector<string>(); }, "Sentences on what was moved: none, sheets stay where they are.")
    .def("CheckMesh", &Solid::CheckMesh, "Raises an Exception if the mesh was refined, curved or deformed after the sheets were located in it.")
    .def("Elements", [] (const Solid & b, size_t c) { b.CheckMesh(); return b.Location(c).Cells(); }, py::arg("crack"), "The SheetCells of a crack, one for each element that carries a part of it.")
    .def("FrontElements", [] (const Solid & b, size_t c) { return b.Location(c).FrontElements(); }, py::arg("crack"), "Numbers of the elements whose closure holds a stretch of a front of a crack.")
    .def("PartSizes", [] (const Solid & b, size_t element)
         {
           b.CheckMesh();
           auto cut = b.Find(element);
           return cut ? cut->sizes : std::vector<double> { 1 };
         }, py::arg("element"), "The volumes of the connected parts of an element, the plus side first; [1] if no sheet meets it.")
    .def("FacetArea", [] (const Solid & b, size_t element) { auto cut = b.Find(element); return cut ? cut->FacetArea() : 0; }, py::arg("element"), "The area of the sheet in an element, exact but for round-off.")
    .def("Links", &Solid::Links, py::arg("face"), "Pairs of parts of the two elements beside a face of the mesh that hang together across it.")
    .def("CracksOf", [] (const Solid & b, size_t element)
         { return b.Find(element) ? std::vector<size_t> { b.Find(element)->Sides().crack } : std::vector<size_t>(); }, py::arg("element"), "Numbers of the sheets that meet an element.")
    .def("CutBoundaryElements", [] (const Solid & b, size_t c)
         {
           std::vector<size_t> elements;
           for (auto & [nr, parts] : b.DividedBoundary()) if (parts.crack == c) elements.push_back(nr);
           return elements;
         }, py::arg("crack"), "Numbers of the boundary elements that a crack divides: its mouths.")
    .def("BoundaryPartSizes", [] (const Solid & b, size_t element)
         {
           auto parts = b.FindBoundary(element);
           return parts ? parts->sizes : std::vector<double> { 1 };
         }, py::arg("element"), "The areas of the parts of a boundary element, the plus side first; [1] if no sheet divides it.")
    .def("CrackElements", &Solid::CrackElements, py::arg("crack"), "BitArray of the elements that carry a part of a crack (None: of any).")
    .def_property_readonly("normal", [] (Body b) -> shared_ptr<CoefficientFunction> { return make_shared<CrackFrame<Solid>>(b, false); },
                           "The unit normal n on the cracks, from the minus to the plus side: a CoefficientFunction, for forms over dcrack.")
    .def_property_readonly("tangent", [] (Body b) -> shared_ptr<CoefficientFunction> { return make_shared<CrackFrame<Solid>>(b, true); },
                           "The first unit tangent on the cracks: a1 of a planar sheet, of a curved one the direction along p1 in each element.")
    .def_property_readonly("larger_side", [] (Body b) -> shared_ptr<CoefficientFunction>
         { return make_shared<CrackLabel<Solid>>(b, Label::LargerSide); },
         "On the cracks +1 or -1, the side of the larger part of the element: a CoefficientFunction.")
    .def("LimitOnCrack", [] (Body b, shared_ptr<CoefficientFunction> function, int side) -> shared_ptr<CoefficientFunction>
         { return make_shared<CrackLimit<Solid>>(b, function, side); }, py::arg("function"), py::arg("side"),
         "The limit of a function on the sheets from the plus (1) or minus side (-1), or that of the larger part (0): a CoefficientFunction, for functions that jump there.")
    .def_property_readonly("crack_number", [] (Body b) -> shared_ptr<CoefficientFunction>
         { return make_shared<CrackLabel<Solid>>(b, Label::CrackNumber); },
         "On the cracks the number of the crack: a CoefficientFunction.")
    .def_property_readonly("dx", [] (Body b) { return CutDifferentialSymbol(Measure { b, {} }, VOL); }, "The measure on the body without the cracks.")
    .def_property_readonly("ds", [] (Body b) { return CutDifferentialSymbol(Measure { b, {} }, BND); }, "The measure on the boundary, divided at mouths.")
    .def_property_readonly("dlarger", [] (Body b) { return CutDifferentialSymbol::OnCracks(Measure { b, { Domain::Larger } }); }, "The measure on the larger part of each element that a crack meets.")
    .def_property_readonly("dcrack", [] (Body b) { return CutDifferentialSymbol::OnCracks(Measure { b, { Domain::Crack } }); }, "The measure on the cracks.")
    .def(py::pickle([] (const Solid & b) { return py::make_tuple(b.GetMesh(), b.Sheets()); },
                    [] (py::tuple state) { return MakeSolid(state[0].cast<shared_ptr<MeshAccess>>(), state[1].cast<std::vector<Sheet>>()); }));
  RegisterForArchives();
}

void ExportSheets (py::module & m)
{
  ExportHeightField(m);
  ExportSheet(m);
  ExportFront(m);
  ExportCutTet(m);
  ExportSolid(m);
  m.def("ElementsBeside", [] (const MeshAccess & mesh, const Sheet & sheet) { return ElementsBeside(mesh, sheet); }, py::arg("mesh"), py::arg("sheet"),
        "The same of a sheet, by its box and the heights of corners.");
}
