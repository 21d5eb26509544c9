#pragma once
// The matrices of a bilinear form on some elements, without a loop over the others: what a crack adds lives on the few that it meets.

#include "cut/element_map.hpp"
#include <comp.hpp>

namespace ngsxfem_contact
{
  using ngcore::Array, ngcore::FlatArray;

  /// All of one size: smaller matrices are filled up with zeros, and dofs with -1.
  struct ElementMatrices
  {
    size_t height = 0, width = 0;
    Array<double> values;                     // element by element, row by row
    Array<int> rows, columns;                 // the dofs of the test and of the trial space
  };

  /// Of the volume integrals of a form, which need not be assembled.
  ElementMatrices MatricesOf (const ngcomp::BilinearForm & form, FlatArray<int> elements);
}
