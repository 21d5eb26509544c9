// Exports only: names equal to the C++ names, no logic; defaults are NGSolve's or the core's.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/numpy.h>
#include <python_ngstd.hpp>
#include <python_comp.hpp>

void ExportGeometry (py::module & m);
void ExportSheets (py::module & m);
void ExportFrontDemand (py::module & m);
void ExportSpaces (py::module & m);
void ExportSolidSpaces (py::module & m);
void ExportMeasures (py::module & m);
void ExportFormTerms (py::module & m);
void ExportSolver (py::module & m);

PYBIND11_MODULE(_ngsxfem_contact, m)
{
  py::module::import("ngsolve");
  ExportFrontDemand(m);
  ExportMeasures(m);  // first: the signatures of the others name its class
  ExportGeometry(m);
  ExportSheets(m);
  ExportSpaces(m);
  ExportSolidSpaces(m);
  ExportFormTerms(m);
  ExportSolver(m);
}
