#pragma once
// What CrackFESpace and SolidFESpace have in common.

#include <pybind11/numpy.h>
#include "convert.hpp"
#include "spaces/solid_fespace.hpp"

namespace ngsxfem_contact
{
  template <typename SPACE>
  shared_ptr<SPACE> Updated (shared_ptr<SPACE> space)
  {
    space->Update();
    space->FinalizeUpdate();
    return space;
  }

  template <int D, typename CLASS>
  CLASS & ExportEnriched (CLASS & space)
  {
    using SPACE = typename CLASS::type;
    space
    .def_static("__flags_doc__", []
         {
           py::dict doc = py::type::of<ngcomp::FESpace>().attr("__flags_doc__")();
           doc["orderinner"] = "order of the functions inside an element";
           for (int k = 0; k < D; k++) doc[HeldFlag(k).c_str()] = "Regular expression of the boundaries on which u_" + HeldFlag(k).substr(9) + " is fixed.";
           return doc;
         })
    .def_property_readonly("order", [] (const SPACE & v) { return v.GetOrder(); }, "The order k of the functions φ_i.")
    .def_property_readonly("scalar_space", &SPACE::GetScalar, "The scalar space of the functions φ_i.")
    .def("HeldRegions", &SPACE::HeldRegions, py::arg("component"), "The boundary regions (BitArray) on which component 0 (x), 1 (y), ... is fixed.")
    .def_property_readonly("num_heaviside", &SPACE::NumHeaviside, "The number of Heaviside functions of one component.")
    .def("Heaviside", &SPACE::Heaviside, py::arg("j"), "(i, s_i): the number of the j-th enriched function φ_i, and the side on which its copy sees the largest part of the support.")
    .def("HeavisideCrack", &SPACE::HeavisideCrack, py::arg("j"), "The number of the crack at which it jumps, of the largest one of several.")
    .def("HeavisideFactors", [] (const SPACE & v, size_t j, size_t element)
         {
           auto factors = v.HeavisideFactors(j, element);
           return std::vector<int>(factors.begin(), factors.end());
         }, py::arg("j"), py::arg("element"),
         "By how much φ_i is multiplied in the j-th Heaviside function, ±1 or 0, on each part of an element. Raises an Exception outside of the support.")
    .def("HeavisideDof", &SPACE::HeavisideDof, py::arg("j"), py::arg("component"), "The number of the unknown of the j-th Heaviside function, component 0 (x), 1 (y), ...")
    .def("BoundaryDofs", [] (const SPACE & v)
         {
           auto array = [] (auto & dofs) { return py::array_t<int>(dofs.size(), dofs.data()); };
           py::list all;
           for (auto & region : v.BoundaryDofs())
             {
               py::list components;
               for (auto & dofs : region) components.append(array(dofs));
               all.append(py::tuple(components));
             }
           return all;
         }, "For each boundary region one array for each component: its unknowns with a trace on the region.");
    return space;
  }
}
