#include <pybind11/numpy.h>
#include "convert.hpp"
#include "algebra/schur_complement.hpp"

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

static SparseColumns ToColumns (size_t width, size_t height, Input<int> & first, Input<int> & row, Input<double> & value)
{
  if (size_t(first.size()) != width + 1 || row.size() != value.size()) throw Exception("SchurComplement: K does not fit the matrix; give it in CSC format, one column for each unknown");
  return { height, ToArray(first), ToArray(row), ToArray(value) };
}

static py::array_t<double> Schur (const BaseMatrix & matrix, size_t height, Input<int> first, Input<int> row, Input<double> value)
{
  auto & factors = ToFactors(matrix);
  Matrix<> S = SchurSweep(factors, ToColumns(factors.GetOrder().Size(), height, first, row, value)).Run();
  return py::array_t<double>({ S.Height(), S.Width() }, S.Data());
}

/// A numpy array that owns the memory of an NGSolve array.
template <typename T>
static py::array_t<T> ToNumpy (Array<T> && array)
{
  auto owner = new Array<T>(std::move(array));
  return py::array_t<T>(owner->Size(), owner->Data(), py::capsule(owner, [] (void * p) { delete static_cast<Array<T>*>(p); }));
}

static py::tuple Bordered (const SparseMatrix<double> & A, const BitArray & inner, size_t height, Input<int> first, Input<int> row, Input<double> value)
{
  auto T = BorderedMatrix(A, inner, ToColumns(A.Height(), height, first, row, value));
  return py::make_tuple(ToNumpy(std::move(T.first)), ToNumpy(std::move(T.column)), ToNumpy(std::move(T.value)));
}

static shared_ptr<BaseMatrix> FromCSR (Input<int> first, Input<int> column, Input<double> value, size_t width)
{
  auto begin = ToArray(first), columns = ToArray(column);
  auto values = ToArray(value);
  size_t height = begin.Size()-1;
  if (size_t(begin[height]) != columns.Size() || columns.Size() != values.Size()) throw Exception("FromCSR: the arrays do not fit one another");
  Array<int> sizes(height);
  for (size_t i = 0; i < height; i++) sizes[i] = begin[i+1]-begin[i];
  auto matrix = make_shared<SparseMatrix<double>>(sizes, width);
  for (size_t i = 0; i < height; i++)
    {
      auto indices = matrix->GetRowIndices(i);
      auto entries = matrix->GetRowValues(i);
      for (int j = 0; j < sizes[i]; j++)
        {
          indices[j] = columns[begin[i]+j];
          entries[j] = values[begin[i]+j];
        }
    }
  return matrix;
}

void ExportSolver (py::module & m)
{
  m.def("FromCSR", &FromCSR, py::arg("first"), py::arg("column"), py::arg("value"), py::arg("width"),
        "A sparse matrix of NGSolve from one in CSR format, the columns of each row in ascending order.");
  m.def("SchurComplement", &Schur, py::arg("factors"), py::arg("height"), py::arg("first"), py::arg("row"), py::arg("value"),
        "K inv(A) K^T, dense, from sparsecholesky factors of A and K in CSC format.");
  m.def("BorderedMatrix", &Bordered, py::arg("matrix"), py::arg("inner"), py::arg("height"), py::arg("first"), py::arg("row"), py::arg("value"),
        "Upper triangle of [A, K^T; K, 0], A on the inner unknowns, in CSR format: (first, column, value). K in CSC format.");
  m.def("NumNegativePivots", [] (const BaseMatrix & factors) { return NumNegativePivots(ToFactors(factors)); }, py::arg("factors"),
        "Number of negative eigenvalues of a factorised matrix; -1: a pivot is not finite.");
}
