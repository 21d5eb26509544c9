#pragma once
// What a form is made of, integral by integral: its measure, and which functions of which spaces it holds.

#include "forms/cut_integral.hpp"

namespace ngsxfem_contact
{
  using ngfem::ProxyFunction, ngfem::SumOfIntegrals;

  struct FormTerm
  {
    shared_ptr<ngfem::Integral> integral;
    shared_ptr<const CrackedBody> body;                     // of its measure; nullptr: a measure of NGSolve
    Domain domain;
    VorB vb;
    std::optional<size_t> crack;                      // the only one that it is taken over
    shared_ptr<ngcore::BitArray> elements, regions;   // that it is restricted to; nullptr: all
    std::vector<shared_ptr<ProxyFunction>> trial, test;
    bool element_normal;                              // holds NGSolve's normal vector, which is zero inside of elements
  };

  std::vector<FormTerm> TermsOf (const SumOfIntegrals & form);

  /// The term of an integrand over the measure of another term: what is needed to write a term down and to make it again.
  struct TermPlace
  {
    shared_ptr<const CrackedBody> body;
    RuleKind kind;
    VorB vb;
    int bonus_intorder;
    shared_ptr<ngcore::BitArray> elements, regions;
    std::optional<FrontDemand> fronts;                // of a body in space
  };

  TermPlace PlaceOf (const FormTerm & term);
  FormTerm TermAt (const TermPlace & place, shared_ptr<CoefficientFunction> integrand);

  /// The name of the differential operator of a trial or test function: Id, grad, plus, minus, jump, gradlarger, ...
  string OperatorName (const ProxyFunction & proxy);
}
