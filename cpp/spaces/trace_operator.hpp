#pragma once
// Functions on Γ_C whose values depend on the physical point: their elements, and the operator that evaluates them.

#include "spaces/scalar_operator.hpp"

namespace ngsxfem_contact
{
  /// The functions on T∩Γ_C.
  template <int D>
  class TraceElement : public ngfem::FiniteElement
  {
  public:
    using FiniteElement::FiniteElement;
    ngfem::ELEMENT_TYPE ElementType() const override { return D == 2 ? ngfem::ET_TRIG : ngfem::ET_TET; }
    virtual void CalcShape (const ngfem::IntegrationPoint & ip, ngbla::Vec<D> x, ngbla::BareSliceVector<> shape) const = 0;
  };

  template <int D>
  class TraceOperator : public ScalarOperator
  {
    using FiniteElement = ngfem::FiniteElement;
    static const TraceElement<D> & Of (const FiniteElement & fel) { return static_cast<const TraceElement<D>&>(fel); }
  public:
    TraceOperator () : ScalarOperator(0) { }
    string Name () const override { return "Id"; }
    bool operator== (const DifferentialOperator & other) const override { return dynamic_cast<const TraceOperator*>(&other); }
    using ScalarOperator::CalcMatrix;

    void CalcMatrix (const FiniteElement & fel, const ngfem::BaseMappedIntegrationPoint & mip, ngbla::BareSliceMatrix<double,ngbla::ColMajor> mat,
                     ngcore::LocalHeap & lh) const override
    {
      ngcore::HeapReset hr(lh);
      if (fel.GetNDof() == 0) return;
      ngbla::FlatVector<> shape(fel.GetNDof(), lh);
      auto at = mip.GetPoint();
      ngbla::Vec<D> x;
      for (int i = 0; i < D; i++) x(i) = at(i);
      Of(fel).CalcShape(mip.IP(), x, shape);
      for (int j = 0; j < fel.GetNDof(); j++) mat(0, j) = shape(j);
    }

    void CalcMatrix (const FiniteElement & fel, const ngfem::SIMD_BaseMappedIntegrationRule & mir,
                     ngbla::BareSliceMatrix<ngcore::SIMD<double>> mat) const override
    {
      if (fel.GetNDof() == 0) return;
      constexpr int lanes = ngcore::SIMD<double>::Size();
      ngcore::ArrayMem<double, 100> mem(fel.GetNDof()*lanes);
      ngbla::FlatMatrix<> shapes(lanes, fel.GetNDof(), mem.Data());
      auto at = mir.GetPoints();
      for (size_t i = 0; i < mir.Size(); i++)
        {
          for (int k = 0; k < lanes; k++)
            {
              ngfem::IntegrationPoint ip;
              ngbla::Vec<D> x;
              for (int d = 0; d < D; d++)
                {
                  ip(d) = mir.IR()[i](d)[k];
                  x(d) = at(i,d)[k];
                }
              Of(fel).CalcShape(ip, x, shapes.Row(k));
            }
          for (int j = 0; j < fel.GetNDof(); j++) mat(j, i) = ngcore::SIMD<double>([&] (int k) { return shapes(k, j); });
        }
    }
  };
}
