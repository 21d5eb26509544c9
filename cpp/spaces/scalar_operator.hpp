#pragma once
// Operators that make one number of a function at a point, given by their rows of values alone.

#include <fem.hpp>
#include <differentialoperator.hpp>

namespace ngsxfem_contact
{
  /// Whoever derives from it says CalcMatrix, at a point and at the points of a SIMD rule.
  class ScalarOperator : public ngfem::DifferentialOperator
  {
    using SIMDRule = ngfem::SIMD_BaseMappedIntegrationRule;
    using SIMDMatrix = ngbla::Matrix<ngcore::SIMD<double>>;

  public:
    explicit ScalarOperator (int diff_order) : DifferentialOperator(1, 1, ngfem::VOL, diff_order) { SetDimensions(ngcore::Array<int>()); }

    using ngfem::DifferentialOperator::CalcMatrix, ngfem::DifferentialOperator::Apply, ngfem::DifferentialOperator::AddTrans;

    void Apply (const ngfem::FiniteElement & fel, const ngfem::BaseMappedIntegrationPoint & mip, ngbla::BareSliceVector<double> x,
                ngbla::FlatVector<double> flux, ngcore::LocalHeap & lh) const override
    {
      ngcore::HeapReset hr(lh);
      ngbla::FlatMatrix<double, ngbla::ColMajor> mat(1, fel.GetNDof(), lh);
      CalcMatrix(fel, mip, mat, lh);
      flux(0) = 0;
      for (int j = 0; j < fel.GetNDof(); j++) flux(0) += mat(0, j) * x(j);
    }

    void Apply (const ngfem::FiniteElement & fel, const SIMDRule & mir, ngbla::BareSliceVector<double> x,
                ngbla::BareSliceMatrix<ngcore::SIMD<double>> flux) const override
    {
      SIMDMatrix mat(fel.GetNDof(), mir.Size());
      CalcMatrix(fel, mir, mat);
      flux.Row(0).Range(0, mir.Size()) = ngcore::SIMD<double>(0.);
      for (int j = 0; j < fel.GetNDof(); j++) flux.Row(0).Range(0, mir.Size()) += x(j) * mat.Row(j);
    }

    void AddTrans (const ngfem::FiniteElement & fel, const SIMDRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> flux,
                   ngbla::BareSliceVector<double> x) const override
    {
      SIMDMatrix mat(fel.GetNDof(), mir.Size());
      CalcMatrix(fel, mir, mat);
      for (int j = 0; j < fel.GetNDof(); j++)
        {
          ngcore::SIMD<double> sum(0.);
          for (size_t i = 0; i < mir.Size(); i++) sum += mat(j, i) * flux(0, i);
          x(j) += HSum(sum);
        }
    }
  };
}
