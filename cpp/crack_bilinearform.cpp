#include "crack_bilinearform.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using namespace ngcomp;

  void CrackBilinearForm :: AllocateMatrix ()
  {
    if (mats.Size() == size_t(ma->GetNLevels())) return;
    T_BilinearForm<double>::AllocateMatrix();
    column.SetSize(space->GetNDof());
    column = 0;
    for (size_t tip = 0; tip < space->GetBody()->Tips().size(); tip++)
      if (auto dofs = space->TipDofs(tip); !dofs.empty())
        {
          auto columns = mymatrix->GetRowIndices(dofs[0]);
          for (size_t k = 0; k < columns.Size(); k++) column[columns[k]] = k;
        }
  }

  size_t CrackBilinearForm :: Place (int dof, FlatArray<int> columns) const
  {
    size_t k = column[dof];
    if (k < columns.Size() && columns[k] == dof) return k;
    k = std::lower_bound(columns.begin(), columns.end(), dof) - columns.begin();
    if (k == columns.Size() || columns[k] != dof) throw Exception("CrackBilinearForm: the matrix has no such entry");
    return k;
  }

  void CrackBilinearForm :: AddElementMatrix (FlatArray<int> rows, FlatArray<int> cols, BareSliceMatrix<double> elmat,
                                              ElementId id, bool atomic, LocalHeap & lh)
  {
    size_t n = rows.Size();
    while (n > 0 && IsRegularDof(rows[n-1]) && rows[n-1] >= space->FirstTipDof()) n--;
    mymatrix->SparseMatrix<double>::AddElementMatrix(rows.Range(0, n), cols, elmat, atomic);
    if (n == rows.Size()) return;
    size_t num_tip = rows.Size()-n;
    for (size_t i = n; i < rows.Size(); i++)
      AddTipRow(rows[i], cols, num_tip, elmat.Row(i), atomic);
  }

  /// Elements of one colour share no other column than those of the tips.
  void CrackBilinearForm :: AddTipRow (int row, FlatArray<int> cols, size_t num_tip, BareVector<double> values, bool atomic)
  {
    auto columns = mymatrix->GetRowIndices(row);
    auto entries = mymatrix->GetRowValues(row);
    for (size_t j = 0; j < cols.Size(); j++)
      if (IsRegularDof(cols[j]))
        {
          auto & entry = entries(Place(cols[j], columns));
          if (atomic || j+num_tip >= cols.Size())
            AtomicAdd(entry, values(j));
          else
            entry += values(j);
        }
  }
}
