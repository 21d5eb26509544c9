#pragma once
// The unit normal and tangent of the nearest point of Γ_C, what is known of it, and the side of a point, as coefficient functions.
// A body is asked as a CutGeometry only, by its final type, so that no call in a loop over points is virtual.
// Their archives are those of pickle: body and crack go into them as objects of Python, so that what is read again shares them.

#include "cut/cracked_mesh.hpp"
#include "cut/cracked_solid.hpp"
#include <coefficient.hpp>

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
    CrackFrame (shared_ptr<const BODY> abody = nullptr, bool atangent = false);
    void DoArchive (ngcore::Archive & ar) override;
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::BaseMappedIntegrationPoint & ip, ngbla::FlatVector<> result) const override;
    void Evaluate (const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> values) const override;
  private:
    Vec<D> At (size_t element, Vec<D> x) const;
  };

  /// What a CrackLabel tells: the side of the larger part (±1), the number of the crack, whether the larger part is that of the plus or of the minus side.
  enum class Label { LargerSide, CrackNumber, LargerIsPlus, LargerIsMinus };

  /// A number that belongs to a point of Γ_C; 0 in elements that no crack meets.
  template <typename BODY>
  class CrackLabel : public ngfem::CoefficientFunctionNoDerivative
  {
    shared_ptr<const BODY> body;
    Label label;
  public:
    CrackLabel (shared_ptr<const BODY> abody = nullptr, Label alabel = Label::LargerSide) : CoefficientFunctionNoDerivative(1), body(abody), label(alabel) { }
    void DoArchive (ngcore::Archive & ar) override;
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
    explicit LargerPart (shared_ptr<const CrackedMesh> abody = nullptr) : CoefficientFunctionNoDerivative(1), body(abody) { }
    void DoArchive (ngcore::Archive & ar) override;
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> values) const override;
  private:
    double At (size_t element, const ngfem::IntegrationPoint & ip) const;
  };

  /// The limit of a function on Γ_C from one side, for functions that jump there: ±1, or 0 for the side of the larger part. It is extrapolated from two
  /// points beside the crack, so that linear functions are exact.
  template <typename BODY>
  class CrackLimit : public ngfem::CoefficientFunctionNoDerivative
  {
    static constexpr int D = BODY::dimension;
    shared_ptr<const BODY> body;
    shared_ptr<CoefficientFunction> function;
    int side = 0;
  public:
    CrackLimit () : CoefficientFunctionNoDerivative(1) { }
    CrackLimit (shared_ptr<const BODY> abody, shared_ptr<CoefficientFunction> afunction, int aside);
    void DoArchive (ngcore::Archive & ar) override;
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::BaseMappedIntegrationPoint & ip, ngbla::FlatVector<> result) const override;
  };

  /// H of one crack: +1 on its plus side, -1 on its minus side.
  class CrackSide : public ngfem::CoefficientFunctionNoDerivative
  {
    std::optional<Crack> crack;               // empty until it is read from an archive
  public:
    explicit CrackSide (std::optional<Crack> acrack = {}) : CoefficientFunctionNoDerivative(1), crack(std::move(acrack)) { }
    void DoArchive (ngcore::Archive & ar) override;
    using CoefficientFunctionNoDerivative::Evaluate;
    double Evaluate (const ngfem::BaseMappedIntegrationPoint & ip) const override;
    void Evaluate (const ngfem::SIMD_BaseMappedIntegrationRule & mir, ngbla::BareSliceMatrix<ngcore::SIMD<double>> values) const override;
  };
}
