#include <algorithm>
#include <cmath>
#include "algebra/schur_complement.hpp"

namespace ngsxfem_contact
{
  using namespace ngcore;
  using namespace ngbla;

  namespace
  {
    /// Runs f on column ranges, in parallel where it pays.
    template <typename F>
    void OnColumns (size_t n, double work, F f)
    {
      if (work < 1e5) f(IntRange(0, n));
      else ParallelForRange(n, f);
    }

    /// Where each entry of a sorted list stands in a longer one that contains it.
    std::vector<int> Positions (const std::vector<int> & list, const std::vector<int> & longer)
    {
      std::vector<int> positions;
      positions.reserve(list.size());
      auto place = longer.begin();
      for (int entry : list)
        {
          place = std::lower_bound(place, longer.end(), entry);
          positions.push_back(place - longer.begin());
        }
      return positions;
    }
  }

  SchurSweep :: SchurSweep (const ngla::SparseCholeskyTM<double> & afactors, const SparseColumns & aK)
    : factors(afactors), K(aK), unknown(factors.GetNUsed()), block_of(factors.GetNUsed()),
      columns(factors.GetBlocks().Size()-1), rows(columns.size()), S(K.height)
  {
    auto order = factors.GetOrder();
    for (auto dof : Range(order))
      if (order[dof] != -1) unknown[order[dof]] = dof;
    for (size_t block = 0; block < columns.size(); block++)
      for (auto i : factors.BlockDofs(block)) block_of[i] = block;
    S = 0;
  }

  void SchurSweep :: FindColumns ()
  {
    std::vector<int> merged;
    for (size_t block = 0; block < columns.size(); block++)
      {
        auto & own = columns[block];
        size_t below = own.size();
        for (auto i : factors.BlockDofs(block))
          for (int k = K.first[unknown[i]]; k < K.first[unknown[i]+1]; k++) own.push_back(K.row[k]);
        std::sort(own.begin()+below, own.end());
        std::inplace_merge(own.begin(), own.begin()+below, own.end());
        own.erase(std::unique(own.begin(), own.end()), own.end());
        auto above = factors.BlockExtDofs(block);
        if (!above.Size() || own.empty()) continue;
        auto & parent = columns[block_of[above[0]]];
        merged.clear();
        std::set_union(own.begin(), own.end(), parent.begin(), parent.end(), std::back_inserter(merged));
        parent = merged;
      }
  }

  Matrix<> & SchurSweep :: Rows (size_t block)
  {
    auto & Z = rows[block];
    if (Z.Height()) return Z;
    auto range = factors.BlockDofs(block);
    auto & active = columns[block];
    Z.SetSize(range.Size(), active.size());
    Z = 0.0;
    for (auto i : range)
      for (int k = K.first[unknown[i]]; k < K.first[unknown[i]+1]; k++)
        Z(i-range.First(), std::lower_bound(active.begin(), active.end(), K.row[k]) - active.begin()) += K.value[k];
    return Z;
  }

  Matrix<> SchurSweep :: Run ()
  {
    FindColumns();
    for (size_t block = 0; block < columns.size(); block++)
      if (columns[block].size())
        {
          Eliminate(block);
          rows[block] = Matrix<>();
          columns[block] = {};
        }
    ParallelFor(S.Height(), [&] (size_t i) { S.Row(i).Range(i+1, S.Width()) = S.Col(i).Range(i+1, S.Height()); });
    return std::move(S);
  }

  void SchurSweep :: Eliminate (size_t block)
  {
    auto range = factors.BlockDofs(block);
    size_t size = range.Size(), above = factors.BlockExtDofs(block).Size();
    auto first = factors.GetFirstInRow();
    auto lfact = factors.GetLFact();
    auto & Z = Rows(block);
    // NGSolve stores the columns of L without their diagonal 1: first the rest of the block, then the rows above
    Matrix<> Lt(size, size+above), updates(above, Z.Width());
    for (size_t i = 0; i < size; i++)
      Lt.Row(i).Range(i+1, size+above) = FlatVector<>(size-i-1+above, &lfact[first[range.First()+i]]);
    OnColumns(Z.Width(), double(size+above) * size * Z.Width(), [&] (IntRange part)
    {
      auto Zpart = Z.Cols(part);
      for (size_t i = 0; i < size; i++)
        for (size_t j = i+1; j < size; j++)
          Zpart.Row(j) -= Lt(i,j) * Zpart.Row(i);
      if (above) updates.Cols(part) = Trans(Lt.Cols(size, size+above)) * Zpart;
    });
    if (above) Pass(block, updates);
    Accumulate(block, Z);
  }

  void SchurSweep :: Pass (size_t block, SliceMatrix<> updates)
  {
    auto above = factors.BlockExtDofs(block);
    for (size_t k = 0; k < above.Size(); )
      {
        size_t target = block_of[above[k]];
        int offset = factors.BlockDofs(target).First();
        auto & Z = Rows(target);
        auto place = Positions(columns[block], columns[target]);
        for ( ; k < above.Size() && size_t(block_of[above[k]]) == target; k++)
          {
            auto row = Z.Row(above[k] - offset);
            for (size_t c = 0; c < place.size(); c++) row(place[c]) -= updates(k, c);
          }
      }
  }

  void SchurSweep :: Accumulate (size_t block, SliceMatrix<> Z)
  {
    auto & active = columns[block];
    auto diag = factors.GetDiag();     // the inverse pivots
    Matrix<> scaled(Z.Height(), Z.Width());
    for (size_t i = 0; i < Z.Height(); i++)
      scaled.Row(i) = diag[factors.BlockDofs(block).First()+i] * Z.Row(i);
    constexpr size_t strip = 128;                                // rows of S at once, each up to the diagonal
    size_t strips = (Z.Width()+strip-1) / strip;
    auto add = [&] (size_t number)
    {
      IntRange part(number*strip, std::min((number+1)*strip, Z.Width()));
      Matrix<> product = Trans(Z.Cols(part)) * scaled.Cols(0, part.Next());
      for (auto i : part)
        for (size_t j = 0; j <= i; j++)
          S(active[i], active[j]) += product(i-part.First(), j);
    };
    if (strips > 1) ParallelFor(strips, add, 4*strips);
    else add(0);
  }

  int NumNegativePivots (const ngla::SparseCholeskyTM<double> & factors)
  {
    int negative = 0;
    for (double inverse : factors.GetDiag())
      {
        if (!std::isfinite(inverse)) return -1;
        negative += inverse < 0;
      }
    return negative;
  }
}
