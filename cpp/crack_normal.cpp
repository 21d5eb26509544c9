#include "crack_normal.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using namespace ngfem;

  CrackFrame :: CrackFrame (shared_ptr<CrackedMesh> abody, bool atangent)
    : CoefficientFunctionNoDerivative(2), body(abody), tangent(atangent) { }

  Point CrackFrame :: At (size_t element, Point x) const
  {
    auto & cracks = body->Cracks();
    auto distance = [&] (auto & crack) { return crack.Nearest(x).distance; };
    auto cut = body->Find(element);
    auto & curve = cut ? cracks[cut->CrackAt(cracks, x).crack] : *std::ranges::min_element(cracks, {}, distance);
    Point t = curve.Tangent(curve.Nearest(x));
    return tangent ? t : Left(t);
  }

  double CrackFrame :: Evaluate (const BaseMappedIntegrationPoint &) const
  { throw ngcore::Exception("CrackedMesh: normal and tangent are vectors; take a component such as body.normal[0]"); }

  void CrackFrame :: Evaluate (const BaseMappedIntegrationPoint & ip, FlatVector<> result) const
  {
    auto x = ip.GetPoint();
    result = At(ip.GetTransformation().GetElementNr(), Point(x(0), x(1)));
  }

  void CrackFrame :: Evaluate (const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> values) const
  {
    auto x = mir.GetPoints();
    size_t element = mir.GetTransformation().GetElementNr();
    for (size_t i = 0; i < mir.Size(); i++)
      for (int k = 0; k < 2; k++)
        values(k, i) = SIMD<double>([&] (int lane) { return At(element, Point(x(i,0)[lane], x(i,1)[lane]))(k); });
  }

  double CrackLabel :: At (size_t element, Point x) const
  {
    auto cut = body->Find(element);
    return cut ? label(cut->CrackAt(body->Cracks(), x)) : 0;
  }

  double CrackLabel :: Evaluate (const BaseMappedIntegrationPoint & ip) const
  {
    auto x = ip.GetPoint();
    return At(ip.GetTransformation().GetElementNr(), Point(x(0), x(1)));
  }

  void CrackLabel :: Evaluate (const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> values) const
  {
    auto x = mir.GetPoints();
    size_t element = mir.GetTransformation().GetElementNr();
    for (size_t i = 0; i < mir.Size(); i++)
      values(0, i) = SIMD<double>([&] (int lane) { return At(element, Point(x(i,0)[lane], x(i,1)[lane])); });
  }

  double CrackSide :: Evaluate (const BaseMappedIntegrationPoint & ip) const
  {
    auto x = ip.GetPoint();
    return int(crack.SideOf(Point(x(0), x(1))));
  }

  void CrackSide :: Evaluate (const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> values) const
  {
    auto x = mir.GetPoints();
    for (size_t i = 0; i < mir.Size(); i++)
      values(0, i) = SIMD<double>([&] (int lane) { return double(int(crack.SideOf(Point(x(i,0)[lane], x(i,1)[lane])))); });
  }
}
