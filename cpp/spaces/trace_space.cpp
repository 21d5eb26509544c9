#include "spaces/trace_space.hpp"
#include <algorithm>

namespace ngsxfem_contact
{
  using namespace ngcomp;

  namespace
  {
    double LeastInterval (const CrackedMesh & body, size_t crack) { return 1e-6/geometric_tolerance*body.Location(crack).Tolerance(); }
  }

  std::vector<double> MeshNodes (const CrackedMesh & body, size_t c, bool kinks)
  {
    auto & crack = body.GetCrack(c);
    std::vector<double> all;
    auto is_joint = [&] (size_t i, double s) { return s == crack.ArcLength(i) || s == crack.ArcLength(i+1); };
    auto is_kink = [&] (size_t i, double s) { return crack.IsKink(s == crack.ArcLength(i) ? i : i+1); };
    for (auto & location : body.Location(c).Elements())
      for (auto & chord : location.chords)
        for (double s : { chord.s0, chord.s1 })
          {
            bool inner = s > location.S0() && s < location.S1();
            if (!inner || !is_joint(chord.piece, s) || (kinks && is_kink(chord.piece, s))) all.push_back(s);
          }
    // two nodes that are nearly one would take signs apart which no displacement tells apart
    double tolerance = LeastInterval(body, c);
    std::set<double> nodes;
    auto is_apart = [&] (double s)
    {
      auto next = nodes.lower_bound(s);
      return (next == nodes.end() || *next-s > tolerance) && (next == nodes.begin() || s-*std::prev(next) > tolerance);
    };
    auto insert = [&] (double s) { if (is_apart(s)) nodes.insert(s); };
    insert(0);
    insert(crack.Length());
    for (double s : body.Location(c).Meetings()) insert(s);
    std::ranges::for_each(all, insert);
    return { nodes.begin(), nodes.end() };
  }

  namespace
  {
    class NodalTraceElement : public TraceElement<2>
    {
      const Crack & crack;
      FlatArray<const double> division;         // into the element's intervals
      FlatArray<const double> lobatto;
    public:
      NodalTraceElement (const Crack & acrack, FlatArray<const double> adivision, FlatArray<const double> alobatto, int aorder)
        : TraceElement<2>(aorder ? (adivision.Size()-1)*aorder+1 : adivision.Size()-1, aorder), crack(acrack), division(adivision), lobatto(alobatto) { }

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

    class MeshTraceElement : public TraceElement<2>
    {
      const BaseScalarFiniteElement & scalar;
      FlatArray<int> used;
    public:
      MeshTraceElement (const BaseScalarFiniteElement & ascalar, FlatArray<int> aused)
        : TraceElement<2>(aused.Size(), ascalar.Order()), scalar(ascalar), used(aused) { }

      void CalcShape (const IntegrationPoint & ip, Point, BareSliceVector<> shape) const override
      {
        ArrayMem<double, 50> mem(scalar.GetNDof());
        FlatVector<> all(scalar.GetNDof(), mem.Data());
        scalar.CalcShape(ip, all);
        for (size_t i = 0; i < used.Size(); i++) shape(i) = all(used[i]);
      }
    };

    /// The functions on each of several stretches of cracks, zero on the others.
    class SharedTraceElement : public TraceElement<2>
    {
    public:
      struct Stretch { size_t crack; double s0, s1; TraceElement<2> * functions; };

      SharedTraceElement (const std::vector<Crack> & acracks, const CutElement & acut, FlatArray<Stretch> astretches)
        : TraceElement<2>(0, astretches[0].functions->Order()), cracks(acracks), cut(acut), stretches(astretches)
      { for (auto & stretch : stretches) ndof += stretch.functions->GetNDof(); }

      void CalcShape (const IntegrationPoint & ip, Point x, BareSliceVector<> shape) const override
      {
        shape.Range(0, ndof) = 0;
        size_t crack = cut.CrackAt(x).crack, first = 0;
        double s = cracks[crack].ArcLength(cracks[crack].Nearest(x));
        auto off = [&] (const Stretch & stretch) { return std::pair(stretch.crack != crack, std::max({ 0.0, stretch.s0-s, s-stretch.s1 })); };
        auto on = std::ranges::min_element(stretches, {}, off);
        for (auto stretch = stretches.begin(); stretch != on; ++stretch) first += (*stretch).functions->GetNDof();
        (*on).functions->CalcShape(ip, x, shape + first);
      }

    private:
      const std::vector<Crack> & cracks;
      const CutElement & cut;
      FlatArray<Stretch> stretches;
    };
  }

  TraceBasis :: TraceBasis (shared_ptr<CrackedMesh> abody, int aorder, std::vector<std::vector<double>> adivision) : body(abody), order(aorder)
  {
    if (order < 0) throw Exception("TraceSpace: order=" + ngcore::ToString(order) + " must be 0 or more");
    CheckDivision(adivision);
    for (size_t c = 0; c < adivision.size(); c++) EndAtMeetings(c, adivision[c]);
    division = make_shared<ArcLengths>(std::move(adivision));
    FindSpans();
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

  void TraceBasis :: CheckDivision (const std::vector<std::vector<double>> & adivision) const
  {
    if (adivision.size() != body->NumCracks())
      throw Exception("TraceSpace: nodes for " + ngcore::ToString(adivision.size()) + " cracks, but the body has " + ngcore::ToString(body->NumCracks()));
    for (size_t c = 0; c < adivision.size(); c++)
      {
        auto & s = adivision[c];
        double length = body->GetCrack(c).Length();
        bool increasing = s.size() > 1 && std::abs(s.front()) <= 1e-10*length && std::abs(s.back()-length) <= 1e-10*length;
        for (size_t i = 0; i+1 < s.size(); i++) increasing = increasing && s[i] < s[i+1];
        if (!increasing)
          throw Exception("TraceSpace: the nodes on crack " + body->GetCrack(c).Label(c) + " must be arc lengths that increase from 0 to its length " + ngcore::ToString(length));
      }
  }

  void TraceBasis :: EndAtMeetings (size_t crack, std::vector<double> & s)
  {
    size_t lo = 0;
    for (double meeting : body->Location(crack).Meetings())
      {
        double tolerance = LeastInterval(*body, crack);
        auto next = std::ranges::lower_bound(s, meeting-tolerance);
        if (next == s.end()) continue;
        if (*next > meeting+tolerance) next = s.insert(next, meeting);
        size_t at = next-s.begin();
        if (at == lo || at+1 == s.size()) continue;
        AddArm(crack, lo, at, s);
        lo = at;
      }
    size_t last = s.size()-1;
    AddArm(crack, lo, last, s);
  }

  /// Between two blocks one constant would not feel all rigid motions: a triangle may turn about the centre of its circumcircle.
  void TraceBasis :: AddArm (size_t crack, size_t lo, size_t & hi, std::vector<double> & s)
  {
    auto & ends = body->Location(crack).Ends();
    bool between_meetings = (lo > 0 || ends[0].kind == EndKind::Junction) && (hi+1 < s.size() || ends[1].kind == EndKind::Junction);
    if (order == 0 && hi == lo+1 && between_meetings) s.insert(s.begin() + hi++, 0.5*(s[lo]+s[lo+1]));
    arms.push_back({ crack, lo, hi });
  }

  /// Intervals are longer than 4 tolerances (MeshNodes), chords longer than one; an end of a chord lies on a node or less than
  /// 4 tolerances behind it.
  void TraceBasis :: FindSpans ()
  {
    for (size_t arm = 0; arm < arms.size(); arm++)
      {
        auto & location = body->Location(arms[arm].crack);
        auto & s = division->All()[arms[arm].crack];
        for (auto & here : location.Elements())
          {
            std::set<size_t> met;
            for (auto & chord : here.chords)
              {
                size_t lo = std::ranges::upper_bound(s, chord.s0+0.5*location.Tolerance()) - s.begin() - 1;
                size_t hi = std::ranges::lower_bound(s, chord.s1-4.001*location.Tolerance()) - s.begin();
                lo = std::min(lo, s.size()-2);
                for (size_t i = lo; i < std::max(hi, lo+1); i++)
                  if (i >= arms[arm].lo && i < arms[arm].hi) met.insert(i);
              }
            auto & in_element = spans[here.element];
            for (size_t i : met)
              if (!in_element.empty() && in_element.back().arm == arm && in_element.back().hi == i) in_element.back().hi++;
              else in_element.push_back({ arm, i, i+1 });
          }
      }
  }

  template <typename F>
  FiniteElement & TraceBasis :: MakeElement (size_t element, const std::vector<Span> & spans, Allocator & alloc, F && make) const
  {
    if (spans.size() == 1) return make(spans[0]);
    using Stretch = SharedTraceElement::Stretch;
    FlatArray<Stretch> stretches(spans.size(), static_cast<Stretch*>(alloc.Alloc(spans.size()*sizeof(Stretch))));
    for (size_t k = 0; k < spans.size(); k++)
      {
        size_t crack = arms[spans[k].arm].crack;
        auto & s = division->All()[crack];
        stretches[k] = { crack, s[spans[k].lo], s[spans[k].hi], &make(spans[k]) };
      }
    return *new (alloc) SharedTraceElement (body->Cracks(), *body->Find(element), stretches);
  }

  CurveNodes TraceBasis :: Nodes () const
  {
    CurveNodes nodes(body);
    for (auto & arm : arms)
      {
        std::vector<double> s, length;
        auto & ends = division->All()[arm.crack];
        for (size_t i = arm.lo; i < arm.hi; i++)
          {
            double h = ends[i+1]-ends[i];
            if (order == 0) { s.push_back(0.5*(ends[i]+ends[i+1])); length.push_back(h); continue; }
            for (int l = 0; l < order; l++) { s.push_back(ends[i] + lobatto[l]*h); length.push_back(weights[l]*h); }
            if (i > arm.lo) length[(i-arm.lo)*order] += weights[order]*(ends[i]-ends[i-1]);
          }
        if (order) { s.push_back(ends[arm.hi]); length.push_back(weights[order]*(ends[arm.hi]-ends[arm.hi-1])); }
        nodes.Append(arm.crack, s, length);
      }
    return nodes;
  }

  NodalTraceBasis :: NodalTraceBasis (shared_ptr<CrackedMesh> abody, int aorder, std::vector<std::vector<double>> adivision)
    : TraceBasis(abody, aorder, std::move(adivision)), first { 0 }
  {
    for (auto & arm : arms) first.push_back(first.back() + (order ? (arm.hi-arm.lo)*order+1 : arm.hi-arm.lo));
  }

  void NodalTraceBasis :: GetDofNrs (size_t element, Array<DofId> & dnums) const
  {
    for (auto & [arm, lo, hi] : spans.at(element))
      {
        size_t n = order ? (hi-lo)*order+1 : hi-lo, from = lo-arms[arm].lo;
        for (size_t i = 0; i < n; i++) dnums.Append(first[arm] + (order ? from*order : from) + i);
      }
  }

  FiniteElement & NodalTraceBasis :: GetFE (size_t element, Allocator & alloc) const
  {
    return MakeElement(element, spans.at(element), alloc, [&] (const Span & span) -> TraceElement<2> &
    {
      size_t crack = arms[span.arm].crack;
      return *new (alloc) NodalTraceElement (body->Cracks()[crack], FlatArray<const double>(span.hi-span.lo+1, division->All()[crack].data()+span.lo),
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
    number.assign(arms.size(), std::vector<int>(scalar->GetNDof(), -1));
    std::vector<std::set<DofId>> used(arms.size());
    Array<DofId> dofs;
    for (auto element : body->CrackedElements())
      {
        scalar->GetDofNrs(ElementId(VOL, element), dofs);
        for (auto & span : ArmsIn(element))
          for (auto dof : dofs) used[span.arm].insert(dof);
      }
    size_t candidate = 0;
    for (size_t arm = 0; arm < arms.size(); arm++)
      for (auto dof : used[arm])
        if (!left_out.count(candidate++)) number[arm][dof] = int(ndof++);
  }

  /// One span for each arm.
  std::vector<TraceBasis::Span> MeshTraceBasis :: ArmsIn (size_t element) const
  {
    std::vector<Span> in_element;
    for (auto & span : spans.at(element))
      if (!in_element.empty() && in_element.back().arm == span.arm) in_element.back().hi = span.hi;
      else in_element.push_back(span);
    return in_element;
  }

  void MeshTraceBasis :: GetDofNrs (size_t element, Array<DofId> & dnums) const
  {
    ArrayMem<DofId, 50> dofs;
    scalar->GetDofNrs(ElementId(VOL, element), dofs);
    for (auto & span : ArmsIn(element))
      for (auto dof : dofs)
        if (int i = number[span.arm][dof]; i >= 0) dnums.Append(i);
  }

  FiniteElement & MeshTraceBasis :: GetFE (size_t element, Allocator & alloc) const
  {
    ArrayMem<DofId, 50> dofs;
    scalar->GetDofNrs(ElementId(VOL, element), dofs);
    auto & fe = static_cast<BaseScalarFiniteElement&>(scalar->GetFE(ElementId(VOL, element), alloc));
    return MakeElement(element, ArmsIn(element), alloc, [&] (const Span & span) -> TraceElement<2> &
    {
      int n = 0, * local = static_cast<int*>(alloc.Alloc(dofs.Size()*sizeof(int)));
      for (size_t i = 0; i < dofs.Size(); i++)
        if (number[span.arm][dofs[i]] >= 0) local[n++] = int(i);
      return *new (alloc) MeshTraceElement (fe, FlatArray<int>(n, local));
    });
  }

  TraceSpace :: TraceSpace (shared_ptr<CrackedMesh> abody, shared_ptr<TraceBasis> abasis, const Flags & flags)
    : FESpace(abody->GetMesh(), Flags(flags).SetFlag("autoupdate", false)), body(abody), basis(abasis), rules(RulesOf(abody, {}))
  {
    type = "tracespace";
    evaluator[VOL] = make_shared<TraceOperator<2>>();
  }

  CutDifferentialSymbol TraceSpace :: CrackSymbol () const
  { return CutDifferentialSymbol::OnCracks(Measure { body, { Domain::Crack, basis->Division(), std::nullopt } }); }

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
