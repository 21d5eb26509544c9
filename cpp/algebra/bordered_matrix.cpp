#include "algebra/bordered_matrix.hpp"

namespace ngsxfem_contact
{
  using namespace ngcore;

  namespace
  {
    /// Position of each unknown among those that are kept, -1 for the others; and the kept ones.
    std::pair<Array<int>,Array<int>> Number (const BitArray & kept)
    {
      Array<int> number(kept.Size()), unknown;
      number = -1;
      for (auto i : Range(kept.Size()))
        if (kept.Test(i))
          {
            number[i] = unknown.Size();
            unknown.Append(i);
          }
      return { std::move(number), std::move(unknown) };
    }
  }

  UpperTriangle BorderedMatrix (const ngla::SparseMatrix<double> & A, const BitArray & inner, const SparseColumns & K)
  {
    auto [number, unknown] = Number(inner);
    size_t n = unknown.Size(), N = n + K.height;
    UpperTriangle T { Array<int>(N+1), Array<int>(), Array<double>() };
    ParallelFor(n, [&] (size_t i)
    {
      int entries = K.first[unknown[i]+1] - K.first[unknown[i]];
      for (int j : A.GetRowIndices(unknown[i])) entries += number[j] >= int(i);
      T.first[i+1] = entries;
    });
    T.first[0] = 0;
    for (size_t i = n; i < N; i++) T.first[i+1] = 1;
    for (size_t i = 0; i < N; i++) T.first[i+1] += T.first[i];
    T.column.SetSize(T.first[N]);
    T.value.SetSize(T.first[N]);
    ParallelFor(n, [&, &number = number, &unknown = unknown] (size_t i)
    {
      int place = T.first[i];
      auto columns = A.GetRowIndices(unknown[i]);
      auto values = A.GetRowValues(unknown[i]);
      for (auto k : Range(columns))
        if (number[columns[k]] >= int(i))
          {
            T.column[place] = number[columns[k]];
            T.value[place++] = values[k];
          }
      for (int k = K.first[unknown[i]]; k < K.first[unknown[i]+1]; k++)
        {
          T.column[place] = n + K.row[k];
          T.value[place++] = K.value[k];
        }
    });
    for (size_t i = n; i < N; i++)
      {
        T.column[T.first[i]] = i;
        T.value[T.first[i]] = 0;
      }
    return T;
  }
}
