#include "spaces/dilatation.hpp"
#include <numeric>

namespace ngsxfem_contact
{
  using namespace ngfem;
  using ngcore::Array;

  namespace
  {
    constexpr size_t width = SIMD<double>::Size();

    double Dot (const std::vector<double> & a, const std::vector<double> & b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.); }

    void AddMultiple (std::vector<double> & a, double c, const std::vector<double> & b)
    { for (size_t i = 0; i < b.size(); i++) a[i] += c*b[i]; }

    /// Orthonormal polynomials on a set of weighted points, in coordinates in which the set is as wide as high: thin parts do no harm.
    class OrthonormalPolynomials
    {
      int degree;
      Point centre { 0, 0 };
      Mat<2,2> scaling;
      std::vector<std::vector<double>> functions;    // coefficients of the monomials

    public:
      OrthonormalPolynomials (int adegree, const PointRule & points) : degree(adegree)
      {
        SetCoordinates(points);
        std::vector<std::vector<double>> values;     // of the functions at the points, times √weight
        for (size_t i = 0; i < NumMonomials(); i++)
          {
            std::vector<double> function(NumMonomials(), 0.), value;
            function[i] = 1;
            for (auto & [p, weight] : points) value.push_back(sqrt(weight)*Monomials(p)[i]);
            double norm = sqrt(Dot(value, value));
            for (int repeat = 0; repeat < 2; repeat++)
              for (size_t k = 0; k < values.size(); k++)
                {
                  double c = -Dot(value, values[k]);
                  AddMultiple(value, c, values[k]);
                  AddMultiple(function, c, functions[k]);
                }
            double left = sqrt(Dot(value, value));
            if (!(left > 1e-8*norm)) continue;       // depends on the others
            for (auto & x : value) x /= left;
            for (auto & x : function) x /= left;
            values.push_back(std::move(value));
            functions.push_back(std::move(function));
          }
      }

      size_t Size () const { return functions.size(); }

      Vector<> Evaluate (Point p) const
      {
        Vector<> values(Size());
        auto monomials = Monomials(p);
        for (size_t i = 0; i < Size(); i++) values(i) = Dot(functions[i], monomials);
        return values;
      }

    private:
      size_t NumMonomials () const { return (degree+1)*(degree+2)/2; }

      /// Along the axes of inertia, divided by the radii of inertia.
      void SetCoordinates (const PointRule & points)
      {
        double area = 0;
        for (auto & [p, weight] : points) { area += weight; centre += weight*p; }
        centre *= 1/area;
        Mat<2,2> inertia = 0.;
        for (auto & [p, weight] : points)
          for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++) inertia(i,j) += weight/area * (p-centre)(i) * (p-centre)(j);
        double angle = 0.5*atan2(2*inertia(0,1), inertia(0,0)-inertia(1,1));
        std::array<Point,2> axes { Point(cos(angle), sin(angle)), Point(-sin(angle), cos(angle)) };
        for (int i = 0; i < 2; i++)
          {
            double square = InnerProduct(axes[i], inertia*axes[i]);
            scaling.Row(i) = (square > 0 ? 1/sqrt(square) : 0) * axes[i];
          }
      }

      std::vector<double> Monomials (Point p) const
      {
        Point t = scaling*(p-centre);
        std::vector<double> monomials;
        for (int d = 0; d <= degree; d++)
          for (int i = 0; i <= d; i++) monomials.push_back(std::pow(t(0), d-i)*std::pow(t(1), i));
        return monomials;
      }
    };

    Point PointOf (const SIMD_BaseMappedIntegrationRule & mir, size_t i)
    {
      auto p = mir.GetPoints();
      return Point(p(i/width,0)[i%width], p(i/width,1)[i%width]);
    }

    PlacedPoint<2> Placed (const SIMD_BaseMappedIntegrationRule & mir, size_t i)
    { return { IntegrationPoint(mir.IR()[i/width](0)[i%width], mir.IR()[i/width](1)[i%width], 0, 0), PointOf(mir, i) }; }

    /// D u, or (1 - Π) s, of all functions of one element.
    class ElementDilatation
    {
      struct Part
      {
        OrthonormalPolynomials polynomials;
        double area;
        Matrix<> moments;                            // of div - s, or -s, functions × polynomials
      };
      const CrackFiniteElement<2> & fel;
      Dilatation kind;
      std::map<size_t, Part> parts;                  // by number

    public:
      ElementDilatation (const CrackFiniteElement<2> & afel, const ElementTransformation & trafo, const BodyRules & rules, Dilatation akind)
        : fel(afel), kind(akind)
      {
        int order = 2*(fel.Order()-1);
        auto table = rules.Table({ Domain::Bulk }, VOL, order);
        auto rule = table->Find(trafo.GetElementNr());
        SIMD_IntegrationRule standard(ET_TRIG, order);
        auto & ir = rule ? rule->simd_ir : standard;
        LocalHeap lh(10000 + 2000*ir.GetNIP(), "dilatation");
        Project(trafo(ir, lh), ir.GetNIP());
      }

      /// visit(number of the dof, s) for every function of the tips at x, see TipFunctions::SingularDivergence.
      template <typename F>
      void VisitSingularDivergence (PlacedPoint<2> & x, Trace trace, F && visit) const
      {
        size_t dof = 2*fel.NumScalar();
        for (auto tip : fel.Singular().Tips())
          {
            auto s = tip->SingularDivergence(x.Place(), fel.ForcedSide(trace, x));
            for (int m = 0; m < tip->Size(); m++) visit(dof++, s[m]);
          }
      }

      /// At a point; on a side where the element has no part, as in its largest one.
      void Evaluate (PlacedPoint<2> x, Trace trace, FlatVector<> result) const
      {
        auto part = parts.find(fel.PartAt(trace, x));
        if (part == parts.end())
          part = std::max_element(parts.begin(), parts.end(), [] (auto & a, auto & b) { return a.second.area < b.second.area; });
        result = part->second.moments * part->second.polynomials.Evaluate(x.Place());
        VisitSingularDivergence(x, trace, [&] (size_t dof, double s) { result(dof) += s; });
      }

    private:
      void Project (const SIMD_BaseMappedIntegrationRule & mir, size_t num_points)
      {
        Matrix<SIMD<double>> gradient(fel.GetNDof()*4, mir.Size());
        CrackDiffOp<2>(1, Trace::Position, VOL).CalcMatrix(fel, mir, gradient);
        std::map<size_t, std::vector<size_t>> numbers;
        for (size_t i = 0; i < num_points; i++)
          {
            auto x = Placed(mir, i);
            numbers[fel.PartAt(Trace::Position, x)].push_back(i);
          }
        for (auto & [key, points] : numbers) parts.emplace(key, MakePart(mir, points, gradient));
      }

      Part MakePart (const SIMD_BaseMappedIntegrationRule & mir, const std::vector<size_t> & numbers, FlatMatrix<SIMD<double>> gradient) const
      {
        PointRule points;
        double area = 0;
        for (auto i : numbers)
          {
            points.push_back({ PointOf(mir, i), mir[i/width].GetWeight()[i%width] });
            area += points.back().weight;
          }
        Part part { OrthonormalPolynomials(fel.Order()-2, points), area, {} };
        part.moments.SetSize(fel.GetNDof(), part.polynomials.Size());
        part.moments = 0.;
        Vector<> divergence(fel.GetNDof());
        for (size_t k = 0; k < points.size(); k++)
          {
            size_t block = numbers[k]/width, lane = numbers[k]%width;
            for (int j = 0; j < fel.GetNDof(); j++)
              divergence(j) = kind == Dilatation::Singular ? 0 : gradient(4*j, block)[lane] + gradient(4*j+3, block)[lane];
            auto x = Placed(mir, numbers[k]);
            VisitSingularDivergence(x, Trace::Position, [&] (size_t dof, double s) { divergence(dof) -= s; });
            part.moments += points[k].weight * divergence * Trans(part.polynomials.Evaluate(points[k].p));
          }
        return part;
      }
    };
  }

  DilatationOp :: DilatationOp (Dilatation akind, Trace atrace, std::shared_ptr<const BodyRules> arules)
    : ScalarOperator(1), kind(akind), trace(atrace), rules(std::move(arules)) { }

  string DilatationOp :: Name () const { return (kind == Dilatation::Singular ? "singular" : "dilatation") + NameOf(trace); }

  bool DilatationOp :: operator== (const DifferentialOperator & other) const
  {
    auto op = dynamic_cast<const DilatationOp*>(&other);
    return op && op->kind == kind && op->trace == trace;
  }

  void DilatationOp :: CalcMatrix (const FiniteElement & bfel, const BaseMappedIntegrationPoint & mip,
                                   BareSliceMatrix<double, ColMajor> mat, LocalHeap & lh) const
  {
    HeapReset hr(lh);
    auto & fel = static_cast<const CrackFiniteElement<2>&>(bfel);
    FlatVector<> values(fel.GetNDof(), lh);
    ElementDilatation(fel, mip.GetTransformation(), *rules, kind).Evaluate({ mip.IP(), Point(mip.GetPoint()(0), mip.GetPoint()(1)) }, trace, values);
    for (int j = 0; j < fel.GetNDof(); j++) mat(0, j) = values(j);
  }

  void DilatationOp :: CalcMatrix (const FiniteElement & bfel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const
  {
    auto & fel = static_cast<const CrackFiniteElement<2>&>(bfel);
    ElementDilatation dilatation(fel, mir.GetTransformation(), *rules, kind);
    Matrix<> values(width, fel.GetNDof());
    for (size_t i = 0; i < mir.Size(); i++)
      {
        for (size_t lane = 0; lane < width; lane++) dilatation.Evaluate(Placed(mir, i*width+lane), trace, values.Row(lane));
        for (int j = 0; j < fel.GetNDof(); j++) mat(j, i) = SIMD<double>([&] (int lane) { return values(lane, j); });
      }
  }
}
