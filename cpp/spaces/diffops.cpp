#include "spaces/diffops.hpp"

namespace ngsxfem_contact
{
  using namespace ngfem;

  CrackDiffOp :: CrackDiffOp (int adiff_order, Trace atrace, VorB avb)
    : DifferentialOperator(adiff_order ? 4 : 2, 1, avb, adiff_order),
      diff_order(adiff_order), trace(atrace), d(adiff_order ? 2 : 1)
  {
    if (diff_order) SetDimensions({ 2, 2 });
  }

  string NameOf (Trace trace)
  {
    static const std::map<Trace, string> names
      { { Trace::Position, "" }, { Trace::Plus, "plus" }, { Trace::Minus, "minus" }, { Trace::Jump, "jump" }, { Trace::Larger, "larger" } };
    return names.at(trace);
  }

  string CrackDiffOp :: Name () const
  {
    if (diff_order) return "grad" + NameOf(trace);
    return trace == Trace::Position ? "Id" : NameOf(trace);
  }

  bool CrackDiffOp :: operator== (const DifferentialOperator & other) const
  {
    auto op = dynamic_cast<const CrackDiffOp*>(&other);
    return op && op->diff_order == diff_order && op->trace == trace && op->VB() == VB();
  }

  shared_ptr<DifferentialOperator> CrackDiffOp :: GetTrace () const
  {
    if (diff_order || VB() == BND) return nullptr;
    return make_shared<CrackDiffOp>(0, trace, BND);
  }

  namespace
  {
    constexpr size_t lanes = SIMD<double>::Size();

    PlacedPoint Placed (const BaseMappedIntegrationPoint & mip)
    {
      auto p = mip.GetPoint();
      return { mip.IP()(0), mip.IP()(1), Point(p(0), p(1)) };
    }

    Vec<2,SIMD<double>> PointOf (const SIMD_BaseMappedIntegrationRule & mir, size_t i)
    { auto p = mir.GetPoints(); return { p(i,0), p(i,1) }; }

    std::array<PlacedPoint, lanes> Placed (const SIMD_BaseMappedIntegrationRule & mir, size_t i)
    {
      std::array<PlacedPoint, lanes> points;
      auto x = PointOf(mir, i);
      auto & ip = mir.IR()[i];
      for (size_t lane = 0; lane < lanes; lane++) points[lane] = { ip(0)[lane], ip(1)[lane], Point(x(0)[lane], x(1)[lane]) };
      return points;
    }

    /// visit(j, factor) for every Heaviside function.
    template <typename F>
    void VisitFactors (const CrackFiniteElement & fel, Trace trace, const SIMD_BaseMappedIntegrationRule & mir, size_t i, F && visit)
    {
      auto at = Placed(mir, i);
      for (size_t j = 0; j < fel.Heaviside().Size(); j++)
        visit(j, SIMD<double>([&] (int lane) { return double(fel.HeavisideFactor(fel.Heaviside()[j], trace, at[lane])); }));
    }
  }

  /// visit(m, component, value) for every component of the m-th function of the tips.
  template <typename T, typename F>
  void CrackDiffOp :: VisitTips (const CrackFiniteElement & fel, Vec<2,T> x, int side, F && visit) const
  {
    if (diff_order)
      fel.VisitTipFunctions<Vec<2,AutoDiff<2,T>>>(x, trace, side, [&] (size_t m, auto & f)
      {
        for (size_t k = 0; k < 2; k++)
          for (size_t l = 0; l < 2; l++) visit(m, 2*k+l, f(k).DValue(l));
      });
    else
      fel.VisitTipFunctions<Vec<2,T>>(x, trace, side, [&] (size_t m, auto & f)
      {
        for (size_t k = 0; k < 2; k++) visit(m, k, f(k));
      });
  }

  /// Points of one vector may ask for limits from different sides: then one by one.
  template <typename F>
  void CrackDiffOp :: VisitTips (const CrackFiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir, size_t i, F && visit) const
  {
    if (fel.Tips().Size() == 0) return;
    if (trace != Trace::Larger)                             // the same side for all points
      {
        PlacedPoint anywhere;
        return VisitTips(fel, PointOf(mir, i), fel.ForcedSide(trace, anywhere), visit);
      }
    std::array<int,lanes> sides;
    auto at = Placed(mir, i);
    for (size_t lane = 0; lane < lanes; lane++) sides[lane] = fel.ForcedSide(trace, at[lane]);
    if (std::ranges::all_of(sides, [&] (int side) { return side == sides[0]; })) return VisitTips(fel, PointOf(mir, i), sides[0], visit);
    std::vector<SIMD<double>> values(fel.NumTip()*2*d, SIMD<double>(0.));
    for (size_t lane = 0; lane < lanes; lane++)
      VisitTips(fel, Vec<2>(at[lane].Place()), sides[lane], [&] (size_t m, size_t component, double value)
      { auto & all = values[m*2*d+component]; all = SIMD<double>([&] (size_t k) { return k == lane ? value : all[k]; }); });
    for (size_t m = 0; m < fel.NumTip(); m++)
      for (size_t component = 0; component < 2*d; component++) visit(m, component, values[m*2*d+component]);
  }

  void CrackDiffOp :: CalcMatrix (const FiniteElement & bfel, const BaseMappedIntegrationPoint & mip,
                                  BareSliceMatrix<double, ColMajor> mat, LocalHeap & lh) const
  {
    HeapReset hr(lh);
    auto & fel = static_cast<const CrackFiniteElement&>(bfel);
    size_t nd = fel.Scalar().GetNDof(), n = fel.NumScalar();
    FlatMatrix<double> shape(n, d, lh);
    if (diff_order)
      fel.Scalar().CalcMappedDShape(mip, shape);
    else
      fel.Scalar().CalcShape(mip.IP(), shape.Col(0));
    auto at = Placed(mip);
    for (size_t j = 0; j < fel.Heaviside().Size(); j++)
      {
        auto & function = fel.Heaviside()[j];
        shape.Row(nd+j) = fel.HeavisideFactor(function, trace, at) * shape.Row(function.local);
      }
    if (trace == Trace::Jump) shape.Rows(0, nd) = 0;

    mat.AddSize(Dim(), fel.GetNDof()) = 0;
    for (size_t j = 0; j < n; j++)
      for (size_t k = 0; k < 2; k++)
        for (size_t l = 0; l < d; l++)
          mat(k*d+l, k*n+j) = shape(j,l);
    VisitTips(fel, Vec<2>(at.Place()), fel.ForcedSide(trace, at), [&] (size_t m, size_t component, double value) { mat(component, 2*n+m) = value; });
  }

  void CrackDiffOp :: Apply (const FiniteElement & fel, const BaseMappedIntegrationPoint & mip, BareSliceVector<double> x,
                             FlatVector<double> flux, LocalHeap & lh) const
  {
    HeapReset hr(lh);
    FlatMatrix<double, ColMajor> mat(Dim(), fel.GetNDof(), lh);
    CalcMatrix(fel, mip, mat, lh);
    flux = mat * x.Range(0, fel.GetNDof());
  }

  void CrackDiffOp :: ApplyTrans (const FiniteElement & fel, const BaseMappedIntegrationPoint & mip, FlatVector<double> flux,
                                  BareSliceVector<double> x, LocalHeap & lh) const
  {
    HeapReset hr(lh);
    FlatMatrix<double, ColMajor> mat(Dim(), fel.GetNDof(), lh);
    CalcMatrix(fel, mip, mat, lh);
    x.Range(0, fel.GetNDof()) = Trans(mat) * flux;
  }

  void CrackDiffOp :: CalcScalar (const CrackFiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const
  {
    if (diff_order)
      fel.Scalar().CalcMappedDShape(mir, mat);
    else
      fel.Scalar().CalcShape(mir.IR(), mat);
    if (fel.Heaviside().Size()) CalcHeaviside(fel, mir, mat);
    if (trace == Trace::Jump)
      mat.AddSize(fel.Scalar().GetNDof()*d, mir.Size()) = SIMD<double>(0.);
  }

  void CrackDiffOp :: CalcHeaviside (const CrackFiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const
  {
    size_t nd = fel.Scalar().GetNDof();
    for (size_t i = 0; i < mir.Size(); i++)
      VisitFactors(fel, trace, mir, i, [&] (size_t j, SIMD<double> factor)
      {
        for (size_t l = 0; l < d; l++)
          mat((nd+j)*d+l, i) = factor * mat(fel.Heaviside()[j].local*d+l, i);
      });
  }

  void CrackDiffOp :: CalcTips (const CrackFiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const
  {
    for (size_t i = 0; i < mir.Size(); i++)
      VisitTips(fel, mir, i, [&] (size_t m, size_t component, SIMD<double> value) { mat(m*2*d+component, i) = value; });
  }

  void CrackDiffOp :: CalcMatrix (const FiniteElement & bfel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const
  {
    auto & fel = static_cast<const CrackFiniteElement&>(bfel);
    size_t n = fel.NumScalar();
    CalcScalar(fel, mir, mat);
    // spread over the two components, from the last function down: the compact rows lie where the first will go
    for (size_t j = n; j-- > 0; )
      for (size_t i = 0; i < mir.Size(); i++)
        {
          std::array<SIMD<double>,2> shape;
          for (size_t l = 0; l < d; l++) shape[l] = mat(j*d+l, i);
          for (size_t l = 0; l < d; l++)
            {
              mat(j*2*d+l, i) = shape[l];
              mat(j*2*d+d+l, i) = SIMD<double>(0.);
              mat((n+j)*2*d+l, i) = SIMD<double>(0.);
              mat((n+j)*2*d+d+l, i) = shape[l];
            }
        }
    CalcTips(fel, mir, mat.Rows(2*n*2*d, fel.GetNDof()*2*d));
  }

  namespace
  {
    /// a_i + factor b_i: the coefficients of φ_i where all functions are multiples of φ_i.
    template <typename F>
    void VisitPolynomial (const CrackFiniteElement & fel, Trace trace, F && visit)
    {
      size_t nd = fel.Scalar().GetNDof();
      PlacedPoint anywhere;
      for (size_t j = 0; j < fel.Heaviside().Size(); j++)
        {
          auto & function = fel.Heaviside()[j];
          visit(function.local, nd+j, fel.HeavisideFactor(function, trace, anywhere));
        }
    }
  }

  void CrackDiffOp :: Apply (const FiniteElement & bfel, const SIMD_BaseMappedIntegrationRule & mir,
                             BareSliceVector<double> x, BareSliceMatrix<SIMD<double>> flux) const
  {
    auto & fel = static_cast<const CrackFiniteElement&>(bfel);
    if (fel.IsPolynomial(trace)) ApplyPolynomial(fel, mir, x, flux);
    else ApplyScalar(fel, mir, x, flux);
    if (fel.Tips().Size() == 0) return;
    auto of_tips = x.Range(2*fel.NumScalar(), fel.GetNDof());
    for (size_t i = 0; i < mir.Size(); i++)
      VisitTips(fel, mir, i, [&] (size_t m, size_t component, SIMD<double> value) { flux(component, i) += of_tips(m) * value; });
  }

  void CrackDiffOp :: ApplyScalar (const CrackFiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir,
                                   BareSliceVector<double> x, BareSliceMatrix<SIMD<double>> flux) const
  {
    size_t n = fel.NumScalar();
    Matrix<SIMD<double>> mat(n*d, mir.Size());
    CalcScalar(fel, mir, mat);
    flux.AddSize(Dim(), mir.Size()) = SIMD<double>(0.);
    for (size_t k = 0; k < 2; k++)
      for (size_t j = 0; j < n; j++)
        for (size_t l = 0; l < d; l++)
          flux.Row(k*d+l).Range(0, mir.Size()) += x(k*n+j) * mat.Row(j*d+l);
  }

  void CrackDiffOp :: ApplyPolynomial (const CrackFiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir,
                                       BareSliceVector<double> x, BareSliceMatrix<SIMD<double>> flux) const
  {
    size_t nd = fel.Scalar().GetNDof(), n = fel.NumScalar();
    for (size_t k = 0; k < 2; k++)
      {
        ArrayMem<double, 50> mem(nd);
        FlatVector<double> coefs(nd, mem.Data());
        coefs = trace == Trace::Jump ? 0 : 1;
        for (size_t i = 0; i < nd; i++) coefs(i) *= x(k*n+i);
        VisitPolynomial(fel, trace, [&] (int local, size_t j, double factor) { coefs(local) += factor * x(k*n+j); });
        if (diff_order)
          fel.Scalar().EvaluateGrad(mir, coefs, flux.Rows(2*k, 2*k+2));
        else
          fel.Scalar().Evaluate(mir.IR(), coefs, flux.Row(k));
      }
  }

  void CrackDiffOp :: AddTrans (const FiniteElement & bfel, const SIMD_BaseMappedIntegrationRule & mir,
                                BareSliceMatrix<SIMD<double>> flux, BareSliceVector<double> x) const
  {
    auto & fel = static_cast<const CrackFiniteElement&>(bfel);
    if (fel.IsPolynomial(trace)) AddTransPolynomial(fel, mir, flux, x);
    else AddTransScalar(fel, mir, flux, x);
    if (fel.Tips().Size() == 0) return;
    ArrayMem<SIMD<double>, 16> sums(fel.NumTip());
    sums = SIMD<double>(0.);
    for (size_t i = 0; i < mir.Size(); i++)
      VisitTips(fel, mir, i, [&] (size_t m, size_t component, SIMD<double> value) { sums[m] += value * flux(component, i); });
    for (size_t m = 0; m < sums.Size(); m++) x(2*fel.NumScalar()+m) += HSum(sums[m]);
  }

  void CrackDiffOp :: AddTransScalar (const CrackFiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir,
                                      BareSliceMatrix<SIMD<double>> flux, BareSliceVector<double> x) const
  {
    size_t n = fel.NumScalar();
    Matrix<SIMD<double>> mat(n*d, mir.Size());
    CalcScalar(fel, mir, mat);
    for (size_t k = 0; k < 2; k++)
      for (size_t j = 0; j < n; j++)
        {
          SIMD<double> sum(0.);
          for (size_t l = 0; l < d; l++)
            for (size_t i = 0; i < mir.Size(); i++) sum += mat(j*d+l, i) * flux(k*d+l, i);
          x(k*n+j) += HSum(sum);
        }
  }

  void CrackDiffOp :: AddTransPolynomial (const CrackFiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir,
                                          BareSliceMatrix<SIMD<double>> flux, BareSliceVector<double> x) const
  {
    size_t nd = fel.Scalar().GetNDof(), n = fel.NumScalar();
    for (size_t k = 0; k < 2; k++)
      {
        ArrayMem<double, 50> mem(nd);
        FlatVector<double> coefs(nd, mem.Data());
        coefs = 0;
        if (diff_order)
          fel.Scalar().AddGradTrans(mir, flux.Rows(2*k, 2*k+2), coefs);
        else
          fel.Scalar().AddTrans(mir.IR(), flux.Row(k), coefs);
        if (trace != Trace::Jump)
          for (size_t i = 0; i < nd; i++) x(k*n+i) += coefs(i);
        VisitPolynomial(fel, trace, [&] (int local, size_t j, double factor) { x(k*n+j) += factor * coefs(local); });
      }
  }
}
