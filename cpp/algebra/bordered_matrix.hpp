#pragma once
// The symmetric matrix [A, Kᵀ; K, 0] as direct solvers of other libraries want it.

#include <la.hpp>

namespace ngsxfem_contact
{
  /// A sparse matrix with few rows by columns: column j has the entries first[j] ≤ k < first[j+1], in rows row[k].
  struct SparseColumns
  {
    size_t height;
    ngcore::FlatArray<int> first, row;
    ngcore::FlatArray<double> value;
  };

  /// Rows of an upper triangle with ascending columns and a stored diagonal; zero-based.
  struct UpperTriangle
  {
    ngcore::Array<int> first, column;
    ngcore::Array<double> value;
  };

  /// The upper triangle of [A, Kᵀ; K, 0], A restricted to the unknowns of `inner`, renumbered in their order.
  /// A is symmetric and stored with both triangles; the rows of K are ascending in each column.
  UpperTriangle BorderedMatrix (const ngla::SparseMatrix<double> & A, const ngcore::BitArray & inner, const SparseColumns & K);
}
