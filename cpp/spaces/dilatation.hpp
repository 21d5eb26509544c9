#pragma once
// D u, which takes the place of div u where the material is nearly incompressible: the L² projection Π of div u onto polynomials on each
// part of an element, but for the singular divergence s of the tips' modes, D u = Π (div u - s) + s  (docs/method.md, section 11).

#include "rules/body_rules.hpp"
#include "spaces/diffops.hpp"
#include "spaces/scalar_operator.hpp"

namespace ngsxfem_contact
{
  enum class Dilatation { Projected, Singular };     // D u = Π div u + (1 - Π) s, or (1 - Π) s alone

  class DilatationOp : public ScalarOperator
  {
    Dilatation kind;
    Trace trace;
    std::shared_ptr<const BodyRules> rules;            // for the functions of the space

  public:
    DilatationOp (Dilatation akind, Trace atrace, std::shared_ptr<const BodyRules> arules);

    string Name() const override;
    bool operator== (const ngfem::DifferentialOperator & other) const override;

    using ScalarOperator::CalcMatrix;
    void CalcMatrix (const FiniteElement & fel, const ngfem::BaseMappedIntegrationPoint & mip,
                     BareSliceMatrix<double, ngfem::ColMajor> mat, LocalHeap & lh) const override;
    void CalcMatrix (const FiniteElement & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir,
                     BareSliceMatrix<SIMD<double>> mat) const override;
  };
}
