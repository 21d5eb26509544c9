#pragma once
// The three vector modes around a front of a sheet (docs/method.md, section 15).

#include "cut/front.hpp"
#include "spaces/plane_modes.hpp"

namespace ngsxfem_contact
{
  struct ModeMaterial
  {
    double kappa, mu;                             // Kolosov's constant 3 - 4ν, the shear modulus
    bool operator== (const ModeMaterial &) const = default;
  };

  class FrontFunctions
  {
    const Front & front;
    ModeMaterial material;

  public:
    static constexpr int size = 3;

    FrontFunctions (const Front & afront, ModeMaterial amaterial) : front(afront), material(amaterial) { }
    const Front & GetFront () const { return front; }
    ModeMaterial Material () const { return material; }
    void SetMaterial (ModeMaterial amaterial) { material = amaterial; }

    /// v_I, v_II, v_III with their gradients at p; T is double or SIMD<double>. side = 0: by the position of p; ±1: the limit on the sheet.
    /// They are scaled so that their coefficients are K_I, K_II, K_III.
    template <typename T>
    void Evaluate (Vec<3,T> p, int side, Vec<3,AutoDiff<3,T>> * values) const
    {
      auto at = TubeAt(p);
      AutoDiff<3,T> x = Linear(at.x1, at.e1), y = Linear(side ? T(0.) : at.x2, at.e2);
      // finite on the front itself
      T r = sqrt(x.Value()*x.Value() + y.Value()*y.Value() + 1e-32*front.Length()*front.Length());
      AutoDiff<3,T> R(r);
      for (int i = 0; i < 3; i++) R.DValue(i) = (x.Value()*x.DValue(i) + y.Value()*y.DValue(i)) / r;
      auto [C, S] = HalfAngle(x, y, r, side);
      auto plane = WilliamsModes(C, S, R).Fields(material.kappa);
      // e₁ and e₃ turn along a curved front: de₁/ds = e₃/R_f, ∇s = e₃ / (1 + x₁/R_f)
      T turn = at.curvature / (1. + at.curvature*at.x1);
      double scale = 1. / (2*material.mu*sqrt(2*M_PI));
      for (int k = 0; k < 3; k++)
        {
          AutoDiff<3,T> e1(at.e1(k)), e3(at.e3(k));
          for (int i = 0; i < 3; i++)
            {
              e1.DValue(i) = turn * at.e3(k) * at.e3(i);
              e3.DValue(i) = -turn * at.e1(k) * at.e3(i);
            }
          for (int m = 0; m < 2; m++) values[m](k) = scale * (plane[m][0]*e1 + at.e2(k)*plane[m][1]);
          values[2](k) = 4*scale * (S*e3);
        }
    }

    template <typename T>
    void Evaluate (Vec<3,T> p, int side, Vec<3,T> * values) const
    {
      Vec<3,AutoDiff<3,T>> modes[size];
      Evaluate(p, side, modes);
      for (int m = 0; m < size; m++)
        for (int k = 0; k < 3; k++) values[m](k) = modes[m](k).Value();
    }

  private:
    template <typename T>
    struct InTube { T x1, x2, curvature; Vec<3,T> e1, e2, e3; };

    InTube<double> TubeAt (Vec<3> p) const
    {
      auto at = front.Tube(p);
      auto [e1, e2, e3] = front.FrameAt(at.s);
      return { at.x1, at.x2, front.CurvatureAt(at.s), e1, e2, e3 };
    }

    InTube<SIMD<double>> TubeAt (Vec<3,SIMD<double>> p) const
    {
      std::array<InTube<double>, SIMD<double>::Size()> lanes;
      for (size_t k = 0; k < lanes.size(); k++) lanes[k] = TubeAt(Vec<3>(p(0)[k], p(1)[k], p(2)[k]));
      auto pack = [&] (auto && value) { return SIMD<double>([&] (int k) { return value(lanes[k]); }); };
      InTube<SIMD<double>> at;
      at.x1 = pack([] (auto & lane) { return lane.x1; });
      at.x2 = pack([] (auto & lane) { return lane.x2; });
      at.curvature = pack([] (auto & lane) { return lane.curvature; });
      for (int i = 0; i < 3; i++)
        {
          at.e1(i) = pack([i] (auto & lane) { return lane.e1(i); });
          at.e2(i) = pack([i] (auto & lane) { return lane.e2(i); });
          at.e3(i) = pack([i] (auto & lane) { return lane.e3(i); });
        }
      return at;
    }

    template <typename T>
    static AutoDiff<3,T> Linear (T value, Vec<3,T> gradient)
    {
      AutoDiff<3,T> x(value);
      for (int i = 0; i < 3; i++) x.DValue(i) = gradient(i);
      return x;
    }
  };
}
