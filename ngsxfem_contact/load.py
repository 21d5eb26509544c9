"""The right-hand side L of a problem, which can also be evaluated on fields that are not in V_h."""

import re
from dataclasses import dataclass

from ngsolve import Integrate, LinearForm

from . import _ngsxfem_contact as core


class LoadForm(LinearForm):
    """L(v) = ∫f·v + ∫g·v + ...: an NGSolve LinearForm that remembers what was added to it.

    V: CrackFESpace.    form += force*v*body.dx, v a test function of V.
    """

    def __init__(self, V):
        super().__init__(V)
        self.terms = []

    def __iadd__(self, term):
        super().__iadd__(term)
        self.terms.append(term)
        return self


@dataclass(frozen=True)
class AppliedLoad:
    """Σ factor · term: what a solution was solved for, whatever is added to the problem's form later."""

    parts: tuple

    @staticmethod
    def Of(form):
        """What a LinearForm holds now; of one that is no LoadForm the terms are not known."""
        return AppliedLoad(tuple((1.0, term) for term in getattr(form, "terms", [form])))

    def __add__(self, other):
        return AppliedLoad(self.parts + other.parts)

    def __rmul__(self, factor):
        return AppliedLoad(tuple((factor * f, term) for f, term in self.parts))

    def Evaluate(self, mesh, field, plus, minus, elements):
        """L(field), a number.

        field: CoefficientFunction with two components that vanishes outside of `elements` (BitArray) and on ∂Ω;
        plus, minus: its limits on the cracks.
        Raises ValueError if a term is not symbolic, or contains more than the value, Plus, Minus or Jump of the test function.
        """
        values = {"Id": field, "plus": plus, "minus": minus, "jump": plus - minus}
        return sum(factor * Integrate(tested(term, values, elements), mesh) for factor, term in self.parts if factor)


def tested(term, values, elements):
    """A linear form's integrals inside some elements, its test function replaced: values by the name of the operator."""
    operator = lambda proxy: re.findall(r"diffop = (\w*)", str(proxy))[0]
    if not hasattr(term, "GetProxies"):
        raise ValueError(f"load: {term!r} is no symbolic form such as force*v*body.dx; add those to problem.f, to evaluate it on a given field")
    term = core.InnerIntegrals(term, elements)
    proxies = term.GetProxies(False)
    unknown = {operator(proxy) for proxy in proxies} - set(values)
    if unknown:
        raise ValueError(f"load: a term with the operator {sorted(unknown)} of the test function cannot be evaluated on a given field")
    return term.Replace({proxy: values[operator(proxy)] for proxy in proxies})
