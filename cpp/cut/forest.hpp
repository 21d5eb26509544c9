#pragma once
// Numbers that are joined, and what hangs together in the end.

#include <algorithm>
#include <map>
#include <vector>

namespace ngsxfem_contact
{
  class Forest
  {
    std::vector<size_t> parent;
  public:
    explicit Forest (size_t n = 0) { while (parent.size() < n) Add(); }
    /// A new number, alone.
    size_t Add ()
    {
      parent.push_back(parent.size());
      return parent.size()-1;
    }
    void Join (size_t i, size_t j)
    {
      auto [first, last] = std::minmax({ Root(i), Root(j) });
      parent[last] = first;
    }
    /// Of each number its tree, numbered from 0 in the order of their first members.
    std::vector<size_t> Trees () const
    {
      std::map<size_t, size_t> number;
      std::vector<size_t> trees;
      for (size_t i = 0; i < parent.size(); i++) trees.push_back(number.insert({ Root(i), number.size() }).first->second);
      return trees;
    }
  private:
    size_t Root (size_t i) const { while (parent[i] != i) i = parent[i]; return i; }
  };
}
