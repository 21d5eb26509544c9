#pragma once
// NGSolve's bilinear form on V_h, with the long rows of the tip functions allocated and written directly.

#include "spaces/crack_fespace.hpp"
#include <bilinearform.hpp>

namespace ngsxfem_contact
{
  using ngcore::FlatArray;

  /// A row of a tip function has an entry for every function in its disk. NGSolve's form searches a row from its start
  /// for every element, and adds all entries of all elements atomically if any unknown is shared by all of them.
  class CrackBilinearForm : public ngcomp::T_BilinearForm<double>
  {
    shared_ptr<CrackFESpace> space;
    Array<int> column;           // by dof: its place in the rows of a tip, the last one if there are several
    Array<int> tip_of;           // by dof from FirstTipDof on

  public:
    CrackBilinearForm (shared_ptr<CrackFESpace> aspace, const string & aname, const Flags & flags)
      : T_BilinearForm<double>(aspace, aname, flags), space(aspace) { }

    /// From the graph of one component, where elements are connected everywhere; else as the base class does.
    ngla::MatrixGraph GetGraph (int level, bool symmetric) override;
    void AllocateMatrix () override;
    void AddElementMatrix (FlatArray<int> rows, FlatArray<int> cols, BareSliceMatrix<double> elmat,
                           ElementId id, bool atomic, LocalHeap & lh) override;

  private:
    bool ConnectsEverywhere () const;
    size_t Place (int dof, FlatArray<int> columns) const;
  };
}
