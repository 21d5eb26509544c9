#include "forms/element_matrices.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  namespace
  {
    /// (number of dofs of the largest element, dofs of all elements).
    std::pair<size_t, Array<int>> DofsOf (const FESpace & space, FlatArray<int> elements)
    {
      std::vector<Array<DofId>> of_element(elements.Size());
      size_t most = 0;
      for (size_t i = 0; i < elements.Size(); i++)
        {
          space.GetDofNrs(ElementId(VOL, elements[i]), of_element[i]);
          most = std::max(most, of_element[i].Size());
        }
      Array<int> dofs(elements.Size()*most);
      dofs = -1;
      for (size_t i = 0; i < elements.Size(); i++)
        std::copy(of_element[i].begin(), of_element[i].end(), &dofs[i*most]);
      return { most, std::move(dofs) };
    }

    /// The sum over the integrals; again, if one finds that its functions have no SIMD versions.
    void AddIntegrals (const BilinearForm & form, const FiniteElement & fel, const ElementTransformation & trafo, FlatMatrix<double> matrix, LocalHeap & lh)
    {
      for (bool done = false; !done; )
        try
          {
            matrix = 0;
            bool symmetric = true;
            for (auto & integral : form.Integrators())
              if (integral->VB() == VOL && integral->DefinedOn(trafo.GetElementIndex()) && integral->DefinedOnElement(trafo.GetElementNr()))
                integral->CalcElementMatrixAdd(fel, trafo, matrix, symmetric, lh);
            done = true;
          }
        catch (const ngcore::ExceptionNOSIMD &) { }
    }
  }

  ElementMatrices MatricesOf (const BilinearForm & form, FlatArray<int> elements)
  {
    auto & trial = *form.GetTrialSpace(), & test = *form.GetTestSpace();
    auto & mesh = *trial.GetMeshAccess();
    ElementMatrices all;
    std::tie(all.height, all.rows) = DofsOf(test, elements);
    std::tie(all.width, all.columns) = DofsOf(trial, elements);
    all.values.SetSize(elements.Size()*all.height*all.width);
    all.values = 0;
    LocalHeap heap(10000000, "element matrices", true);
    ParallelForRange(elements.Size(), [&] (IntRange range)
    {
      LocalHeap lh = heap.Split();
      for (auto i : range)
        {
          HeapReset hr(lh);
          ElementId id(VOL, elements[i]);
          auto & trafo = mesh.GetTrafo(id, lh);
          auto & of_trial = trial.GetFE(id, lh), & of_test = form.MixedSpaces() ? test.GetFE(id, lh) : of_trial;
          MixedFiniteElement both(of_trial, of_test);
          FlatMatrix<double> matrix(of_test.GetNDof(), of_trial.GetNDof(), lh);
          AddIntegrals(form, form.MixedSpaces() ? static_cast<const FiniteElement&>(both) : of_trial, trafo, matrix, lh);
          FlatMatrix<double>(all.height, all.width, &all.values[i*all.height*all.width]).Rows(0, matrix.Height()).Cols(0, matrix.Width()) = matrix;
        }
    });
    return all;
  }
}
