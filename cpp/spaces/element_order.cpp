#include "spaces/element_order.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  Array<int> ElementOrder (const FESpace & space)
  {
    Array<int> order;
    Array<DofId> dofs;
    BitArray named(space.GetNDof());
    named.Clear();
    for (size_t i = 0; i < space.GetMeshAccess()->GetNE(); i++)
      {
        space.GetDofNrs(ElementId(VOL, i), dofs);
        for (auto dof : dofs)
          if (IsRegularDof(dof) && !named.Test(dof))
            {
              named.SetBit(dof);
              order.Append(dof);
            }
      }
    return order;
  }
}
