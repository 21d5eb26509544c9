#include "spaces/crack_fespace.hpp"

namespace ngsxfem_contact
{
  using namespace ngcomp;

  CrackFESpace :: CrackFESpace (shared_ptr<const CrackedMesh> abody, std::vector<std::optional<TipSpec>> atips, double atolerance, const Flags & flags)
    : EnrichedSpace<2>(abody, flags), body(abody), tolerance(atolerance)
  {
    type = "crackfespace";
    SetTips(atips);
    if (order > 1)
      for (auto trace : { Trace::Position, Trace::Plus, Trace::Minus, Trace::Larger })
        for (auto kind : { Dilatation::Projected, Dilatation::Singular })
          {
            auto op = make_shared<DilatationOp>(kind, trace, rules);
            additional_evaluators.Set(op->Name(), op);
          }
  }

  void CrackFESpace :: SetTips (const std::vector<std::optional<TipSpec>> & specs)
  {
    auto & places = body->Tips();
    tips.resize(places.size());
    rules = standard_rules = RulesOf(body, {});
    if (specs.empty()) return;
    if (specs.size() != places.size())
      throw Exception("CrackFESpace: " + ngcore::ToString(specs.size()) + " tip enrichments for " + ngcore::ToString(places.size()) + " tips; give one for each (body.tips)");
    TipDemands demands;
    for (size_t i = 0; i < places.size(); i++)
      if (auto & spec = specs[i])
        {
          auto & tip = places[i];
          if (!(spec->r0 >= 0 && spec->r0 < spec->r1))
            throw Exception("CrackFESpace: the cut-off of the tip at " + ToString(tip.point) + " needs 0 <= r0 < r1, got r0 = " + ngcore::ToString(spec->r0) + ", r1 = " + ngcore::ToString(spec->r1));
          if (spec->r1 > (1+1e-10)*tip.clearance)
            throw Exception("CrackFESpace: the disk r1 = " + ngcore::ToString(spec->r1) + " of the tip at " + ToString(tip.point) + " reaches "
                            + tip.limit + ", at " + ngcore::ToString(tip.clearance) + "; choose r1 below that");
          if (spec->order < 1 || spec->order > TipFunctions::max_order)
            throw Exception("CrackFESpace: modes of order " + ngcore::ToString(spec->order) + " at the tip at " + ToString(tip.point) + "; choose 1 to " + ngcore::ToString(TipFunctions::max_order));
          tips[i].emplace(tip.crack, tip.curve, tip.plus_sign, *spec);
          demands[i] = { { spec->r0, spec->r1 }, tolerance, int(spec->cutoff) };
        }
    rules = RulesOf(body, demands);
  }

  void CrackFESpace :: SetTipMaterial (size_t tip, double kappa, double mu)
  {
    if (!NumTipDofs(tip)) throw Exception("CrackFESpace: there are no functions at tip " + ngcore::ToString(tip));
    auto spec = tips[tip]->Spec();
    spec.kappa = kappa;
    spec.mu = mu;
    auto & place = body->Tips()[tip];
    tips[tip].emplace(place.crack, place.curve, place.plus_sign, spec);
  }

  std::vector<std::optional<TipSpec>> CrackFESpace :: TipSpecs () const
  {
    std::vector<std::optional<TipSpec>> specs;
    for (auto & tip : tips)
      specs.push_back(tip ? std::optional(tip->Spec()) : std::nullopt);
    return specs;
  }

  /// Every element of a disk has the tip's functions: atomic, so that they do not serialise the assembly.
  void CrackFESpace :: Update ()
  {
    EnrichedSpace<2>::Update();
    size_t dofs = GetNDof();
    is_atomic_dof = BitArray(dofs > size_t(FirstTipDof()) ? dofs : 0);
    is_atomic_dof.Clear();
    for (size_t dof = FirstTipDof(); dof < dofs; dof++) is_atomic_dof.SetBit(dof);
  }

  size_t CrackFESpace :: CollectSingular ()
  {
    first_tip_dof.assign(tips.size(), 0);
    size_t dofs = FirstTipDof();
    for (size_t i = 0; i < tips.size(); i++)
      {
        first_tip_dof[i] = dofs;
        if (tips[i]) dofs += tips[i]->Size();
      }
    for (auto vb : { VOL, BND })
      {
        tips_of[vb].SetSize(ma->GetNE(vb));
        tips_of[vb] = 0;
      }
    tip_sets.assign(1, {});
    for (size_t t = 0; t < tips.size(); t++)
      if (tips[t])
        {
          for (size_t i = 0; i < ma->GetNE(VOL); i++)
            if (tips[t]->Disk().Meets(*ma, ElementId(VOL, i))) AddTip(ElementId(VOL, i), t);
          AddToInterfaces(t);
        }
    return dofs-FirstTipDof();
  }

  void CrackFESpace :: AddTip (ElementId ei, size_t tip)
  {
    auto & set = tips_of[ei.VB()][ei.Nr()];
    auto with = tip_sets[set].tips;
    with.push_back(tip);
    set = TipSetOf(with);
  }

  /// ∂Ω is outside of all disks, inner interfaces need not be.
  void CrackFESpace :: AddToInterfaces (size_t t)
  {
    auto disk = tips[t]->Disk();
    double to_fixed = disk.radius;
    string fixed;
    for (size_t i = 0; i < ma->GetNE(BND); i++)
      {
        if (!disk.Meets(*ma, ElementId(BND, i))) continue;
        AddTip(ElementId(BND, i), t);
        int region = ma->GetElement(ElementId(BND, i)).GetIndex();
        double distance = EdgeMap(*ma, i).DistanceTo(disk.centre);
        if (IsHeld(region) && distance < to_fixed)
          {
            to_fixed = distance;
            fixed = ma->GetMaterial(BND, region);
          }
      }
    if (to_fixed < disk.radius)
      throw Exception("CrackFESpace: the fixed inner boundary '" + fixed + "' runs through the disk r1 = " + ngcore::ToString(disk.radius) + " of the tip at " + ToString(disk.centre)
                      + ", whose functions do not vanish on it; choose r1 below its distance " + ngcore::ToString(to_fixed) + ", or no functions at this tip (tip=None)");
  }

  int CrackFESpace :: TipSetOf (const std::vector<size_t> & numbers)
  {
    for (size_t i = tip_sets.size(); i-- > 0; )
      if (tip_sets[i].tips == numbers) return i;
    TipSet set { numbers, {}, {} };
    for (auto t : numbers)
      {
        set.functions.push_back(&*tips[t]);
        for (auto dof : TipDofs(t)) set.dofs.push_back(dof);
      }
    tip_sets.push_back(std::move(set));
    return tip_sets.size()-1;
  }

  std::vector<DofId> CrackFESpace :: TipDofs (size_t tip) const
  {
    if (tip >= tips.size())
      throw Exception("CrackFESpace: there is no tip " + ngcore::ToString(tip) + "; the body has " + ngcore::ToString(tips.size()));
    std::vector<DofId> dofs;
    for (int m = 0; tips[tip] && m < tips[tip]->Size(); m++) dofs.push_back(first_tip_dof[tip]+m);
    return dofs;
  }

  FlatArray<DofId> CrackFESpace :: SingularDofs (ElementId ei) const { return View(TipsOf(ei).dofs); }

  SingularFunctions<2> CrackFESpace :: SingularOf (ElementId ei) const { return SingularFunctions<2>(View(TipsOf(ei).functions)); }
}
