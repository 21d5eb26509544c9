#include "spaces/diffops.hpp"

namespace ngsxfem_contact
{
  using namespace ngfem;

  template <int D>
  CrackDiffOp<D> :: CrackDiffOp (int adiff_order, Trace atrace, VorB avb)
    : DifferentialOperator(adiff_order ? D*D : D, 1, avb, adiff_order),
      diff_order(adiff_order), trace(atrace), d(adiff_order ? D : 1)
  {
    if (diff_order) SetDimensions({ D, D });
  }

  string NameOf (Trace trace)
  {
    static const std::map<Trace, string> names
      { { Trace::Position, "" }, { Trace::Plus, "plus" }, { Trace::Minus, "minus" }, { Trace::Jump, "jump" }, { Trace::Larger, "larger" } };
    return names.at(trace);
  }

  template <int D>
  string CrackDiffOp<D> :: Name () const
  {
    if (diff_order) return "grad" + NameOf(trace);
    return trace == Trace::Position ? "Id" : NameOf(trace);
  }

  template <int D>
  bool CrackDiffOp<D> :: operator== (const DifferentialOperator & other) const
  {
    auto op = dynamic_cast<const CrackDiffOp<D>*>(&other);
    return op && op->diff_order == diff_order && op->trace == trace && op->VB() == VB();
  }

  template <int D>
  shared_ptr<DifferentialOperator> CrackDiffOp<D> :: GetTrace () const
  {
    if (diff_order || VB() == BND) return nullptr;
    return make_shared<CrackDiffOp<D>>(0, trace, BND);
  }

  namespace
  {
    constexpr size_t lanes = SIMD<double>::Size();

    template <int D>
    PlacedPoint<D> Placed (const BaseMappedIntegrationPoint & mip)
    {
      auto p = mip.GetPoint();
      Vec<D> x;
      for (int k = 0; k < D; k++) x(k) = p(k);
      return { mip.IP(), x };
    }

    template <int D>
    Vec<D,SIMD<double>> PointOf (const SIMD_BaseMappedIntegrationRule & mir, size_t i)
    {
      auto p = mir.GetPoints();
      Vec<D,SIMD<double>> x;
      for (int k = 0; k < D; k++) x(k) = p(i, k);
      return x;
    }

    template <int D>
    std::array<PlacedPoint<D>, lanes> Placed (const SIMD_BaseMappedIntegrationRule & mir, size_t i)
    {
      std::array<PlacedPoint<D>, lanes> points;
      auto x = PointOf<D>(mir, i);
      auto & ip = mir.IR()[i];
      for (size_t lane = 0; lane < lanes; lane++)
        {
          Vec<D> at;
          for (int k = 0; k < D; k++) at(k) = x(k)[lane];
          points[lane] = { IntegrationPoint(ip(0)[lane], ip(1)[lane], ip(2)[lane], 0), at };
        }
      return points;
    }

    /// visit(j, factor) for every Heaviside function.
    template <int D, typename F>
    void VisitFactors (const CrackFiniteElement<D> & fel, Trace trace, const SIMD_BaseMappedIntegrationRule & mir, size_t i, F && visit)
    {
      auto at = Placed<D>(mir, i);
      for (size_t j = 0; j < fel.Heaviside().Size(); j++)
        visit(j, SIMD<double>([&] (int lane) { return double(fel.HeavisideFactor(fel.Heaviside()[j], trace, at[lane])); }));
    }
  }

  /// visit(m, component, value) for every component of the m-th singular function.
  template <int D>
  template <typename T, typename F>
  void CrackDiffOp<D> :: VisitSingular (const CrackFiniteElement<D> & fel, Vec<D,T> x, int side, F && visit) const
  {
    if (diff_order)
      fel.template VisitSingular<Vec<D,AutoDiff<D,T>>>(x, trace, side, [&] (size_t m, auto & f)
      {
        for (size_t k = 0; k < D; k++)
          for (size_t l = 0; l < D; l++) visit(m, D*k+l, f(k).DValue(l));
      });
    else
      fel.template VisitSingular<Vec<D,T>>(x, trace, side, [&] (size_t m, auto & f)
      {
        for (size_t k = 0; k < D; k++) visit(m, k, f(k));
      });
  }

  /// Points of one vector may ask for limits from different sides: then one by one.
  template <int D>
  template <typename F>
  void CrackDiffOp<D> :: VisitSingular (const CrackFiniteElement<D> & fel, const SIMD_BaseMappedIntegrationRule & mir, size_t i, F && visit) const
  {
    if (fel.Singular().Empty()) return;
    if (trace != Trace::Larger)                             // the same side for all points
      {
        PlacedPoint<D> anywhere;
        return VisitSingular(fel, PointOf<D>(mir, i), fel.ForcedSide(trace, anywhere), visit);
      }
    std::array<int,lanes> sides;
    auto at = Placed<D>(mir, i);
    for (size_t lane = 0; lane < lanes; lane++) sides[lane] = fel.ForcedSide(trace, at[lane]);
    if (std::ranges::all_of(sides, [&] (int side) { return side == sides[0]; })) return VisitSingular(fel, PointOf<D>(mir, i), sides[0], visit);
    std::vector<SIMD<double>> values(fel.NumSingular()*D*d, SIMD<double>(0.));
    for (size_t lane = 0; lane < lanes; lane++)
      VisitSingular(fel, Vec<D>(at[lane].Place()), sides[lane], [&] (size_t m, size_t component, double value)
      { auto & all = values[m*D*d+component]; all = SIMD<double>([&] (size_t k) { return k == lane ? value : all[k]; }); });
    for (size_t m = 0; m < fel.NumSingular(); m++)
      for (size_t component = 0; component < D*d; component++) visit(m, component, values[m*D*d+component]);
  }

  template <int D>
  void CrackDiffOp<D> :: CalcMatrix (const FiniteElement & bfel, const BaseMappedIntegrationPoint & mip,
                                  BareSliceMatrix<double, ColMajor> mat, LocalHeap & lh) const
  {
    HeapReset hr(lh);
    auto & fel = static_cast<const CrackFiniteElement<D>&>(bfel);
    size_t nd = fel.Scalar().GetNDof(), n = fel.NumScalar();
    FlatMatrix<double> shape(n, d, lh);
    if (diff_order)
      fel.Scalar().CalcMappedDShape(mip, shape);
    else
      fel.Scalar().CalcShape(mip.IP(), shape.Col(0));
    auto at = Placed<D>(mip);
    for (size_t j = 0; j < fel.Heaviside().Size(); j++)
      {
        auto & function = fel.Heaviside()[j];
        shape.Row(nd+j) = fel.HeavisideFactor(function, trace, at) * shape.Row(function.local);
      }
    if (trace == Trace::Jump) shape.Rows(0, nd) = 0;

    mat.AddSize(Dim(), fel.GetNDof()) = 0;
    for (size_t j = 0; j < n; j++)
      for (size_t k = 0; k < D; k++)
        for (size_t l = 0; l < d; l++)
          mat(k*d+l, k*n+j) = shape(j,l);
    VisitSingular(fel, Vec<D>(at.Place()), fel.ForcedSide(trace, at), [&] (size_t m, size_t component, double value) { mat(component, D*n+m) = value; });
  }

  template <int D>
  void CrackDiffOp<D> :: Apply (const FiniteElement & fel, const BaseMappedIntegrationPoint & mip, BareSliceVector<double> x,
                             FlatVector<double> flux, LocalHeap & lh) const
  {
    HeapReset hr(lh);
    FlatMatrix<double, ColMajor> mat(Dim(), fel.GetNDof(), lh);
    CalcMatrix(fel, mip, mat, lh);
    flux = mat * x.Range(0, fel.GetNDof());
  }

  template <int D>
  void CrackDiffOp<D> :: ApplyTrans (const FiniteElement & fel, const BaseMappedIntegrationPoint & mip, FlatVector<double> flux,
                                  BareSliceVector<double> x, LocalHeap & lh) const
  {
    HeapReset hr(lh);
    FlatMatrix<double, ColMajor> mat(Dim(), fel.GetNDof(), lh);
    CalcMatrix(fel, mip, mat, lh);
    x.Range(0, fel.GetNDof()) = Trans(mat) * flux;
  }

  template <int D>
  void CrackDiffOp<D> :: CalcScalar (const CrackFiniteElement<D> & fel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const
  {
    if (diff_order)
      fel.Scalar().CalcMappedDShape(mir, mat);
    else
      fel.Scalar().CalcShape(mir.IR(), mat);
    if (fel.Heaviside().Size()) CalcHeaviside(fel, mir, mat);
    if (trace == Trace::Jump)
      mat.AddSize(fel.Scalar().GetNDof()*d, mir.Size()) = SIMD<double>(0.);
  }

  template <int D>
  void CrackDiffOp<D> :: CalcHeaviside (const CrackFiniteElement<D> & fel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const
  {
    size_t nd = fel.Scalar().GetNDof();
    for (size_t i = 0; i < mir.Size(); i++)
      VisitFactors(fel, trace, mir, i, [&] (size_t j, SIMD<double> factor)
      {
        for (size_t l = 0; l < d; l++)
          mat((nd+j)*d+l, i) = factor * mat(fel.Heaviside()[j].local*d+l, i);
      });
  }

  template <int D>
  void CrackDiffOp<D> :: CalcSingular (const CrackFiniteElement<D> & fel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const
  {
    for (size_t i = 0; i < mir.Size(); i++)
      VisitSingular(fel, mir, i, [&] (size_t m, size_t component, SIMD<double> value) { mat(m*D*d+component, i) = value; });
  }

  template <int D>
  void CrackDiffOp<D> :: CalcMatrix (const FiniteElement & bfel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const
  {
    auto & fel = static_cast<const CrackFiniteElement<D>&>(bfel);
    size_t n = fel.NumScalar();
    CalcScalar(fel, mir, mat);
    // spread over the components, from the last function down: the compact rows lie where the first will go
    for (size_t j = n; j-- > 0; )
      for (size_t i = 0; i < mir.Size(); i++)
        {
          std::array<SIMD<double>,D> shape;
          for (size_t l = 0; l < d; l++) shape[l] = mat(j*d+l, i);
          for (size_t k = 0; k < D; k++)
            for (size_t component = 0; component < D; component++)
              for (size_t l = 0; l < d; l++) mat(((k*n+j)*D+component)*d+l, i) = component == k ? shape[l] : SIMD<double>(0.);
        }
    CalcSingular(fel, mir, mat.Rows(D*n*D*d, fel.GetNDof()*D*d));
  }

  namespace
  {
    /// a_i + factor b_i: the coefficients of φ_i where all functions are multiples of φ_i.
    template <int D, typename F>
    void VisitPolynomial (const CrackFiniteElement<D> & fel, Trace trace, F && visit)
    {
      size_t nd = fel.Scalar().GetNDof();
      PlacedPoint<D> anywhere;
      for (size_t j = 0; j < fel.Heaviside().Size(); j++)
        {
          auto & function = fel.Heaviside()[j];
          visit(function.local, nd+j, fel.HeavisideFactor(function, trace, anywhere));
        }
    }
  }

  template <int D>
  void CrackDiffOp<D> :: Apply (const FiniteElement & bfel, const SIMD_BaseMappedIntegrationRule & mir,
                             BareSliceVector<double> x, BareSliceMatrix<SIMD<double>> flux) const
  {
    auto & fel = static_cast<const CrackFiniteElement<D>&>(bfel);
    if (fel.IsPolynomial(trace)) ApplyPolynomial(fel, mir, x, flux);
    else ApplyScalar(fel, mir, x, flux);
    if (fel.Singular().Empty()) return;
    auto of_singular = x.Range(D*fel.NumScalar(), fel.GetNDof());
    for (size_t i = 0; i < mir.Size(); i++)
      VisitSingular(fel, mir, i, [&] (size_t m, size_t component, SIMD<double> value) { flux(component, i) += of_singular(m) * value; });
  }

  template <int D>
  void CrackDiffOp<D> :: ApplyScalar (const CrackFiniteElement<D> & fel, const SIMD_BaseMappedIntegrationRule & mir,
                                   BareSliceVector<double> x, BareSliceMatrix<SIMD<double>> flux) const
  {
    size_t n = fel.NumScalar();
    Matrix<SIMD<double>> mat(n*d, mir.Size());
    CalcScalar(fel, mir, mat);
    flux.AddSize(Dim(), mir.Size()) = SIMD<double>(0.);
    for (size_t k = 0; k < D; k++)
      for (size_t j = 0; j < n; j++)
        for (size_t l = 0; l < d; l++)
          flux.Row(k*d+l).Range(0, mir.Size()) += x(k*n+j) * mat.Row(j*d+l);
  }

  template <int D>
  void CrackDiffOp<D> :: ApplyPolynomial (const CrackFiniteElement<D> & fel, const SIMD_BaseMappedIntegrationRule & mir,
                                       BareSliceVector<double> x, BareSliceMatrix<SIMD<double>> flux) const
  {
    size_t nd = fel.Scalar().GetNDof(), n = fel.NumScalar();
    for (size_t k = 0; k < D; k++)
      {
        ArrayMem<double, 50> mem(nd);
        FlatVector<double> coefs(nd, mem.Data());
        coefs = trace == Trace::Jump ? 0 : 1;
        for (size_t i = 0; i < nd; i++) coefs(i) *= x(k*n+i);
        VisitPolynomial(fel, trace, [&] (int local, size_t j, double factor) { coefs(local) += factor * x(k*n+j); });
        if (diff_order)
          fel.Scalar().EvaluateGrad(mir, coefs, flux.Rows(D*k, D*k+D));
        else
          fel.Scalar().Evaluate(mir.IR(), coefs, flux.Row(k));
      }
  }

  template <int D>
  void CrackDiffOp<D> :: AddTrans (const FiniteElement & bfel, const SIMD_BaseMappedIntegrationRule & mir,
                                BareSliceMatrix<SIMD<double>> flux, BareSliceVector<double> x) const
  {
    auto & fel = static_cast<const CrackFiniteElement<D>&>(bfel);
    if (fel.IsPolynomial(trace)) AddTransPolynomial(fel, mir, flux, x);
    else AddTransScalar(fel, mir, flux, x);
    if (fel.Singular().Empty()) return;
    ArrayMem<SIMD<double>, 16> sums(fel.NumSingular());
    sums = SIMD<double>(0.);
    for (size_t i = 0; i < mir.Size(); i++)
      VisitSingular(fel, mir, i, [&] (size_t m, size_t component, SIMD<double> value) { sums[m] += value * flux(component, i); });
    for (size_t m = 0; m < sums.Size(); m++) x(D*fel.NumScalar()+m) += HSum(sums[m]);
  }

  template <int D>
  void CrackDiffOp<D> :: AddTransScalar (const CrackFiniteElement<D> & fel, const SIMD_BaseMappedIntegrationRule & mir,
                                      BareSliceMatrix<SIMD<double>> flux, BareSliceVector<double> x) const
  {
    size_t n = fel.NumScalar();
    Matrix<SIMD<double>> mat(n*d, mir.Size());
    CalcScalar(fel, mir, mat);
    for (size_t k = 0; k < D; k++)
      for (size_t j = 0; j < n; j++)
        {
          SIMD<double> sum(0.);
          for (size_t l = 0; l < d; l++)
            for (size_t i = 0; i < mir.Size(); i++) sum += mat(j*d+l, i) * flux(k*d+l, i);
          x(k*n+j) += HSum(sum);
        }
  }

  template <int D>
  void CrackDiffOp<D> :: AddTransPolynomial (const CrackFiniteElement<D> & fel, const SIMD_BaseMappedIntegrationRule & mir,
                                          BareSliceMatrix<SIMD<double>> flux, BareSliceVector<double> x) const
  {
    size_t nd = fel.Scalar().GetNDof(), n = fel.NumScalar();
    for (size_t k = 0; k < D; k++)
      {
        ArrayMem<double, 50> mem(nd);
        FlatVector<double> coefs(nd, mem.Data());
        coefs = 0;
        if (diff_order)
          fel.Scalar().AddGradTrans(mir, flux.Rows(D*k, D*k+D), coefs);
        else
          fel.Scalar().AddTrans(mir.IR(), flux.Row(k), coefs);
        if (trace != Trace::Jump)
          for (size_t i = 0; i < nd; i++) x(k*n+i) += coefs(i);
        VisitPolynomial(fel, trace, [&] (int local, size_t j, double factor) { x(k*n+j) += factor * coefs(local); });
      }
  }

  template class CrackDiffOp<2>;
  template class CrackDiffOp<3>;
}
