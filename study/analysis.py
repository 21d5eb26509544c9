"""The analysis of [AHLMR12] by number: interpolation (14), traces (20) and (21), Lemma A.1, inf-sup constants.

    python -m study.analysis

Closed forms and their letters are those of `closed_forms`. Rates are slopes of means over rotated and shifted bodies.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import pi

import numpy as np
from ngsolve import CF, CoefficientFunction, Grad, GridFunction, IfPos, InnerProduct, Integrate, ngsglobals, sqrt, x, y

from ngsxfem_contact.contact.checks import InfSup
from ngsxfem_contact.contact.stabilisation import BarbosaHughes
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.geometry import CrackedMesh
from ngsxfem_contact.operators import NormalGap, NormalStress, Strain
from ngsxfem_contact.plotting import von_mises
from ngsxfem_contact.points import crack_points
from ngsxfem_contact.spaces.crack_fespace import CrackFESpace, TipEnrichment
from ngsxfem_contact.spaces.interpolation import Interpolant
from ngsxfem_contact.spaces.trace_space import TraceSpace

from .paper import MATERIAL, PAIRS, REFERENCE, paper_problem, unstructured_mesh, varied_mesh

REALISATIONS = 5
CUTOFF_RADIUS = 0.4
COARSE, FINE = (0.08, 0.04, 0.02), (0.02, 0.0126)


@dataclass(frozen=True)
class Case:
    """A closed form; with a tip at the origin: K_I and K_II, and the part of u that the modes carry."""

    exact: cf.ClosedForm
    modes: tuple | None = None
    singular: CoefficientFunction | None = None


CASES = {
    "b": Case(cf.open_tip(MATERIAL), (1, 0), cf.open_tip(MATERIAL).u),
    "c": Case(cf.slipping_tip(MATERIAL), (0, 1), cf.slipping_tip(MATERIAL, p=0).u),
    "d": Case(cf.contact_transition(MATERIAL)),
}

# (closed form, k): the proved order of (14), (20), (21), min(k, s - 1) for û of H^s on either side, s = 5/2 - η for (d); that
# of the traces of a û that is smooth beside the crack; meshes. The derivatives of χ, which is C², delay k = 2: hence FINE.
ORDERS = {(name, 1): (1, 1.5, COARSE) for name in "bcd"} | {(name, 2): (2, 2.5, FINE) for name in "bc"} | {("d", 2): (1.5, 1.5, COARSE)}


# Interpolation and traces


def smooth_extension(function, side):
    """f where side·y > 0, and Σ_j a_j f(x, -j y), j = 1, 2, 3, beyond: C² across y = 0 if f is C² up to it (Hestenes)."""
    distance = IfPos(y, y, -y) + 1e-30
    once, twice, thrice = (CF(function).Replace({y: side * j * distance}) for j in (1, 2, 3))
    return IfPos(side * y, once, 6 * once - 8 * twice + 3 * thrice)


def cutoff(spec):
    """χ of a tip at the origin, quintic."""
    rho = (sqrt(x * x + y * y + 1e-200) - spec.r0) / (spec.r1 - spec.r0)
    return IfPos(rho, IfPos(1 - rho, 1 - rho**3 * (10 - 15 * rho + 6 * rho**2), 0), 1)


def interpolant(name, order, maxh, i, modes=True):
    """Π_h u of Definition 3.1 for the i-th body; modes=False: in the space without tip functions."""
    case, (angle, offset) = CASES[name], cf.position(i)
    mesh = cf.rotated_square(angle, offset, maxh)
    start, end = cf.mouths(angle, offset)
    body = CrackedMesh(mesh, cf.crack_on_axis(start, 0 if case.modes else end))
    modes = modes and case.modes is not None
    V = CrackFESpace(body, order=order, tip=TipEnrichment(r1=CUTOFF_RADIUS, material=MATERIAL, order=1) if modes else None)
    regular = case.exact.u - cutoff(V.tip_specs[0]) * case.singular if modes else case.exact.u
    plus, minus = (smooth_extension(regular, side).Compile() for side in (1, -1))
    return Interpolant(V, plus, minus, [case.modes] if modes else [])


def errors(name, order, maxh, i, modes=True):
    """‖u - Π_h u‖_{H¹}, γ^{-1/2}‖⟦u_n⟧ - ⟦Π_h u_n⟧‖_{Γ_C} and γ^{1/2}‖σ_n(u) - R_h(Π_h u)‖_{Γ_C}, γ = h_T."""
    exact, u = CASES[name].exact, interpolant(name, order, maxh, i, modes)
    V, body = u.space, u.space.body
    value = (exact.u - u).Compile()
    gradient = (CF((exact.u.Diff(x), exact.u.Diff(y)), dims=(2, 2)).trans - Grad(u)).Compile()
    gap = exact.gap - NormalGap(u, body)
    stress = exact.pressure - NormalStress(MATERIAL.Stress(Strain(u, "larger")), body)
    gamma = BarbosaHughes(gamma0=1).Gamma(V, MATERIAL)
    dx, dcrack = body.dx(bonus_intorder=4), body.dcrack(bonus_intorder=6)
    squares = [(InnerProduct(value, value) + InnerProduct(gradient, gradient)) * dx, gap**2 / gamma * dcrack, gamma * stress**2 * dcrack]
    return np.sqrt([Integrate(square, V.mesh) for square in squares])


@cache
def rates(name, order, sizes, realisations=REALISATIONS, modes=True):
    """Orders in h of the three errors."""
    means = [np.mean([errors(name, order, h, i, modes) for i in range(realisations)], axis=0) for h in sizes]
    return np.polyfit(np.log(sizes), np.log(means), 1)[0]


def interpolation_rates(realisations=REALISATIONS):
    """(14): the order of ‖u - Π_h u‖_{H¹} for each (closed form, k)."""
    return {key: float(rates(*key, sizes, realisations)[0]) for key, (_, _, sizes) in ORDERS.items()}


def trace_rates(realisations=REALISATIONS):
    """(20), (21): the orders of the jump and of the stress on Γ_C for each (closed form, k)."""
    return {key: tuple(map(float, rates(*key, sizes, realisations)[1:])) for key, (_, _, sizes) in ORDERS.items()}


# Lemma A.1


def graded_mesh(h, smallest, tip=(0.5, 0.0)):
    """The paper's body, refined towards the tip until the elements there are smaller than `smallest`."""
    mesh = unstructured_mesh(h)
    while True:
        marked = 0
        points = np.array([v.point for v in mesh.vertices])
        for element in mesh.Elements():
            corners = points[[v.nr for v in element.vertices]]
            size = np.hypot(*(corners - np.roll(corners, 1, axis=0)).T).max()
            refine = bool(size > smallest and np.hypot(*(corners - tip).T).min() < 2 * size)
            mesh.SetRefinementFlag(element, refine)
            marked += refine
        if not marked:
            return mesh
        mesh.Refine()


@cache
def tip_stresses(load, smallest=1e-7):
    """Distances r, and stresses there, of P2/P1 without tip functions, so that no exponent is built in."""
    mesh = graded_mesh(0.06, smallest)
    solution = paper_problem(mesh, load, tip=None).Solve()
    r = np.geomspace(20 * smallest, 2000 * smallest, 200)
    lips, ahead = crack_points(solution.body, 0, 0.5 - r), mesh(0.5 + r, 0 * r)
    strain = {side: Strain(solution.u, side) for side in ("plus", "minus", "larger")}
    stress = {side: MATERIAL.Stress(strain[side]) for side in strain}
    functions = {
        "λ on the lips": (solution.multiplier, lips),
        "R_h on the lips": (NormalStress(stress["larger"], solution.body), lips),
        "von Mises on the lips": (0.5 * (von_mises(MATERIAL, strain["plus"]) + von_mises(MATERIAL, strain["minus"])), lips),
        "σ_tt on the lips": (0.5 * (stress["plus"] - stress["minus"])[0, 0], lips),  # its odd part, which is that of mode II
        "σ_n ahead": (solution.stress[1, 1], ahead),
        "σ_t ahead": (solution.stress[0, 1], ahead),
    }
    return r, {name: function(points).ravel() for name, (function, points) in functions.items()}


LEMMA = {
    ("B", "λ on the lips"): 0,
    ("B", "R_h on the lips"): 0,
    ("B", "σ_n ahead"): 0,
    ("B", "σ_t ahead"): -0.5,
    ("B", "σ_tt on the lips"): -0.5,
    ("B", "von Mises on the lips"): 0,
    ("A", "σ_n ahead"): -0.5,
}


def closed_tip_exponents(smallest=1e-7):
    """Lemma A.1: the exponents of r → 0 at a closed tip (load B) and at an open one (A), for each (load, stress)."""
    exponents = {}
    for load, name in LEMMA:
        r, stresses = tip_stresses(load, smallest)
        exponents[load, name] = float(np.polyfit(np.log(r), np.log(np.abs(stresses[name])), 1)[0])
    return exponents


@cache
def intensity_errors(sizes, realisations=REALISATIONS):
    """Load B, P2/P1, coefficients of the modes: means of |K_I| and |K_II - reference|, relative to the reference, (len(sizes), 2)."""
    reference = REFERENCE["B"]["K_II"]
    K = [[paper_problem(varied_mesh(h, i)).Solve().StressIntensity(method="modes") for i in range(realisations)] for h in sizes]
    return np.array([np.mean([[abs(k.K_I), abs(k.K_II - reference)] for k in row], axis=0) for row in K]) / abs(reference)


# Inf-sup constants


@cache
def inf_sup(pair, h, realisation):
    """β_h without stabilisation, and the shortest interval into which the mesh divides Γ_C, relative to 2h."""
    problem = paper_problem(varied_mesh(h, realisation), pair=pair, stabilisation=None)
    return InfSup(problem.V, problem.W), float(np.diff(problem.body.MeshNodes(0, True)).min() / (2 * h))


@cache
def local_inf_sup(pair, h, realisation):
    """β_h with the length of each interval of Γ_C as weight."""
    problem = paper_problem(varied_mesh(h, realisation), pair=pair, stabilisation=None)
    length = GridFunction(TraceSpace(problem.body, order=0))
    length.vec.FV().NumPy()[:] = np.diff(problem.body.MeshNodes(0, True))
    return InfSup(problem.V, problem.W, weight=length)


def inf_sup_records(sizes, realisations):
    """β_h of each of the paper's pairs, not stabilised: dicts of kind, pair, h, realisation, value."""
    return [
        {"kind": "infsup", "pair": pair, "h": h, "realisation": i, "value": inf_sup(pair, h, i)[0]}
        for pair in PAIRS for h in sizes for i in range(realisations)
    ]  # fmt: skip


# The table


@dataclass(frozen=True)
class Row:
    """One claim; holds: whether the measured number is the expected one within its noise."""

    claim: str
    where: str
    measured: str
    expected: str
    holds: bool


def interpolation_rows():
    """(14), and what is left of it without the tip functions."""
    for (name, k), rate in interpolation_rates().items():
        proved = ORDERS[name, k][0]
        yield Row("(14) order of ‖u - Π_h u‖ in H¹", f"({name}), k = {k}", f"{rate:.2f}", f"≥ {proved}", rate > proved - 0.1)
    rate = rates("b", 1, FINE, modes=False)[0]
    yield Row("(14) without the tip functions", "(b), k = 1", f"{rate:.2f}", "0.5", abs(rate - 0.5) < 0.2)


def trace_rows():
    """(20) and (21)."""
    for j, claim in enumerate(("(20) order of γ^-½ ‖jump of u_n - Π_h u_n‖", "(21) order of γ^½ ‖σ_n(u) - R_h(Π_h u)‖")):
        for (name, k), found in trace_rates().items():
            proved, smooth, _ = ORDERS[name, k]
            yield Row(claim, f"({name}), k = {k}", f"{found[j]:.2f}", f"≥ {proved}, smooth: {smooth}", found[j] > proved - 0.1)


def tip_rows():
    """Lemma A.1 and what it says about K."""
    for (load, name), exponent in closed_tip_exponents().items():
        expected = LEMMA[load, name]
        yield Row("A.1 exponent of r at the tip", f"load {load}, {name}", f"{exponent:.3f}", str(expected), abs(exponent - expected) < 0.03)
    for load, mode, name in (("A", "K_I", "σ_n ahead"), ("B", "K_II", "σ_t ahead")):
        r, stresses = tip_stresses(load)
        K, exact = float(np.mean(np.sqrt(2 * pi * r) * stresses[name])), REFERENCE[load][mode]
        yield Row(f"{mode} from √(2πr) σ", f"load {load}, {name}", f"{K:.5f}", f"{exact:.5f}", abs(K / exact - 1) < 0.01)
    sizes = (0.057, 0.03, 0.016)
    found = intensity_errors(sizes)
    for values, name in zip(found.T, ("|K_I| / |K_II|, of the modes", "error of K_II / K_II, of the modes")):
        order = np.polyfit(np.log(sizes), np.log(values), 1)[0]
        yield Row(name, f"load B, h = {sizes}", " ".join(f"{v:.1e}" for v in values) + f", order {order:.1f}", "→ 0, order 1", order > 0.7)


def inf_sup_rows(sizes=(0.088, 0.057, 0.03, 0.016), realisations=REALISATIONS + 1):
    """Dependence of the inf-sup constants on h and on the cuts; bounded below: the least of all > 0.1 of the first median."""
    constants: dict[str, Callable[[str, float, int], float]] = {"β_h, weight h": lambda *key: inf_sup(*key)[0], "β_h, weight ℓ": local_inf_sup}
    for name, constant in constants.items():
        for pair in PAIRS:
            values = np.array([[constant(pair, h, i) for i in range(realisations)] for h in sizes])
            medians = np.median(values, axis=1)
            bounded, singular = bool(values.min() > 0.1 * medians[0]), bool(values.max() < 1e-6)
            special = {"P1/P1": ("0: singular", singular), "P1/P0": ("→ 0: spurious modes", not bounded)}
            expected, holds = special.get(pair, ("bounded below", bounded))
            text = " ".join(f"{m:.1e}" for m in medians) + f", least {values.min():.0e}"
            yield Row(f"{name}: medians, h = {sizes[0]}..{sizes[-1]}", pair, text, expected, holds)
    beta, shortest = np.log([inf_sup("P2/P0", h, i) for h in sizes for i in range(realisations)]).T
    exponent = np.polyfit(shortest, beta, 1)[0]
    yield Row("β_h, weight h, ~ (least ℓ / h)^a", "P2/P0", f"{exponent:.2f}", "0.5", abs(exponent - 0.5) < 0.1)


def report():
    """Prints every claim, the expected number and the measured one; returns the rows."""
    rows = []
    print(f"{'claim':43} {'where':33} {'expected':20} {'holds':5}  measured")
    for part in (interpolation_rows, trace_rows, tip_rows, inf_sup_rows):
        for row in part():
            rows.append(row)
            print(f"{row.claim:43} {row.where:33} {row.expected:20} {'yes' if row.holds else 'NO':5}  {row.measured}", flush=True)
    return rows


if __name__ == "__main__":
    ngsglobals.msg_level = 0
    report()
