"""Laws of the faces.

python benchmarks/laws.py [dugdale joints steps]

dugdale: zone and opening against the closed form. joints: energy and λ of blocks that turn against each other on a joint, with rates (P2 holds the solution, so that
what is seen are the weights of the multiplier). steps: load steps on the paper's body, there and back, for laws with softening, friction and dilation: how Newton's method ended.
"""

import sys
import warnings
from collections import Counter

import numpy as np
from bodies import strip_mesh
from netgen.geom2d import SplineGeometry
from ngsolve import CF, IfPos, InnerProduct, Integrate, Mesh, SetNumThreads, x, y
from results import recorded

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, LoadSteps, Nitsche, TraceSpace
from ngsxfem_contact.contact import BartonBandis, Dugdale, ExponentialCohesive, Joint, LinearCohesive, MohrCoulomb
from ngsxfem_contact.errors import AccuracyWarning, NotConverged
from ngsxfem_contact.exact.fracture_solutions import dugdale_strip
from study.paper import paper_problem, unstructured_mesh

E = 100.0


def dugdale(h, ratio):
    """Relative errors of the zone, by extrapolation of gap^(2/3), and of the opening at the tip."""
    exact = dugdale_strip(1.0, ratio, 1.0, E)
    mesh, corner = strip_mesh(h, end=1.2 * exact.end)
    body = CrackedMesh(mesh, Crack([(0, 0), (1 + np.ceil((1.2 * exact.end - 1) / h) * h, 0)]))
    V = CrackFESpace(body, order=2, dirichletx="left", tip=None)
    problem = ContactProblem(V, TraceSpace(body, order=0), Elasticity.PlaneStress(E, 0.3), law=Dugdale(IfPos(x - 1, 1.0, 0.0)))
    v = V.TestFunction()
    problem.f += CF((0, ratio)) * v * body.ds("top") + CF((0, -ratio)) * v * body.ds("bottom")
    problem.Pin(corner, "y")
    solution = problem.Solve()
    profile = solution.Profile(n=20001)
    s, gap = solution.state.nodes.arclengths, solution.state.history.jump[0]
    last = s[gap > 1e-9 * gap.max()].max()
    near = (s > last - 0.35 * (exact.end - 1)) & (s < last - 1.5 * h)
    roots = np.roots(np.polyfit(s[near], gap[near] ** (2 / 3), 2))
    zone = roots[np.argmin(np.abs(roots - last))]
    return (zone - exact.end) / (exact.end - 1), np.interp(1, profile.s, profile.gap) / exact.opening - 1, solution.report.iterations


def joint_errors(n, orders, k=20.0, **options):
    """Stress and λ in L²; σ_yy = k (1 + 0.6 x), opening 1 + 0.6 x."""
    geometry = SplineGeometry()
    geometry.AddRectangle((0, -0.5), (1, 0.5), bc="outer")
    body = CrackedMesh(Mesh(geometry.GenerateMesh(maxh=1 / n)), Crack([(0, 0.02), (1, 0.02)]))
    V = CrackFESpace(body, order=orders[0], dirichlet="outer")
    problem = ContactProblem(V, TraceSpace(body, order=orders[1]), Elasticity.PlaneStress(10, 0.25), law=Joint(k, 3.0), **options)
    s, height, side = 1 + 0.6 * x, y - 0.02, IfPos(y - 0.02, 0.5, -0.5)
    problem.SetDirichlet(CF((-0.025 * k * (x + 0.3 * x**2) - 0.03 * k * height**2 - side * 0.6 * height, 0.1 * k * s * height + side * s)), "outer")
    solution = problem.Solve()
    difference = solution.stress - CF((0, 0, 0, k * s), dims=(2, 2))
    pressure = solution.multiplier - k * s
    return [np.sqrt(Integrate(f, body.mesh)) for f in (InnerProduct(difference, difference) * body.dx, pressure * pressure * body.dcrack)]


LAWS = {
    "joint": Joint(1, 2, 30),
    "linear softening": LinearCohesive(0.05, 0.002),
    "exponential softening": ExponentialCohesive(0.05, 0.002),
    "the same, brittle": ExponentialCohesive(0.05, 0.0005, 0.4),
    "constant traction": Dugdale(0.05),
    "friction, dilation": MohrCoulomb(0.3, 0, 0.1),
    "cohesion, dilation": MohrCoulomb(0.3, 0.01, 0.1),
    "with stiffness": MohrCoulomb(0.3, 0, 0.2, 20, 10),
    "hyperbolic closure": BartonBandis(10, 0.01, 0.4),
}


def ends(law):
    """How the load steps end, and their Newton steps."""
    how, numbers = Counter(), []
    for load in "ABC":
        for h in (0.1, 0.05, 0.03):
            for options in ({}, {"stabilisation": Nitsche(1)}, {"pair": "P1/P0"}):
                steps = LoadSteps(paper_problem(unstructured_mesh(h), load, law=law, **options))
                for t in (0.5, 1.0, 2.0, 0.3, -0.5, 1.5):
                    try:
                        report = steps.Solve(t).report
                    except NotConverged:
                        how["none"] += 1
                    else:
                        how[report.method] += 1
                        numbers.append(report.iterations)
    return how, numbers


def main():
    SetNumThreads(1)
    warnings.simplefilter("ignore", AccuracyWarning)
    cases = sys.argv[1:] or ["dugdale", "joints", "steps"]
    if "dugdale" in cases:
        for ratio in (0.5, 0.7):
            for h in (0.05, 0.025, 0.0125):
                zone, opening, iterations = dugdale(h, ratio)
                print(f"Dugdale σ/σ_y = {ratio}, h = {h:<6}: zone {100 * zone:6.2f} %, opening {100 * opening:6.2f} %, {iterations} Newton steps", flush=True)
    if "joints" in cases:
        for name, orders, options in (
            ("P2/P1", (2, 1), {}),
            ("P2/P0", (2, 0), {}),
            ("P2/P2", (2, 2), {}),
            ("P2, Nitsche", (2, 1), {"stabilisation": Nitsche(1)}),
        ):
            rows = np.array([np.mean([joint_errors(n * (1 + 0.03 * i), orders, **options) for i in range(3)], axis=0) for n in (8, 16, 32, 64)])
            rates = np.log2(rows[0] / rows[-1]) / 3
            print(
                f"joint {name:12} stress {' '.join(f'{e:.1e}' for e in rows[:, 0])} (rate {rates[0]:.2f}), λ {' '.join(f'{e:.1e}' for e in rows[:, 1])} (rate {rates[1]:.2f})",
                flush=True,
            )
    if "steps" in cases:
        for name, law in LAWS.items():
            how, numbers = ends(law)
            print(
                f"{name:22} {', '.join(f'{number} {way}' for way, number in how.items())}; mean {np.mean(numbers):.1f}, most {max(numbers)} Newton steps",
                flush=True,
            )


if __name__ == "__main__":
    recorded(main)
