"""Cracks in space: rates at a straight front, pennies that open, close and slide, a partially closed crack, stability for planes in any position.

    python benchmarks/solids.py [fronts] [pennies] [factors] [away] [reach] [partial] [multipliers] [planes] [--realisations 100]

fronts: the H¹ error of K_I, K_II, K_III = 1 along a straight front in n³ cubes. pennies: a disk of radius a = 0.3 in the unit cube whose mesh is refined around it.
factors: K along its front from solutions, with edges of h on the disk. away: the same for P1 by the edges away from it, and by how far from the front nodes have modes.
reach: the same with modes at the front alone, and as by default, also of ellipses.
partial: a plane crack that is open for ρ < a = 0.3, by multipliers of order 0. multipliers: the same by orders 0 and 1, with the radius that nodes in contact leave, by their
weights, and that outside of which λ < 0; and closed pennies by both, modes for r < 1.7 h. planes: the eigenvalues of the multipliers' Schur complement for random planes through the cube.
"""

import sys
import time
from pathlib import Path

import numpy as np
from netgen.csg import CSGeometry, OrthoBrick, Pnt
from netgen.meshing import MeshingParameters
from ngsolve import CF, Grad, IfPos, InnerProduct, Integrate, Mesh, sqrt, x
from results import recorded, run_cases

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[1] / "tests" / "sheets")]

from exact_sheets import cube_mesh  # noqa: E402
from ngsolve.meshes import MakeStructured3DMesh  # noqa: E402

from ngsxfem_contact import ContactProblem, Coulomb, CrackedMesh, CrackFESpace, Elasticity, Jump, TraceSpace  # noqa: E402
from ngsxfem_contact.contact.solver import ReducedProblem  # noqa: E402
from ngsxfem_contact.exact.pennies import bent_penny, closed_penny, ellipse, partially_closed, penny_in_tension  # noqa: E402
from ngsxfem_contact.exact.straight_fronts import straight_front  # noqa: E402
from ngsxfem_contact.geometry import FrontDemand, Sheet  # noqa: E402
from ngsxfem_contact.spaces import FrontEnrichment  # noqa: E402

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
CENTRE, RADIUS = (0.49, 0.51, 0.513), 0.3


def relative(error, whole, measure, mesh):
    return sqrt(Integrate(InnerProduct(error, error) * measure, mesh) / Integrate(InnerProduct(whole, whole) * measure, mesh))


def solved(body, form, front, order=1, multipliers=0, **arguments):
    V = CrackFESpace(body, order=order, dirichlet="outer", front=front, material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body, order=multipliers), **arguments)
    problem.SetDirichlet(form.u, "outer")
    return problem.Solve()


def fronts(number):
    """The front lies in about the same place of a cell of all grids."""
    sheet = Sheet.Polygon([(-1, -1, 0.61), (0.385, -1, 0.61), (0.385, 2, 0.61), (-1, 2, 0.61)])
    bodies = []
    for n in (4, 12):
        mesh = MakeStructured3DMesh(hexes=False, nx=n, ny=n, nz=n)
        for i in range(6):
            mesh.ngmesh.SetBCName(i, "outer")
        bodies.append(CrackedMesh(mesh, sheet))
    print(f"{'K':>4}  {'modes':24}{'n = 4':>8}{'n = 12':>8}{'order':>8}")
    for mode, factors in zip(("I", "II", "III"), np.eye(3)):
        form = straight_front(MATERIAL, *factors).At((0.385, 0.5, 0.61))
        for name, front in (("none", None), ("at front elements", FrontEnrichment(radius=0)), ("for r < 0.35", FrontEnrichment(radius=0.35))):
            errors = []
            for body in bodies:
                u = solved(body, form, front).u
                errors.append(relative(Grad(u) - form.gradient, form.gradient, body.dx(bonus_intorder=2, fronts=FrontDemand()), body.mesh))
            print(f"{mode:>4}  {name:24}{errors[0]:8.3f}{errors[1]:8.3f}{np.log(errors[0] / errors[1]) / np.log(3):8.2f}")


def refined(maxh, times):
    """The body whose mesh is bisected around the disk, and the mean edge of the elements that the disk cuts."""
    mesh, disk = cube_mesh(maxh), Sheet.Disk(CENTRE, (0, 0, 1), RADIUS)
    for _ in range(times):
        points = np.array([v.point for v in mesh.vertices]) - CENTRE
        r = np.hypot(np.maximum(np.hypot(points[:, 0], points[:, 1]) - RADIUS, 0), points[:, 2])
        near = r < 0.4 * RADIUS
        for element in mesh.Elements():
            mesh.SetRefinementFlag(element, bool(any(near[v.nr] for v in element.vertices)))
        mesh.Refine()
    body = CrackedMesh(mesh, disk)
    return body, mean_edge(body)


def mean_edge(body):
    """Of the elements that the sheet cuts."""
    mesh = body.mesh
    points = np.array([v.point for v in mesh.vertices])
    at = np.unique([cell.element for cell in body.Elements(0)])
    elements = list(mesh.Elements())
    edges = [np.linalg.norm(points[e.vertices[i].nr] - points[e.vertices[j].nr]) for e in (elements[k] for k in at) for i in range(4) for j in range(i)]
    return float(np.mean(edges))


def pennies(number):
    forms = {
        "open": (penny_in_tension(MATERIAL, RADIUS), None),
        "closed, frictionless": (closed_penny(MATERIAL, RADIUS, 1.0, 0.8), None),
        "closed, Coulomb 0.3": (closed_penny(MATERIAL, RADIUS, 1.0, 0.8, 0.3), Coulomb(0.3)),
    }
    print(f"{'penny':22}{'order':>6}{'modes':>12}{'h/a':>6}{'N':>8}{'m':>6}{'jump L2':>9}{'mean jump':>11}{'λ L2':>7}{'steps':>7}{'s':>6}")
    for maxh, times, order in ((0.1, 0, 1), (0.2, 2, 1), (0.13, 2, 1), (0.1, 0, 2)):
        body, h = refined(maxh, times)
        around = body.dcrack(bonus_intorder=2, fronts=FrontDemand())
        for kind, (form, law) in forms.items():
            form = form.At(CENTRE)
            for name, front in (("at front", FrontEnrichment(radius=0)), ("r < 1.7 h", FrontEnrichment(radius=1.7 * h))):
                start = time.perf_counter()
                solution = solved(body, form, front, order, law=law)
                seconds, jump = time.perf_counter() - start, Jump(solution.u)
                along = 2 if kind == "open" else 0
                mean = Integrate(jump[along] * around, body.mesh) / Integrate(form.opening[along] * around, body.mesh)
                error = relative(jump - form.opening, form.opening, around, body.mesh)
                pressure = "" if kind == "open" else f"{relative(solution.multiplier + 1, CF(1.0), body.dcrack, body.mesh):.3f}"
                V, m = solution.problem.V, len(solution.state.L)
                print(
                    f"{kind:22}{order:6}{name:>12}{h / RADIUS:6.2f}{V.ndof:8}{m:6}{error:9.3f}{mean:11.3f}{pressure:>7}{solution.report.iterations:7}{seconds:6.1f}",
                    flush=True,
                )


def fine_on_disk(h, away=0.12):
    """A mesh of the cube with edges of h on the disk, and of another length away from it."""
    geometry, sizes = CSGeometry(), MeshingParameters(maxh=away, grading=0.3)
    geometry.Add(OrthoBrick(Pnt(0, 0, 0), Pnt(1, 1, 1)).bc("outer"))
    for r in np.arange(0, RADIUS + 2 * h, h):
        for t in np.arange(0, 2 * np.pi, h / max(r, h)):
            sizes.RestrictH(x=CENTRE[0] + r * np.cos(t), y=CENTRE[1] + r * np.sin(t), z=CENTRE[2], h=h)
    return Mesh(geometry.GenerateMesh(mp=sizes))


def penny_problem(body, form, order, radius, law=None):
    V = CrackFESpace(body, order=order, dirichlet="outer", front=FrontEnrichment(radius=radius), material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body), law=law)
    problem.SetDirichlet(form.u, "outer")
    return problem


def factor_errors(found, form):
    """Of K_I, K_II, K_III at the nodes, (n, 3), and the largest K."""
    exact = form.Factors(found.points)
    return np.column_stack([found.K_I, found.K_II, found.K_III]) - exact, np.abs(exact).max()


def factors(number):
    bent = penny_in_tension(MATERIAL, RADIUS, 1.0) + bent_penny(MATERIAL, RADIUS, 2.0)
    forms = {"tension and bending": (bent, None), "closed, Coulomb 0.4": (closed_penny(MATERIAL, RADIUS, 1.0, 0.8, 0.4), Coulomb(0.4))}
    print("largest and mean error at the nodes along the front, percent of the largest K; nodes at which the reported errors cover it; seconds of solve and K")
    print(f"{'penny':20}{'order':>6}{'modes':>11}{'a/h':>5}{'N':>8}{'m':>6}{'K_I':>14}{'K_II':>14}{'K_III':>14}{'covered':>9}{'solve':>7}{'K':>6}")
    for ratio, order, radius in ((5, 1, 0), (5, 2, 0), (8, 1, 0), (8, 1, 1.5), (8, 2, 0), (10, 1, 0), (10, 1, 1.5)):
        mesh, h = fine_on_disk(RADIUS / ratio), RADIUS / ratio
        for kind, (form, law) in forms.items():
            if law and (ratio == 10 or (ratio, order) == (8, 2)):
                continue  # more than 5,000 multipliers, or minutes
            body, form, start = CrackedMesh(mesh, Sheet.Disk(CENTRE, (0, 0, 1), RADIUS)), form.At(CENTRE), time.perf_counter()
            problem = penny_problem(body, form, order, radius * h, law)
            if not law:
                problem.FacePressure(2.0 * (x - CENTRE[0]))
            solution = problem.Solve()
            solution.u  # noqa: B018  recovers it
            solved_at = time.perf_counter()
            found = solution.StressIntensity()
            off, largest = factor_errors(found, form)
            percent, covered = 100 * np.abs(off) / largest, np.mean(np.abs(off) <= found.errors)
            numbers = "".join(f"{f'{one.max():.2f} {np.sqrt(np.mean(one**2)):.2f}':>14}" for one in percent.T)
            name, seconds = "at front" if not radius else f"r < {radius} h", (solved_at - start, time.perf_counter() - solved_at)
            print(
                f"{kind:20}{order:6}{name:>11}{ratio:5}{problem.V.ndof:8}{len(solution.state.L):6}{numbers}{covered:9.0%}{seconds[0]:7.1f}{seconds[1]:6.1f}",
                flush=True,
            )


def away(number):
    bent = penny_in_tension(MATERIAL, RADIUS, 1.0) + bent_penny(MATERIAL, RADIUS, 2.0)
    forms = {"tension and bending": bent.At(CENTRE), "closed, shear": closed_penny(MATERIAL, RADIUS, 1.0, 0.8).At(CENTRE)}
    print("P1; largest error and mean of the signed error at the nodes along the front, percent of the largest K; processor seconds of solve")
    print(f"{'penny':20}{'modes':>11}{'a/h':>5}{'a/h away':>9}{'N':>8}{'m':>6}{'K_I':>14}{'K_II':>14}{'K_III':>14}{'solve':>7}")
    for ratio, edge in ((5, 0.12), (5, 0.06), (8, 0.12), (8, 0.06), (10, 0.12), (10, 0.06)):
        mesh, h = fine_on_disk(RADIUS / ratio, edge), RADIUS / ratio
        body = CrackedMesh(mesh, Sheet.Disk(CENTRE, (0, 0, 1), RADIUS))
        for kind, form in forms.items():
            for radius in (0, 1.5, 2.5):
                if radius and (ratio, edge) != (10, 0.06):
                    continue
                start = time.process_time()
                problem = penny_problem(body, form, 1, radius * h)
                if "bending" in kind:
                    problem.FacePressure(2.0 * (x - CENTRE[0]))
                solution = problem.Solve(inverse="sparsecholesky")
                solution.u  # noqa: B018  recovers it
                seconds = time.process_time() - start
                off, largest = factor_errors(solution.StressIntensity(), form)
                numbers = "".join(f"{f'{np.abs(one).max():.2f} {one.mean():.2f}':>14}" for one in 100 * off.T / largest)
                name = "at front" if not radius else f"r < {radius} h"
                print(f"{kind:20}{name:>11}{ratio:5}{RADIUS / edge:9.1f}{problem.V.ndof:8}{len(solution.state.L):6}{numbers}{seconds:7.1f}", flush=True)


def reach(number):
    bent = penny_in_tension(MATERIAL, RADIUS, 1.0) + bent_penny(MATERIAL, RADIUS, 2.0)
    print(
        "P1, edges of 0.4 a away from the disk; modes at the front alone, and as by default; largest error at the nodes along the front, percent of the largest K"
    )
    print(f"{'crack':24}{'a/h':>5}{'modes':>12}{'N':>8}{'radius':>8}{'K_I':>7}{'K_II':>7}{'K_III':>7}{'covered':>9}")
    for ratio in (5, 8, 10):
        mesh = fine_on_disk(RADIUS / ratio)
        cases = [("penny, bending", bent, 1.0, 2.0 * (x - CENTRE[0])), ("penny, closed, shear", closed_penny(MATERIAL, RADIUS, 1.0, 0.8), 1.0, None)]
        cases += [(f"ellipse, b/a = {b:.2f}", ellipse(MATERIAL, RADIUS, b * RADIUS), b, 1.0) for b in (2 / 3, 1 / 2) if ratio == 10]
        for name, form, b, pressure in cases:
            body, form = (
                CrackedMesh(mesh, Sheet.Ellipse(CENTRE, (RADIUS, 0, 0), (0, b * RADIUS, 0)) if b < 1 else Sheet.Disk(CENTRE, (0, 0, 1), RADIUS)),
                form.At(CENTRE),
            )
            for modes, radius in (("at front", 0), ("default", None)):
                problem = penny_problem(body, form, 1, radius)
                if pressure is not None:
                    problem.FacePressure(pressure)
                found = problem.Solve(inverse="sparsecholesky").StressIntensity()
                off, largest = factor_errors(found, form)
                numbers = "".join(f"{one.max():7.2f}" for one in 100 * np.abs(off).T / largest)
                print(f"{name:24}{ratio:5}{modes:>12}{problem.V.ndof:8}{found.radii[0]:8.3f}{numbers}{np.mean(np.abs(off) <= found.errors):9.0%}", flush=True)


def partial(number):
    form = partially_closed(MATERIAL, RADIUS).At(CENTRE)
    z = CENTRE[2]
    print(f"{'maxh':>5}{'N':>8}{'m':>6}{'λ L2':>8}{'radius':>8}{'steps':>7}")
    for maxh in (0.22, 0.15, 0.11, 0.08):
        body = CrackedMesh(cube_mesh(maxh), Sheet.Polygon([(-1, -1, z), (2, -1, z), (2, 2, z), (-1, 2, z)]))
        solution = solved(body, form, None)
        error = relative(solution.multiplier - form.pressure, form.pressure, body.dcrack(bonus_intorder=2), body.mesh)
        radius = np.sqrt((1 - solution.ContactArea()) / np.pi)
        print(f"{maxh:5}{solution.problem.V.ndof:8}{len(solution.state.L):6}{error:8.3f}{radius:8.3f}{solution.report.iterations:7}", flush=True)


def multipliers(number):
    form, z = partially_closed(MATERIAL, RADIUS).At(CENTRE), CENTRE[2]
    print(f"{'partially closed':22}{'of λ':>5}{'h/a':>6}{'N':>8}{'m':>6}{'λ L2':>8}{'contact':>9}{'off / h':>9}{'λ < 0':>8}{'off / h':>9}{'steps':>7}")
    for of_pressure in (0, 1):
        sizes, errors = [], []
        for maxh in (0.22, 0.15, 0.11, 0.08):
            body = CrackedMesh(cube_mesh(maxh), Sheet.Polygon([(-1, -1, z), (2, -1, z), (2, 2, z), (-1, 2, z)]))
            solution = solved(body, form, None, multipliers=of_pressure)
            sizes.append(mean_edge(body))
            errors.append(relative(solution.multiplier - form.pressure, form.pressure, body.dcrack(bonus_intorder=4), body.mesh))
            pressed = Integrate(IfPos(-1e-12 - solution.multiplier, 1, 0) * body.dcrack(bonus_intorder=4), body.mesh)
            radii = "".join(f"{r:8.3f}{(r - RADIUS) / sizes[-1]:9.2f}" for r in np.sqrt((1 - np.array([solution.ContactArea(), pressed])) / np.pi))
            print(
                f"{'':22}{of_pressure:5}{sizes[-1] / RADIUS:6.2f}{solution.problem.V.ndof:8}{len(solution.state.L):6}{errors[-1]:8.3f} {radii}{solution.report.iterations:7}",
                flush=True,
            )
        print(f"{'':22}{'order in h':>25}{np.polyfit(np.log(sizes), np.log(errors), 1)[0]:16.2f}")
    print(f"{'closed penny':22}{'of λ':>5}{'h/a':>6}{'N':>8}{'m':>6}{'λ L2':>8}{'λ worst':>9}{'mean slip':>11}{'steps':>7}")
    for maxh, times in ((0.1, 0), (0.2, 2), (0.13, 2)):
        body, h = refined(maxh, times)
        around = body.dcrack(bonus_intorder=2, fronts=FrontDemand())
        for name, friction in (("frictionless", 0), ("Coulomb 0.3", 0.3)):
            form = closed_penny(MATERIAL, RADIUS, 1.0, 0.8, friction).At(CENTRE)
            for of_pressure in (0, 1):
                solution = solved(body, form, FrontEnrichment(radius=1.7 * h), multipliers=of_pressure, law=Coulomb(friction) if friction else None)
                error = relative(solution.multiplier + 1, CF(1.0), body.dcrack, body.mesh)
                slip = Integrate(Jump(solution.u)[0] * around, body.mesh) / Integrate(form.opening[0] * around, body.mesh)
                m, worst = len(solution.state.nodes), np.abs(solution.state.L[: len(solution.state.nodes)] + 1).max()
                print(
                    f"{name:22}{of_pressure:5}{h / RADIUS:6.2f}{solution.problem.V.ndof:8}{m:6}{error:8.3f}{worst:9.2f}{slip:11.3f}{solution.report.iterations:7}",
                    flush=True,
                )


def planes(number):
    rng, meshes = np.random.default_rng(5), [cube_mesh(0.35), cube_mesh(0.25)]
    least, largest = np.inf, 0.0
    for i in range(number):
        normal = rng.normal(size=3)
        origin, axes = rng.uniform(0.3, 0.7, 3), np.linalg.svd(normal[None])[2][1:]
        body = CrackedMesh(meshes[i % 2], Sheet.Polygon([origin + 3 * (a * axes[0] + b * axes[1]) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]))
        problem = ContactProblem(CrackFESpace(body, dirichlet="outer", material=MATERIAL), TraceSpace(body))
        S = ReducedProblem(problem).S
        scale = 1 / np.sqrt(np.diag(S))
        values = np.linalg.eigvalsh(S * scale * scale[:, None])
        least, largest = min(least, values[0]), max(largest, values[-1] / values[0])
    print(f"{number} random planes: smallest eigenvalue of S with unit diagonal {least:.3g}, largest condition number {largest:.3g}")


def main():
    run_cases(__doc__, (fronts, pennies, factors, away, reach, partial, multipliers, planes), 100)


if __name__ == "__main__":
    recorded(main)
