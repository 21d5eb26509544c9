"""Stress intensity factors and energy release rates against closed forms, handbooks and boundary-fitted solutions.

    python benchmarks/fracture.py [infinite finite fitted friction radius release growth]

Errors of K are relative to the larger of |K_I|, |K_II|; "±" is the error that the library reports, "modes" the same error
of the enrichment's coefficients.
"""

import argparse

import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh, ngsglobals, x
from results import recorded

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, CrackGrowth, TipEnrichment, TraceSpace, Tresca
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.exact import fracture_solutions as fs
from ngsxfem_contact.fracture import GivenIncrement, MaximumHoopStress, WingCracks
from study.paper import FRICTION_REFERENCE, MATERIAL, PAIRS, REFERENCE, add_loads, paper_problem, unstructured_mesh

PSI = np.radians(40)  # of the load's axis from the crack
PHI = 0.2  # angle of friction
PLATES = {
    "Griffith": (1, 0, 0, 0),
    "inclined, tension": (*fs.inclined(1, PSI), 0),
    "inclined, compression": (*fs.inclined(-1, PSI), 0),
    "the same with friction": (*fs.inclined(-1, PSI), np.tan(PHI)),
}

# As REFERENCE: two more cases, load C with tractions (0, ∓p) on the horizontal sides.
MORE = {
    "two cracks, first": {"cracks": [[(0, 0.1), (0.4, 0.1)], [(0.63, -0.12), (1, -0.12)]], "p": 0.05, "tip": 0, "K_I": 0.0, "K_II": -0.0719215},
    "two cracks, second": {"cracks": [[(0, 0.1), (0.4, 0.1)], [(0.63, -0.12), (1, -0.12)]], "p": 0.05, "tip": 1, "K_I": 0.0, "K_II": 0.0477563},
    "arc": {"cracks": [((0, 0), (0.25, 0.05), (0.5, 0))], "p": 0, "tip": 0, "K_I": 0.0, "K_II": -0.0580771},
    "kinked": {"cracks": [[(0, 0.02), (0.3, 0.02), (0.52, 0.13)]], "p": 0.02, "tip": 0, "K_I": 0.0050838, "K_II": -0.156925},
}


def rectangle(lower, upper, maxh):
    geometry = SplineGeometry()
    geometry.AddRectangle(lower, upper, bcs=["bottom", "right", "top", "left"])
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def problem_on(mesh, cracks, pair="P2/P1", law=None, **options):
    body, orders = CrackedMesh(mesh, *cracks), PAIRS[pair]
    V = CrackFESpace(body, order=orders.order, tip=TipEnrichment(material=MATERIAL), **options)
    return ContactProblem(V, TraceSpace(body, order=orders.multiplier_order), MATERIAL, law=law)


def show(name, solution, K, tip=0, scale=None):
    """One line: errors of K_I, K_II, what is reported, and the errors of the coefficients."""
    factors, scale = solution.StressIntensity(tip), scale or np.abs(K).max()
    errors, modes = (np.subtract(values, K) / scale for values in (tuple(factors), factors.modes))
    print(f"{name:36} K_I {errors[0]:8.1e}  K_II {errors[1]:8.1e}  ± {factors.error / scale:.1e}   modes {modes[0]:8.1e} {modes[1]:8.1e}", flush=True)


def infinite():
    """The exact far field on the boundary of a rotated square of size 1, a = 1/4, a/h = 20."""
    mesh = cf.rotated_square(0.4, (0.02, -0.03), 0.0125)
    for pair in ("P2/P1", "P1/P1"):
        for name, (*stresses, friction) in PLATES.items():
            plate = fs.infinite_plate(MATERIAL, 0.25, *stresses, friction)
            problem = problem_on(mesh, [cf.crack_on_axis(-0.25, 0.25)], pair, Coulomb(friction) if friction else None, dirichlet="outer")
            problem.SetDirichlet(plate.u, "outer")
            solution = problem.Solve()
            for tip in range(2):
                show(f"{pair}  {name}, tip {tip}", solution, (plate.K_I, plate.K_II), tip)
                if pair == "P2/P1" and name == "inclined, tension":
                    criterion = MaximumHoopStress()
                    print(
                        f"      growth direction {np.degrees(criterion.Angle(*solution.StressIntensity(tip))):.3f}°, exact {np.degrees(criterion.Angle(plate.K_I, plate.K_II)):.3f}°"
                    )


def pulled(mesh, cracks, pair, upper):
    problem = problem_on(mesh, cracks, pair)
    v = problem.V.TestFunction()
    problem.f += CF((0, 1)) * v * problem.body.ds("top") + CF((0, -1)) * v * problem.body.ds("bottom")
    problem.Pin(upper, "xy")
    problem.Pin((upper[0], -upper[1]), "x")
    return problem.Solve()


def finite():
    """a = 1/2, a/h = 20; the handbook's formulas are within 0.5 % and 0.1 %."""
    edge, centre = rectangle((0, -2), (1, 2), 0.025), rectangle((0, -2.5), (2, 2.5), 0.025)
    root = np.sqrt(0.5 * np.pi)
    for pair in ("P2/P1", "P1/P1"):
        show(f"{pair}  single edge, a/W = 1/2", pulled(edge, [Crack([(0, 0), (0.5, 0)])], pair, (1, 2)), (fs.single_edge_tension(0.5) * root, 0))
        solution = pulled(centre, [Crack([(0.5, 0), (1.5, 0)])], pair, (2, 2.5))
        for tip in range(2):
            show(f"{pair}  centre crack, a/W = 1/2, tip {tip}", solution, (fs.centre_crack_tension(0.5) * root, 0), tip)


def loaded(mesh, cracks, p):
    """Load C with tractions (0, -p) on the top, (0, p) on the bottom."""
    problem = problem_on(mesh, [Crack.Arc(*points) if isinstance(points, tuple) else Crack(points) for points in cracks])
    add_loads(problem, "C", p)
    return problem.Solve()


def fitted():
    """Boundary-fitted solutions, P2/P1, maxh = 0.032; A/4: K = 0, errors relative to a quarter of A's K_I."""
    mesh = unstructured_mesh(0.016)
    for load in ("A", "B", "C", "A/4"):
        exact = REFERENCE[load]
        show(f"load {load}", paper_problem(mesh, load).Solve(), (exact["K_I"], exact["K_II"]), scale=0.0114 if load == "A/4" else None)
    for name, case in MORE.items():
        show(name, loaded(mesh, case["cracks"], case["p"]), (case["K_I"], case["K_II"]), case["tip"])


def friction():
    """Closed form (e), and the boundary-fitted solutions with friction; where K = 0 errors are relative to that without friction."""
    angle, offset = cf.position(0)
    exact = cf.sliding_tip(MATERIAL, 0.3)
    problem = problem_on(cf.rotated_square(angle, offset, 0.025), [cf.crack_on_axis(cf.mouths(angle, offset)[0], 0)], law=Coulomb(0.3), dirichlet="outer")
    problem.SetDirichlet(exact.u, "outer")
    show("(e), μ_f = 0.3, a/h = 20", problem.Solve(), (0, 1))
    laws = {"C, Coulomb 0.3": Coulomb(0.3), "C, Tresca 0.05": Tresca(0.05), "A/4, Coulomb 0.3": Coulomb(0.3)}
    for name, law in laws.items():
        scale = {"C": 0.0790112, "A": 0.0114}[name[0]] if not FRICTION_REFERENCE[name]["K_II"] else None
        solution = paper_problem(unstructured_mesh(0.016), name.split(",")[0], law=law).Solve()
        show(name, solution, (0, FRICTION_REFERENCE[name]["K_II"]), scale=scale)


def radius():
    """K_II of load B for domains of all sizes, relative to the reference."""
    for h, pair in ((0.03, "P2/P1"), (0.016, "P2/P1"), (0.016, "P1/P1")):
        solution = paper_problem(unstructured_mesh(h), "B", pair).Solve()
        K = {r: solution.StressIntensity(radius=r).K_II / REFERENCE["B"]["K_II"] for r in (0.15, 0.2, 0.3, 0.4)}
        print(f"load B  {pair}  h = {h}:  " + "  ".join(f"ρ = {r}: {value:.5f}" for r, value in K.items()), flush=True)


def release():
    """J, Irwin and -dΠ/da (difference over a ± 0.02), relative to (κ+1)/(8μ) K² of the reference."""
    mesh, da = unstructured_mesh(0.016), 0.02
    for load in "AB":
        exact = 0.375 * (REFERENCE[load]["K_I"] ** 2 + REFERENCE[load]["K_II"] ** 2)
        rate = paper_problem(mesh, load).Solve().EnergyReleaseRate()
        lower, upper = (paper_problem(mesh, load, length=0.5 + d).Solve().PotentialEnergy() for d in (-da, da))
        print(
            f"load {load}:  J {rate.G / exact:.5f}  Irwin {rate.irwin / exact:.5f}  -dΠ/da {(lower - upper) / (2 * da) / exact:.5f}  ± {rate.error / exact:.1e}",
            flush=True,
        )


def growth():
    """An inclined crack under tension, one under compression with kinks, and a tip that runs into compression."""
    mesh = rectangle((0, -0.5), (1, 0.5), 0.03)
    start = [Crack([(0.38, -0.1), (0.62, 0.1)])]

    def uniaxial(sign):
        def problem(cracks):
            problem = problem_on(mesh, cracks)
            v = problem.V.TestFunction()
            problem.f += CF((0, sign)) * v * problem.body.ds("top") + CF((0, -sign)) * v * problem.body.ds("bottom")
            problem.Pin((1, -0.5), "xy")
            problem.Pin((1, 0.5), "x")
            return problem

        return problem

    def turned(cracks):
        problem = problem_on(mesh, cracks, dirichlet="top|bottom")
        for side, sign in (("top", 1), ("bottom", -1)):
            problem.SetDirichlet(CF((0, sign * (0.42 - x))), side)
        return problem

    for name, sign, criterion in (("tension", 1, MaximumHoopStress()), ("compression, wing cracks", -1, WingCracks())):
        run = CrackGrowth(uniaxial(sign), start, GivenIncrement(0.09), criterion)
        run.Run(4)
        print(f"inclined crack, {name}\n{run}", flush=True)
    run = CrackGrowth(turned, [Crack([(0, 0), (0.3, 0)])], GivenIncrement(0.09))
    run.Run(6)
    print(f"into compression\n{run}", flush=True)


PARTS = {f.__name__: f for f in (infinite, finite, fitted, friction, radius, release, growth)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", default=list(PARTS), help="of " + " ".join(PARTS))
    ngsglobals.msg_level = 0
    for part in parser.parse_args().parts:
        print(f"-- {PARTS[part].__doc__.splitlines()[0]}", flush=True)
        PARTS[part]()


if __name__ == "__main__":
    recorded(main)
