#pragma once
// K A⁻¹ Kᵀ from a sparse factorisation of A, for a few sparse rows K.

#include <vector>
#include <sparsecholesky.hpp>
#include "algebra/bordered_matrix.hpp"

namespace ngsxfem_contact
{
  /// The sweep Z = L⁻¹ P Kᵀ through the blocks of A = Pᵀ L D Lᵀ P that accumulates S = Zᵀ D⁻¹ Z.
  ///
  /// A block takes part with those columns of Z only that are not zero there: the rows of K that meet its unknowns or
  /// those of a block below it in the elimination tree. Rows of Z are kept from their first contribution to their
  /// elimination, so that nothing of size m × n is ever stored. Unknowns outside of the factorisation are left out.
  class SchurSweep
  {
    const ngla::SparseCholeskyTM<double> & factors;
    const SparseColumns & K;
    ngcore::Array<int> unknown, block_of;     // of each position of the elimination order
    std::vector<std::vector<int>> columns;    // of each block: the columns of Z that are not zero
    std::vector<ngbla::Matrix<>> rows;        // of each block: its rows of Z, as far as they are known
    ngbla::Matrix<> S;
  public:
    SchurSweep (const ngla::SparseCholeskyTM<double> & afactors, const SparseColumns & aK);
    ngbla::Matrix<> Run ();
  private:
    void FindColumns ();
    ngbla::Matrix<> & Rows (size_t block);
    void Eliminate (size_t block);
    void Pass (size_t block, ngbla::SliceMatrix<> updates);
    void Accumulate (size_t block, ngbla::SliceMatrix<> Z);
  };

  /// The number of negative pivots: of negative eigenvalues of A (Sylvester), -1 if one is not finite.
  int NumNegativePivots (const ngla::SparseCholeskyTM<double> & factors);
}
