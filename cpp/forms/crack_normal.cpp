#include "forms/crack_normal.hpp"
#include <any>
#include <core/register_archive.hpp>

namespace ngsxfem_contact
{
  using namespace ngfem;
  using ngcore::Archive;

  template <typename T>
  static void ArchiveForPython (Archive & ar, T & value)
  {
    std::any any = value;
    ar.Shallow(any);
    if (ar.Input()) value = std::any_cast<T>(any);
  }

  template <typename BODY>
  static void ArchiveBody (Archive & ar, shared_ptr<const BODY> & body)
  {
    auto own = std::const_pointer_cast<BODY>(body);
    ArchiveForPython(ar, own);
    body = own;
  }

  template <typename BODY>
  void CrackFrame<BODY> :: DoArchive (Archive & ar)
  {
    CoefficientFunctionNoDerivative::DoArchive(ar);
    ArchiveBody(ar, body);
    ar & tangent;
  }

  template <typename BODY>
  void CrackLabel<BODY> :: DoArchive (Archive & ar)
  {
    CoefficientFunctionNoDerivative::DoArchive(ar);
    ArchiveBody(ar, body);
    ar & label;
  }

  void LargerPart :: DoArchive (Archive & ar)
  {
    CoefficientFunctionNoDerivative::DoArchive(ar);
    ArchiveBody(ar, body);
  }

  template <typename BODY>
  void CrackLimit<BODY> :: DoArchive (Archive & ar)
  {
    CoefficientFunctionNoDerivative::DoArchive(ar);
    ArchiveBody(ar, body);
    ar.Shallow(function) & side;
  }

  void CrackSide :: DoArchive (Archive & ar)
  {
    CoefficientFunctionNoDerivative::DoArchive(ar);
    Crack own = crack ? *crack : Crack(std::vector<Point> { Point(0, 0), Point(1, 0) });   // of what is read, replaced at once
    ArchiveForPython(ar, own);
    crack = own;
  }

  static ngcore::RegisterClassForArchive<CrackFrame<CrackedMesh>, CoefficientFunction> register_frame;
  static ngcore::RegisterClassForArchive<CrackLabel<CrackedMesh>, CoefficientFunction> register_label;
  static ngcore::RegisterClassForArchive<CrackFrame<CrackedSolid>, CoefficientFunction> register_solid_frame;
  static ngcore::RegisterClassForArchive<CrackLabel<CrackedSolid>, CoefficientFunction> register_solid_label;
  static ngcore::RegisterClassForArchive<LargerPart, CoefficientFunction> register_larger_part;
  static ngcore::RegisterClassForArchive<CrackLimit<CrackedMesh>, CoefficientFunction> register_limit;
  static ngcore::RegisterClassForArchive<CrackLimit<CrackedSolid>, CoefficientFunction> register_solid_limit;
  static ngcore::RegisterClassForArchive<CrackSide, CoefficientFunction> register_side;

  namespace
  {
    template <int D>
    Vec<D> PointOf (const BaseMappedIntegrationPoint & ip)
    {
      Vec<D> x;
      for (int k = 0; k < D; k++) x(k) = ip.GetPoint()(k);
      return x;
    }

    template <int D>
    Vec<D> PointOf (const SIMD_BaseMappedIntegrationRule & mir, size_t i, int lane)
    {
      Vec<D> x;
      for (int k = 0; k < D; k++) x(k) = mir.GetPoints()(i, k)[lane];
      return x;
    }
  }

  template <typename BODY>
  CrackFrame<BODY> :: CrackFrame (shared_ptr<const BODY> abody, bool atangent)
    : CoefficientFunctionNoDerivative(D), body(abody), tangent(atangent) { }

  template <typename BODY>
  auto CrackFrame<BODY> :: At (size_t element, Vec<D> x) const -> Vec<D>
  {
    auto cut = body->Find(element);
    auto frame = body->FrameAt(body->CrackAt(cut, x), cut, x);
    return tangent ? frame.tangents[0] : frame.normal;
  }

  template <typename BODY>
  double CrackFrame<BODY> :: Evaluate (const BaseMappedIntegrationPoint &) const
  { throw ngcore::Exception("CrackedMesh: normal and tangent are vectors; take a component such as body.normal[0]"); }

  template <typename BODY>
  void CrackFrame<BODY> :: Evaluate (const BaseMappedIntegrationPoint & ip, FlatVector<> result) const
  { result = At(ip.GetTransformation().GetElementNr(), PointOf<D>(ip)); }

  template <typename BODY>
  void CrackFrame<BODY> :: Evaluate (const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> values) const
  {
    size_t element = mir.GetTransformation().GetElementNr();
    for (size_t i = 0; i < mir.Size(); i++)
      for (int k = 0; k < D; k++)
        values(k, i) = SIMD<double>([&] (int lane) { return At(element, PointOf<D>(mir, i, lane))(k); });
  }

  template <typename BODY>
  double CrackLabel<BODY> :: At (size_t element, Vec<BODY::dimension> x) const
  {
    auto cut = body->Find(element);
    if (!cut) return 0;
    auto here = cut->SidesAt(x);
    switch (label)
      {
      case Label::LargerSide: return here.larger_side;
      case Label::CrackNumber: return double(here.crack);
      case Label::LargerIsPlus: return here.Larger() == here.plus;
      case Label::LargerIsMinus: return here.Larger() == here.minus;
      }
    return 0;
  }

  template <typename BODY>
  double CrackLabel<BODY> :: Evaluate (const BaseMappedIntegrationPoint & ip) const
  { return At(ip.GetTransformation().GetElementNr(), PointOf<BODY::dimension>(ip)); }

  template <typename BODY>
  void CrackLabel<BODY> :: Evaluate (const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> values) const
  {
    size_t element = mir.GetTransformation().GetElementNr();
    for (size_t i = 0; i < mir.Size(); i++)
      values(0, i) = SIMD<double>([&] (int lane) { return At(element, PointOf<BODY::dimension>(mir, i, lane)); });
  }

  template class CrackFrame<CrackedMesh>;
  template class CrackFrame<CrackedSolid>;
  template class CrackLabel<CrackedMesh>;
  template class CrackLabel<CrackedSolid>;

  double LargerPart :: At (size_t element, const IntegrationPoint & ip) const
  {
    auto cut = body->Find(element);
    return cut && cut->IsLarger(cut->PartAt(ip), std::nullopt);
  }

  double LargerPart :: Evaluate (const BaseMappedIntegrationPoint & mip) const
  { return At(mip.GetTransformation().GetElementNr(), mip.IP()); }

  void LargerPart :: Evaluate (const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> values) const
  {
    size_t element = mir.GetTransformation().GetElementNr();
    for (size_t i = 0; i < mir.Size(); i++)
      values(0, i) = SIMD<double>([&] (int lane) { return At(element, IntegrationPoint(mir.IR()[i](0)[lane], mir.IR()[i](1)[lane], 0, 0)); });
  }

  template <typename BODY>
  CrackLimit<BODY> :: CrackLimit (shared_ptr<const BODY> abody, shared_ptr<CoefficientFunction> afunction, int aside)
    : CoefficientFunctionNoDerivative(afunction->Dimension()), body(abody), function(afunction), side(aside)
  { SetDimensions(function->Dimensions()); }

  template <typename BODY>
  double CrackLimit<BODY> :: Evaluate (const BaseMappedIntegrationPoint & ip) const
  {
    Vector<> value(Dimension());
    Evaluate(ip, value);
    return value(0);
  }

  template <typename BODY>
  void CrackLimit<BODY> :: Evaluate (const BaseMappedIntegrationPoint & bip, FlatVector<> result) const
  {
    auto & ip = static_cast<const MappedIntegrationPoint<D,D>&>(bip);
    auto x = PointOf<D>(ip);
    auto cut = body->Find(ip.GetTransformation().GetElementNr());
    if (!cut) return function->Evaluate(bip, result);
    auto sides = cut->SidesAt(x);
    Vec<D> step = 1e-6*(side ? side : sides.larger_side)*cut->h*body->FrameAt(sides.crack, cut, x).normal;
    Vec<D> off = ip.GetJacobianInverse() * step;
    auto at = [&] (double factor, FlatVector<> values)
    {
      IntegrationPoint moved = ip.IP();
      for (int k = 0; k < D; k++) moved(k) += factor*off(k);
      MappedIntegrationPoint<D,D> mapped(moved, ip.GetTransformation());
      function->Evaluate(mapped, values);
    };
    Vector<> farther(result.Size());
    at(1, result);
    at(2, farther);
    result = 2*result - farther;
  }

  template class CrackLimit<CrackedMesh>;
  template class CrackLimit<CrackedSolid>;

  double CrackSide :: Evaluate (const BaseMappedIntegrationPoint & ip) const
  {
    auto x = ip.GetPoint();
    return int(crack->SideOf(Point(x(0), x(1))));
  }

  void CrackSide :: Evaluate (const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> values) const
  {
    auto x = mir.GetPoints();
    for (size_t i = 0; i < mir.Size(); i++)
      values(0, i) = SIMD<double>([&] (int lane) { return double(int(crack->SideOf(Point(x(i,0)[lane], x(i,1)[lane])))); });
  }
}
