#include "enriched_space.hpp"
#include <pybind11/numpy.h>
#include "spaces/element_order.hpp"
#include "spaces/tip_mode.hpp"

using namespace ngsxfem_contact;
using namespace ngcomp;

static void ExportTipSpec (py::module & m)
{
  py::enum_<CutOff>(m, "CutOff", "The cut-off χ of the tip functions: cubic is C¹, quintic C², septic C³.").value("cubic", CutOff::Cubic).value("quintic", CutOff::Quintic).value("septic", CutOff::Septic);
  py::enum_<TipBasis>(m, "TipBasis", "The functions at a tip: branch, the four of (8) of [AHLMR12] in each component; modes, pairs of fields of Williams' expansion, those of unit K_I and K_II first.").value("branch", TipBasis::Branch).value("modes", TipBasis::Modes);
  py::class_<TipSpec>(m, "TipSpec", "What a space needs to know at one tip; TipEnrichment makes it.")
    .def(py::init([] (TipBasis basis, CutOff cutoff, double r0, double r1, double kappa, double mu, int order) { return TipSpec { basis, cutoff, r0, r1, kappa, mu, order }; }),
         py::arg("basis"), py::arg("cutoff"), py::arg("r0"), py::arg("r1"), py::arg("kappa"), py::arg("mu"), py::arg("order") = 1)
    .def_readonly("basis", &TipSpec::basis, "The TipBasis.")
    .def_readonly("cutoff", &TipSpec::cutoff, "The CutOff.")
    .def_readonly("r0", &TipSpec::r0, "χ = 1 for r ≤ r0, a length.")
    .def_readonly("r1", &TipSpec::r1, "χ = 0 for r ≥ r1, a length.")
    .def_readonly("kappa", &TipSpec::kappa, "Kolosov's constant of the material at the tip; of modes only.")
    .def_readonly("mu", &TipSpec::mu, "The shear modulus at the tip; of modes only.")
    .def_readonly("order", &TipSpec::order, "How many powers r^{1/2}, r^{3/2}, ... there are; of modes only.")
    .def(py::pickle([] (const TipSpec & s) { return py::make_tuple(s.basis, s.cutoff, s.r0, s.r1, s.kappa, s.mu, s.order); },
                    [] (py::tuple t) { return TipSpec { t[0].cast<TipBasis>(), t[1].cast<CutOff>(), t[2].cast<double>(),
                                                        t[3].cast<double>(), t[4].cast<double>(), t[5].cast<double>(), t[6].cast<int>() }; }));
}

static void ExportTipModeGradient (py::module & m)
{
  m.def("TipModeGradient", [] (const Crack & crack, Pair point, Pair ahead, int plus_sign, int side, int mode, double kappa, double mu) -> shared_ptr<CoefficientFunction>
        { return make_shared<TipModeGradient>(crack, ToPoint(point), ToPoint(ahead), plus_sign, side, mode, kappa, mu); },
        py::arg("crack"), py::arg("point"), py::arg("ahead"), py::arg("plus_sign"), py::arg("side"), py::arg("mode"), py::arg("kappa"), py::arg("mu"),
        "∂_j u_i of the field of unit K_I (mode 0) or K_II (mode 1) at a tip, a 2 x 2 CoefficientFunction. θ has the sign plus_sign on the plus side behind the tip.\n\n"
        "Parameters\n----------\nside\n    1, -1: the limit from the plus or minus side of the crack; 0: by the position of the point.");
}

using TipSpecs = std::vector<std::optional<TipSpec>>;

static void ExportCrackFESpace (py::module & m)
{
  py::class_<CrackFESpace, shared_ptr<CrackFESpace>, FESpace> space(m, "CrackFESpace",
      "The enriched space; ngsxfem_contact.CrackFESpace builds it from a TipEnrichment. Unknowns in this order: φ_i for x, φ_i for y, ½(H - s_i) φ_i for x, the\n"
      "same for y, the tips.");
  ExportEnriched<2>(space)
    .def(py::init([space] (shared_ptr<CrackedMesh> body, TipSpecs tips, double tolerance, py::kwargs kwargs)
                  {
                    py::list info;
                    info.append(body->GetMesh());
                    return Updated(make_shared<CrackFESpace>(body, tips, tolerance, CreateFlagsFromKwArgs(kwargs, space, info)));
                  }), py::arg("body"), py::arg("tips"), py::arg("tolerance"))
    .def_property_readonly("body", &CrackFESpace::GetBody, "The CrackedMesh.")
    .def_property_readonly("tip_specs", &CrackFESpace::TipSpecs, "For each of body.tips its TipSpec, or None where there are no tip functions.")
    .def("SetTipMaterial", &CrackFESpace::SetTipMaterial, py::arg("tip"), py::arg("kappa"), py::arg("mu"),
         "Gives the modes at a tip the kappa and mu of another material: unknowns and rules stay what they are.\n\nRaises\n"
         "------\nException\n    Where there are no functions.")
    .def("TipDofs", &CrackFESpace::TipDofs, py::arg("tip"), "The numbers of the unknowns of a tip; of modes that of K_I, that of K_II, then the pairs of higher powers of r. Empty without tip functions.")
    .def(py::pickle([] (const CrackFESpace & v) { return py::make_tuple(v.GetBody(), v.TipSpecs(), v.Tolerance(), v.GetFlags()); },
                    [] (py::tuple t) { return Updated(make_shared<CrackFESpace>(t[0].cast<shared_ptr<CrackedMesh>>(), t[1].cast<TipSpecs>(),
                                                                                t[2].cast<double>(), t[3].cast<Flags>())); }));
}

static void ExportCurveNodes (py::module & m)
{
  auto array = [] (auto & v) { return py::array(v.size(), v.data()); };
  auto pairs = [] (auto & v, auto first) { return py::array_t<decltype(first)>({ v.size(), size_t(2) }, reinterpret_cast<const decltype(first)*>(v.data())); };
  py::class_<CurveNodes>(m, "CurveNodes", "Nodes on the cracks, crack by crack, in the order of arc length: one list of arc lengths, increasing, and one of weights for each.")
    .def(py::init<const CurveNodes &>(), py::arg("nodes"))
    .def(py::init([] (shared_ptr<CrackedMesh> body, const std::vector<std::vector<double>> & arclengths, const std::vector<std::vector<double>> & weights)
                  {
                    CurveNodes nodes(body);
                    for (size_t c = 0; c < arclengths.size(); c++) nodes.Append(c, arclengths[c], weights.at(c));
                    return nodes;
                  }), py::arg("body"), py::arg("arclengths"), py::arg("weights"))
    .def("__len__", [] (const CurveNodes & nodes) { return nodes.positions.size(); }, "The number of nodes.")
    .def_readonly("body", &CurveNodes::body, "The CrackedMesh.")
    .def_property_readonly("cracks", [=] (const CurveNodes & nodes) { return array(nodes.cracks); }, "Array (n,): of each node the number of its crack.")
    .def_property_readonly("positions", [=] (const CurveNodes & nodes) { return pairs(nodes.positions, double()); }, "Array (n, 2): the points.")
    .def_property_readonly("weights", [=] (const CurveNodes & nodes) { return array(nodes.weights); }, "Array (n,): ∫ψ_i, the length of the cracks that belongs to each node.")
    .def_property_readonly("neighbours", [=] (const CurveNodes & nodes) { return pairs(nodes.neighbours, size_t()); }, "Array (k, 2): the numbers of two nodes beside each other on a crack.")
    .def_property_readonly("arclengths", [=] (const CurveNodes & nodes) { return array(nodes.arclengths); }, "Array (n,): of each node the arc length on its crack.");
}

static shared_ptr<TraceSpace> MakeTraceSpace (shared_ptr<CrackedMesh> body, shared_ptr<TraceBasis> basis, int order)
{
  Flags flags;
  flags.SetFlag("order", order);
  return Updated(make_shared<TraceSpace>(body, basis, flags));
}

static void ExportTraceSpace (py::module & m)
{
  py::class_<TraceSpace, shared_ptr<TraceSpace>, FESpace> space(m, "TraceSpace", "The space of multipliers on the cracks; ngsxfem_contact.TraceSpace builds it from a name.");
  using Division = std::vector<std::vector<double>>;
  py::class_<TraceBasis, shared_ptr<TraceBasis>>(m, "TraceBasis", "The functions of a TraceSpace, and where they live.")
    .def_property_readonly("division", [] (const TraceBasis & b) { return b.Division()->All(); }, "Arc lengths that divide each crack into intervals, from 0 to its length.")
    .def_property_readonly("ndof", &TraceBasis::NDof, "The number of functions.")
    .def("Nodes", &TraceBasis::Nodes, "The points of the Lagrange functions of this order on the intervals, as CurveNodes: of order 0 their middles.");
  py::class_<NodalTraceBasis, shared_ptr<NodalTraceBasis>, TraceBasis>(m, "NodalTraceBasis",
      "Lagrange functions: order 0 one constant for each interval, order j ≥ 1 continuous, at Gauss-Lobatto points.\n"
      "\nRaises\n------\nException\n    For a division that does not increase from 0 to the length of each crack.")
    .def(py::init([] (shared_ptr<CrackedMesh> body, int order, Division division) { return make_shared<NodalTraceBasis>(body, order, division); }),
         py::arg("body"), py::arg("order"), py::arg("division"))
    .def(py::pickle([] (const NodalTraceBasis & b) { return py::cast(b.Arguments()).cast<py::tuple>(); },
                    [] (py::tuple t) { return make_shared<NodalTraceBasis>(t[0].cast<shared_ptr<CrackedMesh>>(), t[1].cast<int>(), t[2].cast<Division>()); }));
  py::class_<MeshTraceBasis, shared_ptr<MeshTraceBasis>, TraceBasis>(m, "MeshTraceBasis", "Restrictions to the cracks of the P_j functions of the mesh, but for those of the numbers left_out, on which the others must not depend.")
    .def(py::init([] (shared_ptr<CrackedMesh> body, int order, Division division, const std::set<size_t> & left_out)
                  { return make_shared<MeshTraceBasis>(body, order, division, left_out); }),
         py::arg("body"), py::arg("order"), py::arg("division"), py::arg("left_out"))
    .def(py::pickle([] (const MeshTraceBasis & b) { return py::cast(std::tuple_cat(b.Arguments(), std::tuple(b.LeftOut()))).cast<py::tuple>(); },
                    [] (py::tuple t) { return make_shared<MeshTraceBasis>(t[0].cast<shared_ptr<CrackedMesh>>(), t[1].cast<int>(), t[2].cast<Division>(),
                                                                          t[3].cast<std::set<size_t>>()); }));
  space
    .def(py::init(&MakeTraceSpace), py::arg("body"), py::arg("basis"), py::arg("order"))
    .def_property_readonly("body", &TraceSpace::GetBody, "The CrackedMesh.")
    .def_property_readonly("basis", &TraceSpace::Basis, "The TraceBasis.")
    .def_property_readonly("order", [] (const TraceSpace & w) { return w.GetOrder(); }, "The order of the functions.")
    .def_property_readonly("dcrack", &TraceSpace::CrackSymbol, "The measure on the cracks, its rules divided where the intervals of this space end.")
    .def(py::pickle([] (const TraceSpace & w) { return py::make_tuple(w.GetBody(), w.Basis(), w.GetOrder()); },
                    [] (py::tuple t) { return MakeTraceSpace(t[0].cast<shared_ptr<CrackedMesh>>(), t[1].cast<shared_ptr<TraceBasis>>(), t[2].cast<int>()); }));
}

static void ExportCrackBilinearForm (py::module & m)
{
  py::class_<CrackBilinearForm, shared_ptr<CrackBilinearForm>, BilinearForm> form(m, "CrackBilinearForm",
      "NGSolve's BilinearForm on a CrackFESpace, with the rows of the tip functions, as long as their disks are large, written directly:\n"
      "the same matrix, assembled faster. Flags as for BilinearForm, but for those that choose another storage.");
  form.def(py::init([form] (shared_ptr<CrackFESpace> space, string name, py::kwargs kwargs)
                    { return make_shared<CrackBilinearForm>(space, name, CreateFlagsFromKwArgs(kwargs, form)); }),
           py::arg("space"), py::arg("name") = "crack_form")
    .def_static("__flags_doc__", [] { return py::type::of<BilinearForm>().attr("__flags_doc__")(); });
  m.def("StressPower", [] (const CrackFESpace & space, shared_ptr<CoefficientFunction> lam, shared_ptr<CoefficientFunction> mu, const CutDifferentialSymbol & measure)
        { return MakeStressPower<2>(space, lam, mu, measure); }, py::arg("space"), py::arg("lam"), py::arg("mu"), py::arg("measure"),
        "∫ σ(u):ε(v) for a bilinear form on a CrackFESpace, σ = lam tr(ε) I + 2 mu ε: an integrator for form += ..., the same as the symbolic form, assembled faster.");
}

void ExportSpaces (py::module & m)
{
  m.def("ElementOrder", [] (shared_ptr<FESpace> space)
        {
          auto order = ElementOrder(*space);
          return py::array_t<int>(order.Size(), order.Data());
        }, py::arg("space"), "The unknowns of a space of NGSolve, an array, in the order in which the elements name them first; those of no element are left out.");
  ExportTipModeGradient(m);
  ExportTipSpec(m);
  ExportCrackFESpace(m);
  ExportCrackBilinearForm(m);
  ExportCurveNodes(m);
  ExportTraceSpace(m);
}
