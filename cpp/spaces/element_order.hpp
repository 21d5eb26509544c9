#pragma once
// The unknowns of a space in an order that meshes which are read again share: their numbers need not be the same.

#include <comp.hpp>

namespace ngsxfem_contact
{
  /// The unknowns in the order in which the elements of the mesh name them first; those that belong to no element are left out.
  ngcore::Array<int> ElementOrder (const ngcomp::FESpace & space);
}
