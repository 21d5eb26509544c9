#pragma once
// The three vector modes around a front of a sheet (docs/method.md, section 15).

#include "cut/flat_map.hpp"
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
    /// flat: the coordinates of a curved sheet in the element of p, nullptr for a planar one. They are scaled so that their coefficients are K_I, K_II, K_III.
    template <typename T>
    void Evaluate (Vec<3,T> p, int side, const FlatMap * flat, Vec<3,AutoDiff<3,T>> * values) const
    {
      if (flat) return EvaluateCurved(p, side, *flat, values);
      auto at = TubeAt<PlanarTube<T>>(p);
      auto [C, S, R] = Polar(Linear(at.x1, at.e1), Linear(side ? T(0.) : at.x2, at.e2), side);
      auto plane = WilliamsModes(C, S, R).Fields(material.kappa);
      // e₁ and e₃ turn along a curved front: de₁/ds = e₃/R_f, ∇s = e₃ / (1 + x₁/R_f)
      T turn = at.curvature / (1. + at.curvature*at.x1);
      double scale = Scale();
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
    void Evaluate (Vec<3,T> p, int side, const FlatMap * flat, Vec<3,T> * values) const
    {
      Vec<3,AutoDiff<3,T>> modes[size];
      Evaluate(p, side, flat, modes);
      for (int m = 0; m < size; m++)
        for (int k = 0; k < 3; k++) values[m](k) = modes[m](k).Value();
    }

  private:
    double Scale () const { return 1. / (2*material.mu*sqrt(2*M_PI)); }

    /// √r cos(θ/2), √r sin(θ/2) and r.
    template <typename T>
    std::array<AutoDiff<3,T>,3> Polar (AutoDiff<3,T> x, AutoDiff<3,T> y, int side) const
    {
      // finite on the front itself
      T r = sqrt(x.Value()*x.Value() + y.Value()*y.Value() + 1e-32*front.Length()*front.Length());
      AutoDiff<3,T> R(r);
      for (int i = 0; i < 3; i++) R.DValue(i) = (x.Value()*x.DValue(i) + y.Value()*y.DValue(i)) / r;
      auto [C, S] = HalfAngle(x, y, r, side);
      return { C, S, R };
    }

    /// x₁, x₂ and s are functions of the flat coordinates, which are affine in the element: x₂ = 0 on the sheet there. The frame is that of the surface at C(s), and x₁, x₂
    /// become components along it.
    template <typename T>
    void EvaluateCurved (Vec<3,T> p, int side, const FlatMap & flat, Vec<3,AutoDiff<3,T>> * values) const
    {
      Vec<3,T> y;
      for (int k = 0; k < 3; k++) y(k) = flat.rows[k](0) + flat.rows[k](1)*p(0) + flat.rows[k](2)*p(1) + flat.rows[k](3)*p(2);
      auto at = TubeAt<CurvedTube<T>>(y);
      auto gradient = [&] (const Vec<3,T> & d)                       // of a flat coordinate along d
      {
        Vec<3,T> g;
        for (int i = 0; i < 3; i++) g(i) = d(0)*flat.rows[0](i+1) + d(1)*flat.rows[1](i+1) + d(2)*flat.rows[2](i+1);
        return g;
      };
      Vec<3,T> ds = gradient(at.along), dx1 = gradient(at.ahead), dx2 = gradient(Cross3(at.along, at.ahead));
      T x2 = side ? T(0.) : at.x2;
      AutoDiff<3,T> y1(at.stretch[0]*at.x1 + at.stretch[1]*x2), y2(at.stretch[2]*x2);
      for (int i = 0; i < 3; i++)
        {
          ds(i) = ds(i) / (1. + at.curvature*at.x1);
          y1.DValue(i) = at.stretch[0]*dx1(i) + at.stretch[1]*dx2(i) + (at.stretch_change[0]*at.x1 + at.stretch_change[1]*x2)*ds(i);
          y2.DValue(i) = at.stretch[2]*dx2(i) + at.stretch_change[2]*x2*ds(i);
        }
      auto [C, S, R] = Polar(y1, y2, side);
      auto plane = WilliamsModes(C, S, R).Fields(material.kappa);
      double scale = Scale();
      for (int k = 0; k < 3; k++)
        {
          AutoDiff<3,T> e[3];
          for (int j = 0; j < 3; j++)
            {
              e[j] = AutoDiff<3,T>(at.frame[j](k));
              for (int i = 0; i < 3; i++) e[j].DValue(i) = at.turn[j](k) * ds(i);
            }
          for (int m = 0; m < 2; m++) values[m](k) = scale * (plane[m][0]*e[0] + plane[m][1]*e[1]);
          values[2](k) = 4*scale * (S*e[2]);
        }
    }

    template <typename T>
    static Vec<3,T> Cross3 (const Vec<3,T> & a, const Vec<3,T> & b)
    { return Vec<3,T>(a(1)*b(2)-a(2)*b(1), a(2)*b(0)-a(0)*b(2), a(0)*b(1)-a(1)*b(0)); }

    /// The frame of a front at a point. Visit(visit): visit(number) for all of its numbers.
    template <typename T>
    struct PlanarTube
    {
      template <typename U> using Of = PlanarTube<U>;
      T x1, x2, curvature;
      Vec<3,T> e1, e2, e3;
      void Set (const Front & front, const Front::TubePoint & at)
      {
        auto [a1, a2, a3] = front.FrameAt(at.s);
        x1 = at.x1; x2 = at.x2; curvature = front.CurvatureAt(at.s);
        e1 = a1; e2 = a2; e3 = a3;
      }
      template <typename F> void Visit (F && visit) { visit(x1); visit(x2); visit(curvature); VisitAll(visit, e1, e2, e3); }
    };

    /// ahead, along: directions of x₁ and s in flat coordinates. frame, stretch: of Front::LocalAt, and their derivatives by s.
    template <typename T>
    struct CurvedTube
    {
      template <typename U> using Of = CurvedTube<U>;
      T x1, x2, curvature, stretch[3], stretch_change[3];
      Vec<3,T> ahead, along, frame[3], turn[3];
      void Set (const Front & front, const Front::TubePoint & at)
      {
        auto [a1, a3] = front.FlatFrameAt(at.s);
        x1 = at.x1; x2 = at.x2; curvature = front.CurvatureAt(at.s);
        ahead = a1; along = a3;
        auto local = front.LocalAt(at.s), change = front.TurnAt(at.s);
        for (int k = 0; k < 3; k++)
          {
            frame[k] = local.frame[k];
            turn[k] = change.frame[k];
            stretch[k] = local.stretch[k];
            stretch_change[k] = change.stretch[k];
          }
      }
      template <typename F> void Visit (F && visit)
      {
        visit(x1); visit(x2); visit(curvature);
        for (int k = 0; k < 3; k++) { visit(stretch[k]); visit(stretch_change[k]); }
        VisitAll(visit, ahead, along, frame[0], frame[1], frame[2], turn[0], turn[1], turn[2]);
      }
    };

    template <typename F, typename... VECTORS>
    static void VisitAll (F && visit, VECTORS & ... vectors)
    { ([&] (auto & v) { for (int i = 0; i < 3; i++) visit(v(i)); } (vectors), ...); }

    /// p: in the coordinates of Sheet::Flat.
    template <typename TUBE, typename T>
    TUBE TubeAt (Vec<3,T> p) const
    {
      TUBE tube;
      if constexpr (std::is_same_v<T, double>) tube.Set(front, front.FlatTube(p));
      else
        {
          std::array<std::array<double,33>, T::Size()> lanes;
          for (size_t k = 0; k < lanes.size(); k++)
            {
              typename TUBE::template Of<double> lane;
              lane.Set(front, front.FlatTube(Vec<3>(p(0)[k], p(1)[k], p(2)[k])));
              size_t n = 0;
              lane.Visit([&] (double & value) { lanes[k][n++] = value; });
            }
          size_t n = 0;
          tube.Visit([&] (T & value) { value = T([&] (int k) { return lanes[k][n]; }); n++; });
        }
      return tube;
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
