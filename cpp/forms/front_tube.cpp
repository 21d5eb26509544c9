#include "forms/front_tube.hpp"

namespace ngsxfem_contact
{
  using namespace ngfem;

  double FrontTube :: Evaluate (const BaseMappedIntegrationPoint &) const
  { throw ngcore::Exception("Front: tube is a vector (x1, x2, s); take a component such as front.tube[0]"); }

  void FrontTube :: Evaluate (const BaseMappedIntegrationPoint & ip, FlatVector<> result) const
  {
    auto x = ip.GetPoint();
    auto at = front.Tube(Point3(x(0), x(1), x(2)));
    result(0) = at.x1;
    result(1) = at.x2;
    result(2) = at.s;
  }

  void FrontTube :: Evaluate (const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> values) const
  {
    auto x = mir.GetPoints();
    for (size_t i = 0; i < mir.Size(); i++)
      {
        std::array<Front::TubePoint, SIMD<double>::Size()> lanes;
        for (size_t k = 0; k < lanes.size(); k++) lanes[k] = front.Tube(Point3(x(i,0)[k], x(i,1)[k], x(i,2)[k]));
        values(0, i) = SIMD<double>([&] (int k) { return lanes[k].x1; });
        values(1, i) = SIMD<double>([&] (int k) { return lanes[k].x2; });
        values(2, i) = SIMD<double>([&] (int k) { return lanes[k].s; });
      }
  }
}
