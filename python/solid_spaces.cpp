#include "enriched_space.hpp"
#include "spaces/linear_sheet_trace_space.hpp"

using namespace ngsxfem_contact;
using namespace ngcomp;

using Materials = std::vector<std::pair<double,double>>;

static Materials MaterialsOf (const FrontSpec & spec)
{
  Materials materials;
  for (auto & material : spec.material) materials.push_back({ material.kappa, material.mu });
  return materials;
}

static FrontSpec MakeFrontSpec (const Materials & materials, FrontDemand rules)
{
  FrontSpec spec { {}, rules };
  for (auto & [kappa, mu] : materials) spec.material.push_back({ kappa, mu });
  return spec;
}

static void ExportFrontSpec (py::module & m)
{
  py::class_<FrontSpec>(m, "FrontSpec", "What a space of a solid needs to know of its fronts; FrontEnrichment makes it.")
    .def(py::init(&MakeFrontSpec), py::arg("materials"), py::arg("rules"))
    .def_property_readonly("materials", &MaterialsOf, "(kappa, mu) of the modes of each of body.fronts.")
    .def_readonly("rules", &FrontSpec::rules, "The FrontDemand; nodes nearer to a front than its radius have modes, too.")
    .def(py::pickle([] (const FrontSpec & spec) { return py::make_tuple(MaterialsOf(spec), spec.rules); },
                    [] (py::tuple t) { return MakeFrontSpec(t[0].cast<Materials>(), t[1].cast<FrontDemand>()); }));
}

static void ExportLinearSheetTraceSpace (py::module & m)
{
  using Space = LinearSheetTraceSpace;
  py::class_<Space, shared_ptr<Space>, FESpace>(m, "LinearSheetTraceSpace", "Multipliers of order 1 on the sheets of a body in space; ngsxfem_contact.TraceSpace builds it.")
    .def(py::init([] (shared_ptr<CrackedSolid> body) { return Updated(make_shared<Space>(body)); }), py::arg("body"))
    .def_property_readonly("body", &Space::GetBody, "The CrackedSolid.")
    .def_property_readonly("sheets", [] (const Space & w) { return w.Nodes().sheets; }, "Of each node the number of its sheet.")
    .def_property_readonly("positions", [] (const Space & w)
         {
           std::vector<std::array<double,3>> positions;
           for (auto & x : w.Nodes().positions) positions.push_back({ x(0), x(1), x(2) });
           return positions;
         }, "The nodes: the points (x, y, z) in which planes of sheets cut edges of the mesh.")
    .def_property_readonly("neighbours", [] (const Space & w) { return w.Nodes().neighbours; }, "Pairs of nodes that a side of a polygon joins.")
    .def(py::pickle([] (const Space & w) { return py::make_tuple(w.GetBody()); },
                    [] (py::tuple t) { return Updated(make_shared<Space>(t[0].cast<shared_ptr<CrackedSolid>>())); }));
}

void ExportSolidSpaces (py::module & m)
{
  ExportLinearSheetTraceSpace(m);
  ExportFrontSpec(m);
  using Space = SolidFESpace;
  py::class_<Space, shared_ptr<Space>, FESpace> space(m, "SolidFESpace",
      "The enriched space of a body in space; ngsxfem_contact.CrackFESpace builds it. Unknowns in this order: φ_i for x, for y, for z, ½(H - s_i) φ_i for x, for y,\n"
      "for z, and for each node with modes those of K_I, K_II, K_III.");
  ExportEnriched<3>(space)
    .def(py::init([space] (shared_ptr<CrackedSolid> body, std::optional<FrontSpec> fronts, py::kwargs kwargs)
                  {
                    py::list info;
                    info.append(body->GetMesh());
                    return Updated(make_shared<Space>(body, fronts, CreateFlagsFromKwArgs(kwargs, space, info)));
                  }), py::arg("body"), py::arg("fronts"))
    .def_property_readonly("body", [] (const Space & v) { return std::const_pointer_cast<CrackedSolid>(v.GetBody()); }, "The CrackedSolid.")
    .def_property_readonly("front_spec", &Space::Spec, "The FrontSpec, or None where there are no modes.")
    .def("SetFrontMaterial", [] (Space & v, size_t front, double kappa, double mu) { v.SetFrontMaterial(front, { kappa, mu }); },
         py::arg("front"), py::arg("kappa"), py::arg("mu"),
         "Gives the modes of a front the kappa and mu of another material: unknowns and rules stay what they are.\n\nRaises\n------\nException\n    Where there are no modes.")
    .def_property_readonly("front_nodes", [] (const Space & v)
         {
           std::vector<std::pair<size_t,size_t>> nodes;
           for (size_t j = 0; j < v.NumFrontNodes(); j++) nodes.push_back(v.FrontNodeAt(j));
           return nodes;
         }, "(vertex, front) for each node with modes.")
    .def_property_readonly("num_left_out", &Space::NumLeftOut, "The number of nodes around fronts without modes: beside corners, where two fronts are near, and where some components of u are held and others are not.")
    .def("FrontDof", &Space::FrontDof, py::arg("j"), py::arg("mode"), "The number of the unknown of the j-th node with modes, mode 0 (I), 1 (II) or 2 (III).")
    .def(py::pickle([] (const Space & v) { return py::make_tuple(std::const_pointer_cast<CrackedSolid>(v.GetBody()), v.Spec(), v.GetFlags()); },
                    [] (py::tuple t) { return Updated(make_shared<Space>(t[0].cast<shared_ptr<CrackedSolid>>(), t[1].cast<std::optional<FrontSpec>>(), t[2].cast<Flags>())); }));
  m.def("StressPower", [] (const Space & v, shared_ptr<CoefficientFunction> lam, shared_ptr<CoefficientFunction> mu, const CutDifferentialSymbol & measure)
        { return MakeStressPower<3>(v, lam, mu, measure); }, py::arg("space"), py::arg("lam"), py::arg("mu"), py::arg("measure"), "The same in space.");
}
