#include "spaces/trace_space.hpp"
#include "spaces/scalar_operator.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using namespace ngcomp;

  std::vector<double> MeshNodes (const CrackedMesh & body, size_t c, bool kinks)
  {
    auto & crack = body.GetCrack(c);
    std::vector<double> all { 0, crack.Length() }, nodes;
    auto is_joint = [&] (size_t i, double s) { return s == crack.ArcLength(i) || s == crack.ArcLength(i+1); };
    auto is_kink = [&] (size_t i, double s) { return crack.IsKink(s == crack.ArcLength(i) ? i : i+1); };
    for (auto & location : body.Location(c).Elements())
      for (auto & chord : location.chords)
        for (double s : { chord.s0, chord.s1 })
          {
            bool inner = s > location.S0() && s < location.S1();
            if (!inner || !is_joint(chord.piece, s) || (kinks && is_kink(chord.piece, s))) all.push_back(s);
          }
    std::sort(all.begin(), all.end());
    // two nodes that are nearly one would take signs apart which no displacement tells apart
    double tolerance = 1e-6/geometric_tolerance*body.Location(c).Tolerance();
    for (double s : all)
      if (nodes.empty() || s-nodes.back() > tolerance) nodes.push_back(s);
    nodes.back() = crack.Length();
    return nodes;
  }

  namespace
  {
    class NodalTraceElement : public TraceElement
    {
      const Crack & crack;
      FlatArray<const double> division;         // into the element's intervals
      FlatArray<const double> lobatto;
    public:
      NodalTraceElement (const Crack & acrack, FlatArray<const double> adivision, FlatArray<const double> alobatto, int aorder)
        : TraceElement(aorder ? (adivision.Size()-1)*aorder+1 : adivision.Size()-1, aorder), crack(acrack), division(adivision), lobatto(alobatto) { }

      void CalcShape (const IntegrationPoint &, Point x, BareSliceVector<> shape) const override
      {
        double s = crack.ArcLength(crack.Nearest(x));
        size_t i = std::lower_bound(&division[1], &division[division.Size()-1], s) - &division[1];
        shape.Range(0, ndof) = 0;
        if (order == 0) { shape(i) = 1; return; }
        double t = (s-division[i])/(division[i+1]-division[i]);
        for (int l = 0; l <= order; l++)
          {
            double value = 1;
            for (int m = 0; m <= order; m++)
              if (m != l) value *= (t-lobatto[m])/(lobatto[l]-lobatto[m]);
            shape(i*order+l) = value;
          }
      }
    };

    class MeshTraceElement : public TraceElement
    {
      const BaseScalarFiniteElement & scalar;
      FlatArray<int> used;
    public:
      MeshTraceElement (const BaseScalarFiniteElement & ascalar, FlatArray<int> aused)
        : TraceElement(aused.Size(), ascalar.Order()), scalar(ascalar), used(aused) { }

      void CalcShape (const IntegrationPoint & ip, Point, BareSliceVector<> shape) const override
      {
        ArrayMem<double, 50> mem(scalar.GetNDof());
        FlatVector<> all(scalar.GetNDof(), mem.Data());
        scalar.CalcShape(ip, all);
        for (size_t i = 0; i < used.Size(); i++) shape(i) = all(used[i]);
      }
    };

    /// The functions of each crack of an element, zero on the others.
    class SharedTraceElement : public TraceElement
    {
      const std::vector<Crack> & cracks;
      const CutElement & cut;
      FlatArray<TraceElement*> parts;
    public:
      SharedTraceElement (const std::vector<Crack> & acracks, const CutElement & acut, FlatArray<TraceElement*> aparts)
        : TraceElement(0, aparts[0]->Order()), cracks(acracks), cut(acut), parts(aparts)
      { for (auto part : parts) ndof += part->GetNDof(); }

      void CalcShape (const IntegrationPoint & ip, Point x, BareSliceVector<> shape) const override
      {
        shape.Range(0, ndof) = 0;
        auto & on = cut.CrackAt(cracks, x);
        size_t first = 0;
        for (size_t k = 0; &cut.cracks[k] != &on; k++) first += parts[k]->GetNDof();
        parts[&on - cut.cracks.data()]->CalcShape(ip, x, shape + first);
      }
    };

    /// The element that `make` gives for each crack.
    template <typename F>
    FiniteElement & MakeElement (const CrackedMesh & body, size_t element, Allocator & alloc, F && make)
    {
      auto & cut = *body.Find(element);
      if (!cut.IsShared()) return make(cut.cracks[0]);
      FlatArray<TraceElement*> parts(cut.cracks.size(), static_cast<TraceElement**>(alloc.Alloc(cut.cracks.size()*sizeof(TraceElement*))));
      for (size_t k = 0; k < cut.cracks.size(); k++) parts[k] = &make(cut.cracks[k]);
      return *new (alloc) SharedTraceElement (body.Cracks(), cut, parts);
    }

    class TraceDiffOp : public ScalarOperator
    {
    public:
      TraceDiffOp () : ScalarOperator(0) { }
      string Name () const override { return "Id"; }
      bool operator== (const DifferentialOperator & other) const override { return dynamic_cast<const TraceDiffOp*>(&other); }
      using ScalarOperator::CalcMatrix;

      void CalcMatrix (const FiniteElement & fel, const BaseMappedIntegrationPoint & mip, BareSliceMatrix<double,ColMajor> mat, LocalHeap & lh) const override
      {
        HeapReset hr(lh);
        if (fel.GetNDof() == 0) return;
        FlatVector<> shape(fel.GetNDof(), lh);
        auto x = mip.GetPoint();
        static_cast<const TraceElement&>(fel).CalcShape(mip.IP(), Point(x(0), x(1)), shape);
        for (int j = 0; j < fel.GetNDof(); j++) mat(0, j) = shape(j);
      }

      void CalcMatrix (const FiniteElement & fel, const SIMD_BaseMappedIntegrationRule & mir, BareSliceMatrix<SIMD<double>> mat) const override
      {
        if (fel.GetNDof() == 0) return;
        constexpr int lanes = SIMD<double>::Size();
        ArrayMem<double, 100> mem(fel.GetNDof()*lanes);
        FlatMatrix<> shapes(lanes, fel.GetNDof(), mem.Data());
        auto x = mir.GetPoints();
        for (size_t i = 0; i < mir.Size(); i++)
          {
            for (int k = 0; k < lanes; k++)
              static_cast<const TraceElement&>(fel).CalcShape
                (IntegrationPoint(mir.IR()[i](0)[k], mir.IR()[i](1)[k], 0, 0), Point(x(i,0)[k], x(i,1)[k]), shapes.Row(k));
            for (int j = 0; j < fel.GetNDof(); j++)
              mat(j, i) = SIMD<double>([&] (int k) { return shapes(k, j); });
          }
      }
    };
  }

  TraceBasis :: TraceBasis (shared_ptr<CrackedMesh> abody, int aorder, std::vector<std::vector<double>> adivision) : body(abody), order(aorder)
  {
    if (order < 0) throw Exception("TraceSpace: order=" + ngcore::ToString(order) + " must be 0 or more");
    if (adivision.size() != body->NumCracks())
      throw Exception("TraceSpace: nodes for " + ngcore::ToString(adivision.size()) + " cracks, but the body has " + ngcore::ToString(body->NumCracks()));
    for (size_t c = 0; c < adivision.size(); c++)
      {
        auto & s = adivision[c];
        double length = body->GetCrack(c).Length();
        bool increasing = s.size() > 1 && std::abs(s.front()) <= 1e-10*length && std::abs(s.back()-length) <= 1e-10*length;
        for (size_t i = 0; i+1 < s.size(); i++) increasing = increasing && s[i] < s[i+1];
        if (!increasing)
          throw Exception("TraceSpace: the nodes on crack " + ngcore::ToString(c) + " must be arc lengths that increase from 0 to its length " + ngcore::ToString(length));
      }
    division = make_shared<ArcLengths>(std::move(adivision));
    if (order == 0) return;
    ngfem::ComputeGaussLobattoRule(order+1, lobatto, weights);
    std::ranges::sort(lobatto);                         // inner points come in falling order
    Array<double> legendre(order+1);
    for (int l = 0; l <= order; l++)                    // weights come with errors of 1e-11
      {
        ngfem::LegendrePolynomial(order, 2*lobatto[l]-1, legendre);
        weights[l] = 1 / (order*(order+1)*sqr(legendre[order]));
      }
  }

  CurveNodes TraceBasis :: Nodes () const
  {
    CurveNodes nodes(body);
    for (size_t c = 0; c < body->NumCracks(); c++)
      {
        std::vector<double> s, length;
        auto ends = division->On(c);
        for (size_t i = 0; i+1 < ends.size(); i++)
          {
            double h = ends[i+1]-ends[i];
            if (order == 0) { s.push_back(0.5*(ends[i]+ends[i+1])); length.push_back(h); continue; }
            for (int l = 0; l < order; l++) { s.push_back(ends[i] + lobatto[l]*h); length.push_back(weights[l]*h); }
            if (i > 0) length[i*order] += weights[order]*(ends[i]-ends[i-1]);
          }
        if (order) { s.push_back(ends.back()); length.push_back(weights[order]*(ends.back()-ends.end()[-2])); }
        nodes.Append(c, s, length);
      }
    return nodes;
  }

  NodalTraceBasis :: NodalTraceBasis (shared_ptr<CrackedMesh> abody, int aorder, std::vector<std::vector<double>> adivision)
    : TraceBasis(abody, aorder, std::move(adivision)), first { 0 }
  {
    for (auto & ends : division->All()) first.push_back(first.back() + (order ? (ends.size()-1)*order+1 : ends.size()-1));
  }

  /// Intervals are longer than 4 tolerances (MeshNodes), chords longer than one; an end of a chord lies on a node or less than
  /// 4 tolerances behind it.
  std::pair<size_t,size_t> NodalTraceBasis :: Intervals (const ElementCrack & here) const
  {
    double tolerance = body->Location(here.crack).Tolerance();
    auto & s = division->All()[here.crack];
    size_t lo = std::upper_bound(s.begin(), s.end(), here.location->S0()+0.5*tolerance) - s.begin() - 1;
    size_t hi = std::lower_bound(s.begin(), s.end(), here.location->S1()-4.001*tolerance) - s.begin();
    lo = std::min(lo, s.size()-2);
    return { lo, std::max(hi, lo+1) };
  }

  void NodalTraceBasis :: GetDofNrs (size_t element, Array<DofId> & dnums) const
  {
    for (auto & here : body->Find(element)->cracks)
      {
        auto [lo, hi] = Intervals(here);
        size_t n = order ? (hi-lo)*order+1 : hi-lo;
        for (size_t i = 0; i < n; i++) dnums.Append(first[here.crack] + (order ? lo*order : lo) + i);
      }
  }

  FiniteElement & NodalTraceBasis :: GetFE (size_t element, Allocator & alloc) const
  {
    return MakeElement(*body, element, alloc, [&] (const ElementCrack & here) -> TraceElement &
    {
      auto [lo, hi] = Intervals(here);
      return *new (alloc) NodalTraceElement (body->Cracks()[here.crack], FlatArray<const double>(hi-lo+1, division->All()[here.crack].data()+lo),
                                             FlatArray<const double>(lobatto.Size(), lobatto.Data()), order);
    });
  }

  MeshTraceBasis :: MeshTraceBasis (shared_ptr<CrackedMesh> abody, int aorder, std::vector<std::vector<double>> adivision, std::set<size_t> aleft_out)
    : TraceBasis(abody, aorder, std::move(adivision)), left_out(std::move(aleft_out))
  {
    Flags flags;
    flags.SetFlag("order", order);
    scalar = CreateFESpace("h1ho", body->GetMesh(), flags);
    scalar->Update();
    scalar->FinalizeUpdate();
    number.assign(body->NumCracks(), std::vector<int>(scalar->GetNDof(), -1));
    Array<DofId> dofs;
    size_t candidate = 0;
    for (size_t c = 0; c < body->NumCracks(); c++)
      {
        std::set<DofId> used;
        for (auto & location : body->Location(c).Elements())
          {
            scalar->GetDofNrs(ElementId(VOL, location.element), dofs);
            for (auto dof : dofs) used.insert(dof);
          }
        for (auto dof : used)
          if (!left_out.count(candidate++)) number[c][dof] = int(ndof++);
      }
  }

  void MeshTraceBasis :: GetDofNrs (size_t element, Array<DofId> & dnums) const
  {
    ArrayMem<DofId, 50> dofs;
    scalar->GetDofNrs(ElementId(VOL, element), dofs);
    for (auto & here : body->Find(element)->cracks)
      for (auto dof : dofs)
        if (int i = number[here.crack][dof]; i >= 0) dnums.Append(i);
  }

  FiniteElement & MeshTraceBasis :: GetFE (size_t element, Allocator & alloc) const
  {
    ArrayMem<DofId, 50> dofs;
    scalar->GetDofNrs(ElementId(VOL, element), dofs);
    auto & fe = static_cast<BaseScalarFiniteElement&>(scalar->GetFE(ElementId(VOL, element), alloc));
    return MakeElement(*body, element, alloc, [&] (const ElementCrack & here) -> TraceElement &
    {
      int n = 0, * local = static_cast<int*>(alloc.Alloc(dofs.Size()*sizeof(int)));
      for (size_t i = 0; i < dofs.Size(); i++)
        if (number[here.crack][dofs[i]] >= 0) local[n++] = int(i);
      return *new (alloc) MeshTraceElement (fe, FlatArray<int>(n, local));
    });
  }

  TraceSpace :: TraceSpace (shared_ptr<CrackedMesh> abody, shared_ptr<TraceBasis> abasis, const Flags & flags)
    : FESpace(abody->GetMesh(), Flags(flags).SetFlag("autoupdate", false)), body(abody), basis(abasis), rules(RulesOf(abody, {}))
  {
    type = "tracespace";
    evaluator[VOL] = make_shared<TraceDiffOp>();
  }

  CutDifferentialSymbol TraceSpace :: CrackSymbol () const
  { return CutDifferentialSymbol::OnCracks(body, { Domain::Crack, basis->Division(), std::nullopt }); }

  void TraceSpace :: Update ()
  {
    body->CheckMesh();
    FESpace::Update();
    SetNDof(basis->NDof());
    ctofdof.SetSize(ndof);
    ctofdof = WIREBASKET_DOF;
  }

  FiniteElement & TraceSpace :: GetFE (ElementId ei, Allocator & alloc) const
  {
    body->CheckMesh();
    if (ei.VB() == VOL)
      {
        if (body->Find(ei.Nr())) return basis->GetFE(ei.Nr(), alloc);
        return *new (alloc) DummyFE<ET_TRIG>();
      }
    if (ei.VB() == BND) return *new (alloc) DummyFE<ET_SEGM>();
    return *new (alloc) DummyFE<ET_POINT>();
  }

  void TraceSpace :: GetDofNrs (ElementId ei, Array<DofId> & dnums) const
  {
    body->CheckMesh();
    dnums.SetSize0();
    if (ei.VB() == VOL && body->Find(ei.Nr())) basis->GetDofNrs(ei.Nr(), dnums);
  }
}
