#include "spaces/crack_bilinearform.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using namespace ngcomp;

  namespace
  {
    /// Which functions of one component (φ_i, then ½(H - s_i) φ_i) and of the tips meet in an element.
    class Connections
    {
      const CrackFESpace & space;
      size_t num_scalar, num_component;
      Table<int> elements;                           // the functions of one component
      std::vector<Array<int>> of_tip;                // the same, by tip, sorted
      std::vector<std::set<size_t>> tip_tips;
      Table<int> tips_of;                            // by function of one component

    public:
      explicit Connections (const CrackFESpace & aspace)
        : space(aspace), num_scalar(space.NumScalar()), num_component(num_scalar+space.NumHeaviside())
      {
        CollectElements();
        CollectTips();
      }

      MatrixGraph Graph () const
      {
        MatrixGraph component(num_component, num_component, elements, elements, false);
        Array<int> sizes(space.GetNDof());
        for (size_t f = 0; f < num_component; f++)
          for (size_t k = 0; k < 2; k++)
            sizes[Dof(f, k)] = 2*component.GetRowIndices(f).Size() + NumTipDofs(tips_of[f]);
        for (size_t tip = 0; tip < of_tip.size(); tip++)
          for (auto row : space.TipDofs(tip)) sizes[row] = 2*of_tip[tip].Size() + NumTipDofs(tip_tips[tip]);
        MatrixGraph graph(sizes, space.GetNDof());
        ParallelFor(num_component, [&] (size_t f)
        {
          for (size_t k = 0; k < 2; k++)
            Fill(graph.GetRowIndices(Dof(f, k)), component.GetRowIndices(f), tips_of[f]);
        });
        for (size_t tip = 0; tip < of_tip.size(); tip++)
          for (auto row : space.TipDofs(tip))
            Fill(graph.GetRowIndices(row), of_tip[tip], tip_tips[tip]);
        return graph;
      }

    private:
      size_t Dof (size_t f, int k) const { return f < num_scalar ? k*num_scalar+f : space.HeavisideDof(f-num_scalar, k); }

      template <typename TIPS>
      size_t NumTipDofs (const TIPS & tips) const
      {
        size_t n = 0;
        for (auto tip : tips) n += space.NumTipDofs(tip);
        return n;
      }

      void CollectElements ()
      {
        size_t ne = space.GetMeshAccess()->GetNE(VOL);
        TableCreator<int> creator(ne);
        for ( ; !creator.Done(); creator++)
          ParallelForRange(ne, [&] (IntRange range)
          {
            Array<DofId> functions;
            for (auto element : range)
              {
                space.GetComponent(ElementId(VOL, element), functions);
                for (auto f : functions)
                  if (IsRegularDof(f)) creator.Add(element, f);
              }
          });
        elements = creator.MoveTable();
      }

      void CollectTips ()
      {
        size_t num_tips = space.GetBody()->Tips().size();
        std::vector<Array<int>> elements_of(num_tips);
        tip_tips.resize(num_tips);
        for (size_t element = 0; element < elements.Size(); element++)
          for (auto tip : space.TipsAt(element))
            {
              elements_of[tip].Append(element);
              for (auto other : space.TipsAt(element)) tip_tips[tip].insert(other);
            }
        of_tip.resize(num_tips);
        Array<int> last(num_component);
        last = -1;
        TableCreator<int> creator(num_component);
        for (size_t tip = 0; tip < num_tips; tip++)
          {
            for (auto element : elements_of[tip])
              for (auto f : elements[element])
                if (std::exchange(last[f], int(tip)) != int(tip)) of_tip[tip].Append(f);
            QuickSort(of_tip[tip]);
          }
        for ( ; !creator.Done(); creator++)
          for (size_t tip = 0; tip < num_tips; tip++)
            for (auto f : of_tip[tip]) creator.Add(f, int(tip));
        tips_of = creator.MoveTable();
      }

      /// Ascending: φ_i for x, for y, Heaviside functions for x, for y, tips.
      template <typename TIPS>
      void Fill (FlatArray<int> row, FlatArray<int> functions, const TIPS & tips) const
      {
        size_t split = std::lower_bound(functions.begin(), functions.end(), int(num_scalar)) - functions.begin(), pos = 0;
        for (auto range : { IntRange(0, split), IntRange(split, functions.Size()) })
          for (size_t k = 0; k < 2; k++)
            for (auto i : range) row[pos++] = Dof(functions[i], k);
        for (auto tip : tips)
          for (auto dof : space.TipDofs(tip)) row[pos++] = dof;
      }
    };
  }

  bool CrackBilinearForm :: ConnectsEverywhere () const
  {
    if (eliminate_internal || eliminate_hidden || specialelements.Size() || se_groups.Size() || space->UsesDGCoupling()) return false;
    for (int region = 0; region < ma->GetNDomains(); region++)
      if (!space->DefinedOn(VOL, region)) return false;
    for (auto & bfi : VB_parts[VOL])
      {
        bool everywhere = !bfi->GetDefinedOnElements();
        for (int region = 0; region < ma->GetNDomains(); region++) everywhere = everywhere && bfi->DefinedOn(region);
        if (everywhere) return true;
      }
    return false;
  }

  MatrixGraph CrackBilinearForm :: GetGraph (int level, bool symmetric)
  {
    if (symmetric || !ConnectsEverywhere()) return T_BilinearForm<double>::GetGraph(level, symmetric);
    return Connections(*space).Graph();
  }

  void CrackBilinearForm :: AllocateMatrix ()
  {
    if (mats.Size() == size_t(ma->GetNLevels())) return;
    T_BilinearForm<double>::AllocateMatrix();
    column.SetSize(space->GetNDof());
    column = 0;
    tip_of.SetSize(space->GetNDof() - space->FirstTipDof());
    for (size_t tip = 0; tip < space->GetBody()->Tips().size(); tip++)
      if (auto dofs = space->TipDofs(tip); !dofs.empty())
        {
          auto columns = mymatrix->GetRowIndices(dofs[0]);
          for (size_t k = 0; k < columns.Size(); k++) column[columns[k]] = k;
          for (auto dof : dofs) tip_of[dof-space->FirstTipDof()] = tip;
        }
  }

  size_t CrackBilinearForm :: Place (int dof, FlatArray<int> columns) const
  {
    if (!IsRegularDof(dof)) return size_t(-1);
    size_t k = column[dof];
    if (k < columns.Size() && columns[k] == dof) return k;
    k = std::lower_bound(columns.begin(), columns.end(), dof) - columns.begin();
    if (k == columns.Size() || columns[k] != dof) throw Exception("CrackBilinearForm: the matrix has no such entry; the mesh or the space has changed: build the form anew");
    return k;
  }

  /// Elements of one colour share no columns but those of the tips; the rows of one tip have the same columns.
  void CrackBilinearForm :: AddElementMatrix (FlatArray<int> rows, FlatArray<int> cols, BareSliceMatrix<double> elmat,
                                              ElementId id, bool atomic, LocalHeap & lh)
  {
    size_t n = rows.Size();
    while (n > 0 && IsRegularDof(rows[n-1]) && rows[n-1] >= space->FirstTipDof()) n--;
    mymatrix->SparseMatrix<double>::AddElementMatrix(rows.Range(0, n), cols, elmat, atomic);
    int tip = -1;
    ArrayMem<size_t, 50> places(cols.Size());
    for (size_t i = n; i < rows.Size(); i++)
      {
        if (int next = tip_of[rows[i]-space->FirstTipDof()]; next != tip)
          {
            tip = next;
            for (size_t j = 0; j < cols.Size(); j++) places[j] = Place(cols[j], mymatrix->GetRowIndices(rows[i]));
          }
        auto values = mymatrix->GetRowValues(rows[i]);
        for (size_t j = 0; j < cols.Size(); j++)
          if (places[j] == size_t(-1))
            continue;
          else if (atomic || cols[j] >= space->FirstTipDof())
            AtomicAdd(values(places[j]), elmat(i, j));
          else
            values(places[j]) += elmat(i, j);
      }
  }
}
