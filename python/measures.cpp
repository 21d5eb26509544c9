#include "convert.hpp"
#include <pybind11/numpy.h>
#include "forms/form_terms.hpp"
#include "forms/element_matrices.hpp"

using namespace ngsxfem_contact;
using namespace ngfem;
using ngcomp::Region;

using Division = std::vector<std::vector<double>>;

static py::object ToPython (const shared_ptr<const CrackedBody> & body)
{
  if (auto plane = dynamic_pointer_cast<const CrackedMesh>(body)) return py::cast(const_pointer_cast<CrackedMesh>(plane));
  return py::cast(const_pointer_cast<CrackedSolid>(dynamic_pointer_cast<const CrackedSolid>(body)));
}

static shared_ptr<const CrackedBody> ToBody (const py::object & body)
{
  if (py::isinstance<CrackedMesh>(body)) return body.cast<shared_ptr<CrackedMesh>>();
  return body.cast<shared_ptr<CrackedSolid>>();
}

static py::tuple WrittenTerm (const FormTerm & term)
{
  auto place = PlaceOf(term);
  auto arclengths = dynamic_pointer_cast<const ArcLengths>(place.kind.division);
  return py::make_tuple(term.integral->cf, ToPython(place.body), place.kind.domain, place.kind.crack,
                        arclengths ? std::optional<Division>(arclengths->All()) : std::nullopt,
                        place.vb != VOL, place.bonus_intorder, place.elements, place.regions, place.fronts);
}

static FormTerm ReadTerm (py::tuple t)
{
  using Bits = shared_ptr<ngcore::BitArray>;
  auto arclengths = t[4].cast<std::optional<Division>>();
  RuleKind kind { t[2].cast<Domain>(), arclengths ? make_shared<ArcLengths>(*arclengths) : nullptr, t[3].cast<std::optional<size_t>>() };
  TermPlace place { ToBody(t[1]), kind, t[5].cast<bool>() ? BND : VOL, t[6].cast<int>(), t[7].cast<Bits>(), t[8].cast<Bits>(), t[9].cast<std::optional<FrontDemand>>() };
  return TermAt(place, t[0].cast<shared_ptr<CoefficientFunction>>());
}

void ExportFormTerms (py::module & m)
{
  py::enum_<Domain>(m, "Domain", "What a measure integrates over: the Bulk of the body or its boundary, the Larger parts of cut elements, or the Crack.")
    .value("Bulk", Domain::Bulk).value("Larger", Domain::Larger).value("Crack", Domain::Crack);
  py::class_<FormTerm>(m, "FormTerm", "One integral of a form: its measure, and which functions of which spaces it holds.")
    .def_property_readonly("form", [] (const FormTerm & term) { return make_shared<SumOfIntegrals>(term.integral); }, "The integral as a form.")
    .def_property_readonly("integrand", [] (const FormTerm & term) { return term.integral->cf; }, "The function that is integrated.")
    .def_property_readonly("body", [] (const FormTerm & term) { return ToPython(term.body); }, "The CrackedMesh of its measure; None for a measure of NGSolve.")
    .def_readonly("domain", &FormTerm::domain, "The Domain of its measure.")
    .def_property_readonly("on_boundary", [] (const FormTerm & term) { return term.vb != VOL; }, "Whether it is taken over the boundary, or an inner interface.")
    .def_readonly("crack", &FormTerm::crack, "The number of the only crack that it is taken over, or None.")
    .def_readonly("elements", &FormTerm::elements, "BitArray of the elements that it is restricted to, or None.")
    .def_readonly("regions", &FormTerm::regions, "BitArray of the regions (materials or boundaries) that it is restricted to, or None.")
    .def_readonly("trial", &FormTerm::trial, "The trial functions in it, one for each operator that is applied to them.")
    .def_readonly("test", &FormTerm::test, "The test functions in it, one for each operator that is applied to them.")
    .def_readonly("element_normal", &FormTerm::element_normal, "Whether it holds NGSolve's normal vector, which is zero inside of elements.")
    .def(py::pickle(&WrittenTerm, &ReadTerm));
  m.def("TermsOf", &TermsOf, py::arg("form"), "The FormTerms of a form, one for each integral.");
  m.def("OperatorName", &OperatorName, py::arg("proxy"), "The name of the operator of a trial or test function: Id, grad, plus, minus, jump, gradlarger, ...");
  m.def("IsTestFunction", [] (const ProxyFunction & proxy) { return proxy.IsTestFunction(); }, py::arg("proxy"), "Whether a trial or test function is a test function.");
  m.def("GridFunctionOf", [] (const ngcomp::GridFunctionCoefficientFunction & function) { return function.GetGridFunctionPtr(); }, py::arg("function"),
        "The GridFunction that a function such as Grad(u) or Jump(u) is an operator of.");
  m.def("OperatorOf", [] (const ngcomp::GridFunctionCoefficientFunction & function) -> std::optional<string>
        {
          if (function.generated_from_deriv) return "deriv";
          if (function.generated_from_operator.empty()) return std::nullopt;
          return function.generated_from_operator;
        }, py::arg("function"), "The name of the operator that a function is of its GridFunction, 'deriv' for Deriv(); None where NGSolve does not know.");
  m.def("NameOf", [] (const CoefficientFunction & function) { return function.GetDescription(); }, py::arg("function"), "What NGSolve calls a function, such as 'normal vector'.");
  m.def("FunctionOf", [] (const ngcomp::PointEvaluationFunctional & functional) { return functional.cf; }, py::arg("functional"), "The function v of an evaluation such as v(x, y).");
  m.def("PointOf", [] (const ngcomp::PointEvaluationFunctional & functional) { return std::pair(functional.point(0), functional.point(1)); },
        py::arg("functional"), "The point (x, y) of an evaluation such as v(x, y) in a linear form.");
}

static py::tuple MatricesOfElements (const ngcomp::BilinearForm & form, py::array_t<int, py::array::c_style | py::array::forcecast> elements)
{
  auto all = MatricesOf(form, ngcore::FlatArray<int>(elements.size(), elements.mutable_data()));
  size_t n = elements.size();
  return py::make_tuple(py::array_t<double>({ n, all.height, all.width }, all.values.Data()),
                        py::array_t<int>({ n, all.height }, all.rows.Data()), py::array_t<int>({ n, all.width }, all.columns.Data()));
}

void ExportMeasures (py::module & m)
{
  Restriction none;
  m.def("ElementMatrices", &MatricesOfElements, py::arg("form"), py::arg("elements"),
        "(matrices, rows, columns) of the volume integrals of a bilinear form, which need not be assembled, on some elements: arrays (n, height, width), and the\n"
        "numbers of the test and trial functions; smaller matrices are filled up with zeros, numbers with -1.");

  m.def("Variation", &MakeVariation, py::arg("form"),
        "An energy whose first and second variations NGSolve's BilinearForm applies, linearises and assembles, over measures of a CrackedMesh or of NGSolve.");

  m.def("IntegralsOn", &IntegralsOn, py::arg("form"), py::arg("elements"), py::arg("boundary_elements"),
        "The integrals of a form on some elements of the mesh and of its boundary (BitArrays).");
  m.def("InnerIntegrals", &InnerIntegrals, py::arg("form"), py::arg("elements"),
        "The integrals of a form over the body and its cracks, without those over its boundary, on some elements (BitArray).");

  // no shared_ptr holder: the base class is exported without one
  py::class_<CutDifferentialSymbol, DifferentialSymbol>(m, "CutDifferentialSymbol",
      "A measure of a CrackedMesh: as dx and ds of NGSolve, with rules that respect the cracks. For linear and bilinear forms, and Integrate(f * body.dx, body.mesh).")
    .def("__call__", [] (const CutDifferentialSymbol & dx, decltype(Restriction::definedon) definedon, int bonus_intorder, shared_ptr<ngcore::BitArray> elements,
                         std::optional<CrackKey> crack, decltype(Restriction::nodes) nodes, shared_ptr<ngcomp::FESpace> space, std::optional<FrontDemand> fronts)
         {
           auto number = crack ? std::optional(NumberOf(*dx.measure.body, *crack)) : std::nullopt;
           return dx.Restricted({ definedon, bonus_intorder, elements, number, nodes, space, fronts });
         },
         py::arg("definedon") = none.definedon, py::arg("bonus_intorder") = none.bonus_intorder, py::arg("definedonelements") = none.definedonelements,
         py::arg("crack") = py::none(), py::arg("nodes") = none.nodes, py::arg("space") = none.space, py::arg("fronts") = none.fronts,
         "The same measure, restricted or refined.\n\nParameters\n----------\ndefinedon\n"
         "    A Region, or the name (a regular expression) of materials for dx, of boundaries for ds.\nbonus_intorder\n"
         "    Added to the order of the rules.\ndefinedonelements\n    BitArray of elements.\ncrack\n"
         "    Number or name of the only crack.\nnodes\n"
         "    Arc lengths at which rules on the cracks are divided, one list for each crack.\nspace\n"
         "    A CrackFESpace whose tips the rules serve, too: needed for singular functions that are given by formulas. Rules always serve the spaces whose\n"
         "    functions, trial or test functions are part of an integrand.\nfronts\n"
         "    A FrontDemand: rules for functions that are singular at the fronts of a solid.\n\nRaises\n------\nException\n"
         "    For a region that the mesh does not have.")
    .def("Points", [] (const CutDifferentialSymbol & dx, int order, shared_ptr<ngcomp::FESpace> space)
         {
           auto p = RulePoints(dx.For(space), order);
           auto array = [] (auto & v) { return py::array(v.size(), v.data()); };
           py::list columns;
           columns.append(array(p.element));
           for (auto & coordinate : p.reference) columns.append(array(coordinate));
           columns.append(array(p.weight));
           for (auto & coordinate : p.place) columns.append(array(coordinate));
           return py::tuple(columns);
         }, py::arg("order"), py::arg("space") = none.space, "Arrays: element, reference coordinates xi and eta (of a solid also zeta), weight, x, y (and z) of the points of a rule of this order; with a space those of its tips' functions.")
    .def("PrepareRules", [] (const CutDifferentialSymbol & dx, int order, shared_ptr<ngcomp::FESpace> space)
         { dx.For(space).measure.Rules(dx.vb, order); }, py::arg("order"), py::arg("space") = none.space,
         "Makes the rules of this order now, which are otherwise made when they are first used. They are kept as long as a space on the body, a measure or a form.")
    .def("__rmul__", [] (const CutDifferentialSymbol & dx, double factor)
         { return make_shared<SumOfIntegrals>(dx.MakeIntegral(make_shared<ConstantCoefficientFunction>(factor))); });
}
