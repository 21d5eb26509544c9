#include <pybind11/numpy.h>
#include "convert.hpp"
#include "schur_complement.hpp"

using namespace ngsxfem_contact;
using namespace ngla;

template <typename T>
using Input = py::array_t<T, py::array::c_style | py::array::forcecast>;

template <typename T>
static FlatArray<T> ToArray (Input<T> & array) { return FlatArray<T>(array.size(), array.mutable_data()); }

static const SparseCholeskyTM<double> & ToFactors (const BaseMatrix & matrix)
{
  auto factors = dynamic_cast<const SparseCholeskyTM<double>*>(&matrix);
  if (!factors) throw Exception("SchurComplement needs the factors of a real scalar matrix by inverse=\"sparsecholesky\"");
  return *factors;
}

static py::array_t<double> Schur (const BaseMatrix & matrix, size_t height, Input<int> first, Input<int> row, Input<double> value)
{
  auto & factors = ToFactors(matrix);
  if (size_t(first.size()) != factors.GetOrder().Size() + 1 || row.size() != value.size())
    throw Exception("SchurComplement: the columns do not fit the factors");
  SparseColumns C { height, ToArray(first), ToArray(row), ToArray(value) };
  Matrix<> S = SchurSweep(factors, C).Run();
  return py::array_t<double>({ S.Height(), S.Width() }, S.Data());
}

void ExportSolver (py::module & m)
{
  m.def("SchurComplement", &Schur, py::arg("factors"), py::arg("height"), py::arg("first"), py::arg("row"), py::arg("value"),
        "C inv(A) C^T, dense, from sparsecholesky factors of A and C in CSC format.");
  m.def("NumNegativePivots", [] (const BaseMatrix & factors) { return NumNegativePivots(ToFactors(factors)); }, py::arg("factors"),
        "Number of negative eigenvalues of a factorised matrix; -1: a pivot is not finite.");
}
