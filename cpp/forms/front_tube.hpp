#pragma once
// The coordinates around a front as a coefficient function.

#include "cut/front.hpp"
#include <coefficient.hpp>

namespace ngsxfem_contact
{
  /// (x₁, x₂, s) of Front::Tube.
  class FrontTube : public ngfem::CoefficientFunctionNoDerivative
  {
    Front front;
  public:
    explicit FrontTube (Front afront) : CoefficientFunctionNoDerivative(3), front(std::move(afront)) { }
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::BaseMappedIntegrationPoint & ip, ngbla::FlatVector<> result) const override;
    void Evaluate (const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> values) const override;
  };
}
