"""The estimated error in the energy norm beside the true one: effectivity, estimate over truth.

    python benchmarks/error_estimate.py [--maxh 0.12 0.06 0.03] [--pairs P2/P1 ...] [--cases "(b)" ...] [--verbose]

Closed forms, each with the exact displacement on the boundary: (b) to (e), the open arc, cracks in the infinite plate. Others, whose truth is a solution with P2/P1 on a mesh of maxh =
0.02 with elements of 0.002 at the tips: the paper's loads A, B, C, C with friction, and `shapes`. "graded": elements of a sixth of maxh at a tip. The last columns are the share
of contact in the estimate, and the seconds of the estimate over those of the solve.
"""

import argparse
from time import perf_counter

import numpy as np
from closed_forms import ARC, arc_body
from fracture import PLATES
from k_errors import solved
from netgen.geom2d import SplineGeometry
from netgen.meshing import MeshingParameters
from ngsolve import CF, Mesh, ngsglobals, x, y
from results import recorded

from ngsxfem_contact import Coulomb, TipEnrichment
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.exact import fracture_solutions as fs
from ngsxfem_contact.points import mesh_arrays
from study.paper import MATERIAL, PAIRS, paper_problem
from study.shapes import SHAPES, shape_problem

TIP = TipEnrichment(material=MATERIAL)
FITTED = {"load A": "A", "load B": "B", "load C": "C", "load C, friction": "C", **{name: name for name in SHAPES}}


def graded(corners, maxh, points, size, names=("bottom", "right", "top", "left")):
    """A mesh of a polygon with elements of a size at some points, growing linearly."""
    geometry = SplineGeometry()
    numbers = [geometry.AppendPoint(*corner) for corner in corners]
    for i, name in enumerate(names):
        geometry.Append(["line", numbers[i], numbers[(i + 1) % len(numbers)]], bc=name)
    parameters = MeshingParameters(maxh=maxh, grading=0.2)
    for point in points:
        parameters.RestrictH(x=point[0], y=point[1], z=0, h=size)
    return Mesh(geometry.GenerateMesh(mp=parameters))


def closed(name, maxh, is_graded, pair):
    """(solution, exact) of a closed form."""
    angle, offset = cf.position(0)
    refined = [(-0.2, 0), (0.2, 0)] if name in PLATES else [(0, 0)]
    mesh = graded(cf.corners(angle, offset), maxh, refined, maxh / 6, ["outer"] * 4) if is_graded else cf.rotated_square(angle, offset, maxh)
    left, right = cf.mouths(angle, offset)
    if name in PLATES:
        *stresses, friction = PLATES[name]
        exact = with_stress(fs.infinite_plate(MATERIAL, 0.2, *stresses, friction).u)
        return solved(mesh, cf.crack_on_axis(-0.2, 0.2), exact.u, pair, TIP, Coulomb(friction) if friction else None), exact
    if name == "open arc":
        exact = ARC.Solution()
        return solved(*arc_body(0, maxh), exact.u, pair, TIP), exact
    exact, end, tip, law = {
        "(b)": (cf.open_tip(MATERIAL), 0, TIP, None),
        "(c)": (cf.slipping_tip(MATERIAL), 0, TIP, None),
        "(d)": (cf.contact_transition(MATERIAL), right, None, None),
        "(e)": (cf.sliding_tip(MATERIAL, 0.3), 0, TIP, Coulomb(0.3)),
    }[name]
    return solved(mesh, cf.crack_on_axis(left, end), exact.u, pair, tip, law), exact


def with_stress(u):
    """The ClosedForm of a displacement."""
    gradient = CF((u[0].Diff(x), u[0].Diff(y), u[1].Diff(x), u[1].Diff(y)), dims=(2, 2))
    return cf.ClosedForm(u, MATERIAL.Stress(0.5 * (gradient + gradient.trans)).Compile(), CF(0), CF(0))


def fitted(name, mesh, pair):
    """The solution of one of FITTED."""
    if name in SHAPES:
        return shape_problem(name, mesh, pair, tip=TIP).Solve()
    return paper_problem(mesh, FITTED[name], pair, tip=TIP, law=Coulomb(0.3) if "friction" in name else None).Solve()


def tips_of(name):
    """The tips of one of FITTED."""
    return [crack.PointAt(s) for crack in SHAPES[name].cracks for s in (0, crack.length) if 0.01 < crack.PointAt(s)[0] < 0.99] if name in SHAPES else [(0.5, 0)]


def fitted_mesh(name, maxh, size):
    """Of the body of FITTED, with elements of a size at the tips."""
    return graded([(0, -0.5), (1, -0.5), (1, 0.5), (0, 0.5)], maxh, tips_of(name), size)


def distance(solution, reference, n=5):
    """The energy norm of the difference of two solutions on different meshes: Gauss points on the triangles of the reference, whatever cuts them."""
    vertices, triangles = mesh_arrays(reference.body.mesh)
    a, b, c = vertices[triangles].swapaxes(0, 1)
    t, w = np.polynomial.legendre.leggauss(n)
    t, w = 0.5 * (1 + t), 0.5 * w
    first, second = (part.ravel() for part in np.meshgrid(t, t, indexing="ij"))
    weights = (np.outer(w, w).ravel() * (1 - first))[None] * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])[:, None]
    points = a[:, None] + (b - a)[:, None] * first[None, :, None] + (c - a)[:, None] * ((1 - first) * second)[None, :, None]
    stresses = [np.array(each.stress.Compile()(each.body.mesh(*points.reshape(-1, 2).T))).reshape(-1, 4) for each in (solution, reference)]
    xx, xy, _, yy = (stresses[0] - stresses[1]).T
    trace = xx + yy
    power = (xx**2 + 2 * xy**2 + yy**2 - MATERIAL.lam / (2 * (MATERIAL.lam + MATERIAL.mu)) * trace**2) / (2 * MATERIAL.mu)
    return float(np.sqrt(weights.ravel() @ power))


def rows(name, options):
    """(pair, graded, maxh, effectivity, share of contact, seconds of the estimate over those of the solve) of a case."""
    reference = fitted(name, fitted_mesh(name, 0.02, 0.002), "P2/P1") if name in FITTED else None
    for pair in options.pairs:
        for is_graded in (False, True):
            if name == "open arc" and is_graded:
                continue
            for maxh in options.maxh:
                if reference is None:
                    solution, exact = closed(name, maxh, is_graded, pair)
                    true = cf.energy_error(solution, exact)
                else:
                    solution = fitted(name, fitted_mesh(name, maxh, maxh / 6 if is_graded else maxh), pair)
                    true = distance(solution, reference)
                start = perf_counter()
                estimate = solution.ErrorEstimate()
                said, contact = estimate.energy, np.sqrt(estimate._contact.sum())
                seconds = perf_counter() - start
                if options.verbose:
                    print(
                        f"{name:24}{pair:7}{'graded' if is_graded else 'uniform':8}{maxh:7}  true {true:.2e}  said {said:.2e}  {said / true:5.2f}", flush=True
                    )
                yield pair, is_graded, maxh, said / true, contact / said, seconds / sum(solution.report.timings.values())


def span(values):
    return f"{min(values):5.2f} to {max(values):4.2f}"


def main():
    cases = ["(b)", "(c)", "(d)", "(e)", "open arc", *PLATES, *FITTED]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maxh", type=float, nargs="+", default=[0.12, 0.06, 0.03])
    parser.add_argument("--pairs", nargs="+", default=list(PAIRS))
    parser.add_argument("--cases", nargs="+", default=cases)
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    print(f"{'':24}" + "".join(f"{pair:^15}" for pair in options.pairs) + "  contact   seconds", flush=True)
    found = []
    for name in options.cases:
        here = list(rows(name, options))
        of_pairs = [span([row[3] for row in here if row[0] == pair]) for pair in options.pairs]
        print(
            f"{name:24}" + "".join(f"{text:^15}" for text in of_pairs) + f"  {max(row[4] for row in here):6.0%}   {np.median([row[5] for row in here]):7.2f}",
            flush=True,
        )
        found += here
    for what, values in (("uniform", [row[3] for row in found if not row[1]]), ("graded", [row[3] for row in found if row[1]])):
        if values:
            print(f"{what:24}{len(values)} solutions: effectivity {span(values)}, median {np.median(values):.2f}", flush=True)
    for maxh in options.maxh:
        values = [row[3] for row in found if row[2] == maxh]
        print(f"maxh = {maxh:<17}{len(values)} solutions: effectivity {span(values)}, median {np.median(values):.2f}", flush=True)


if __name__ == "__main__":
    recorded(main)
