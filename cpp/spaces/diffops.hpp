#pragma once
// Value and gradient of a function of V_h, at a point by its position or on Γ_C as plus or minus limit, as jump, or
// as extension of the larger part.

#include "spaces/crack_element.hpp"
#include <differentialoperator.hpp>

namespace ngsxfem_contact
{
  using ngfem::BareSliceMatrix, ngfem::BareSliceVector, ngcore::LocalHeap;

  /// What an operator's name ends in.
  string NameOf (Trace trace);

  /// order 0: u; order 1: the matrix ∂_j u_i.
  template <int D>
  class CrackDiffOp : public ngfem::DifferentialOperator
  {
    int diff_order;
    Trace trace;
    size_t d;                    // scalar components: 1 or D

  public:
    CrackDiffOp (int adiff_order, Trace atrace, VorB avb);

    string Name() const override;
    bool operator== (const ngfem::DifferentialOperator & other) const override;
    /// Values need no mapping, so one operator serves elements and boundary elements: v*ds works without Trace().
    bool SupportsVB (VorB vb) const override { return vb == VB() || (diff_order == 0 && vb <= BND); }
    shared_ptr<ngfem::DifferentialOperator> GetTrace() const override;

    using ngfem::DifferentialOperator::CalcMatrix, ngfem::DifferentialOperator::Apply,
      ngfem::DifferentialOperator::ApplyTrans, ngfem::DifferentialOperator::AddTrans;

    void CalcMatrix (const FiniteElement & fel, const ngfem::BaseMappedIntegrationPoint & mip,
                     BareSliceMatrix<double, ngfem::ColMajor> mat, LocalHeap & lh) const override;
    void CalcMatrix (const FiniteElement & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir,
                     BareSliceMatrix<SIMD<double>> mat) const override;
    void Apply (const FiniteElement & fel, const ngfem::BaseMappedIntegrationPoint & mip, BareSliceVector<double> x,
                ngbla::FlatVector<double> flux, LocalHeap & lh) const override;
    void Apply (const FiniteElement & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir,
                BareSliceVector<double> x, BareSliceMatrix<SIMD<double>> flux) const override;
    void ApplyTrans (const FiniteElement & fel, const ngfem::BaseMappedIntegrationPoint & mip, ngbla::FlatVector<double> flux,
                     BareSliceVector<double> x, LocalHeap & lh) const override;
    void AddTrans (const FiniteElement & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir,
                   BareSliceMatrix<SIMD<double>> flux, BareSliceVector<double> x) const override;

    /// The scalar functions compactly: row j*d+l is component l of function j.
    void CalcScalar (const CrackFiniteElement<D> & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const;
    /// The singular functions, all components of one after the other.
    void CalcSingular (const CrackFiniteElement<D> & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const;

  private:
    void CalcHeaviside (const CrackFiniteElement<D> & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const;
    template <typename T, typename F>
    void VisitSingular (const CrackFiniteElement<D> & fel, Vec<D,T> x, int side, F && visit) const;
    template <typename F>
    void VisitSingular (const CrackFiniteElement<D> & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir, size_t i, F && visit) const;
    void ApplyScalar (const CrackFiniteElement<D> & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir,
                      BareSliceVector<double> x, BareSliceMatrix<SIMD<double>> flux) const;
    void ApplyPolynomial (const CrackFiniteElement<D> & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir,
                          BareSliceVector<double> x, BareSliceMatrix<SIMD<double>> flux) const;
    void AddTransScalar (const CrackFiniteElement<D> & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir,
                         BareSliceMatrix<SIMD<double>> flux, BareSliceVector<double> x) const;
    void AddTransPolynomial (const CrackFiniteElement<D> & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir,
                             BareSliceMatrix<SIMD<double>> flux, BareSliceVector<double> x) const;
  };
}
