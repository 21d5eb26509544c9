#pragma once
// The unit normal and tangent of the nearest point of Γ_C, what is known of it, and the side of a point, as coefficient functions.
// A body is asked as a CutGeometry only, by its final type, so that no call in a loop over points is virtual.

#include "cut/cracked_mesh.hpp"
#include "cut/cracked_solid.hpp"
#include <coefficient.hpp>
#include <functional>

namespace ngsxfem_contact
{
  using ngfem::CoefficientFunction;

  /// n (tangent = false) or the first tangent of the crack of the element; elsewhere of the nearest crack. BODY: CrackedMesh or CrackedSolid.
  template <typename BODY>
  class CrackFrame : public ngfem::CoefficientFunctionNoDerivative
  {
    static constexpr int D = BODY::dimension;
    shared_ptr<const BODY> body;
    bool tangent;
  public:
    CrackFrame (shared_ptr<const BODY> abody, bool atangent);
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::BaseMappedIntegrationPoint & ip, ngbla::FlatVector<> result) const override;
    void Evaluate (const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> values) const override;
  private:
    Vec<D> At (size_t element, Vec<D> x) const;
  };

  /// A number that belongs to a point of Γ_C; 0 in elements that no crack meets.
  template <typename BODY>
  class CrackLabel : public ngfem::CoefficientFunctionNoDerivative
  {
    using Label = std::function<double(const CrackSides &)>;
    shared_ptr<const BODY> body;
    Label label;
  public:
    CrackLabel (shared_ptr<const BODY> abody, Label alabel) : CoefficientFunctionNoDerivative(1), body(abody), label(std::move(alabel)) { }
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> values) const override;
  private:
    double At (size_t element, Vec<BODY::dimension> x) const;
  };

  /// 1 in the larger parts beside Γ_C, 0 elsewhere, by the position of a point.
  class LargerPart : public ngfem::CoefficientFunctionNoDerivative
  {
    shared_ptr<const CrackedMesh> body;
  public:
    explicit LargerPart (shared_ptr<const CrackedMesh> abody) : CoefficientFunctionNoDerivative(1), body(abody) { }
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> values) const override;
  private:
    double At (size_t element, const ngfem::IntegrationPoint & ip) const;
  };

  /// The limit of a function on Γ_C from one side, for functions that jump there: ±1, or 0 for the side of the larger part. It is extrapolated from two
  /// points beside the crack, so that linear functions are exact.
  class CrackLimit : public ngfem::CoefficientFunctionNoDerivative
  {
    shared_ptr<const CrackedMesh> body;
    shared_ptr<CoefficientFunction> function;
    int side;
  public:
    CrackLimit (shared_ptr<const CrackedMesh> abody, shared_ptr<CoefficientFunction> afunction, int aside);
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::BaseMappedIntegrationPoint & ip, ngbla::FlatVector<> result) const override;
  };

  /// H of one crack: +1 on its plus side, -1 on its minus side.
  class CrackSide : public ngfem::CoefficientFunctionNoDerivative
  {
    Crack crack;
  public:
    explicit CrackSide (Crack acrack) : CoefficientFunctionNoDerivative(1), crack(std::move(acrack)) { }
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> values) const override;
  };
}
