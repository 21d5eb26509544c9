"""Loads on the faces of cracks and given stresses: patches that are exact, and a fluid in an open crack (Sneddon).

python benchmarks/face_loads.py
"""

import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import CF, IfPos, Integrate, Mesh, SetNumThreads, specialcf, sqrt, x, y
from results import recorded

from ngsxfem_contact import BarbosaHughes, ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, Nitsche, NormalGap, TraceSpace
from ngsxfem_contact.exact import fracture_solutions as fs
from study.paper import PAIRS

METHODS = {"BarbosaHughes": BarbosaHughes(), "Nitsche 1": Nitsche(1), "Nitsche 0": Nitsche(0), "Nitsche -1": Nitsche(-1)}
JOINT = Crack([(0, 0.47), (1, 0.52)])


def square(maxh, lower=(0, 0)):
    geometry = SplineGeometry()
    geometry.AddRectangle(lower, (1, 1), bcs=["bottom", "right", "top", "left"])
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def problem(mesh, crack, pair, material, **options):
    body = CrackedMesh(mesh, crack)
    V = CrackFESpace(body, order=PAIRS[pair].order, bubble=PAIRS[pair].bubble, material=material, dirichlet=options.pop("held", ".*"))
    return ContactProblem(V, TraceSpace(body, order=PAIRS[pair].multiplier_order), **options)


def closed_joint(mesh, pair, method):
    """λ = -0.4 under a confining stress 1 against a fluid at 0.6."""
    p = problem(mesh, JOINT, pair, Elasticity.PlaneStrain(E=1, nu=0), held="bottom|top", stabilisation=method)
    p.f += -p.V.TestFunction() * specialcf.normal(2) * p.body.ds("left|right")
    p.SetDirichlet((-x, -y), "bottom|top")
    p.FacePressure(0.6)
    profile = p.Solve().Profile(n=101)
    return max(np.abs(profile.sigma_n + 0.4).max(), np.abs(profile.gap).max())


def clamped_box(mesh, pair, method, law=None):
    """u = 0 and λ = n·σ⁰n under an initial stress."""
    shear = 0.1 if law else 0
    given, xx = CF((-2 if law else -1, shear, shear, -1), dims=(2, 2)), -2 if law else -1
    p = problem(mesh, JOINT, pair, Elasticity.PlaneStrain(E=1, nu=0.3), stabilisation=method, initial_stress=given, law=law)
    profile, (tx, ty) = p.Solve().Profile(n=101), JOINT.TangentAt(0)
    normal = np.array([-ty, tx])
    stress = np.array([[xx, shear], [shear, -1]]) @ normal
    errors = [profile.sigma_n - normal @ stress, profile.gap, *([profile.sigma_t - np.array([tx, ty]) @ stress] if law else [])]
    return max(np.abs(error).max() for error in errors)


def sneddon(maxh, pair, stabilisation, a=0.3, p=1.0):
    """Relative errors of the opening 4 p (1 - ν²)/E √(a² - x²), in L², of the work ½∫p g_n = π (1 - ν²) p² a²/E, and of K_I."""
    material = Elasticity.PlaneStrain(E=1, nu=0.3)
    tension, uniform = fs.infinite_plate(material, a, p, 0), fs.infinite_plate(material, a, -p, 0)
    filled = problem(square(maxh, (-1, -1)), Crack([(-a, 0), (a, 0)]), pair, material, stabilisation=stabilisation)
    filled.SetDirichlet(tension.u + uniform.u, ".*")
    filled.FacePressure(p)
    solution = filled.Solve()
    opening = 4 * p * (1 - 0.3**2) * sqrt(IfPos(a**2 - x**2, a**2 - x**2, 0))
    crack = filled.W.dcrack(bonus_intorder=12)
    error, size = (Integrate(f * f * crack, solution.body.mesh) ** 0.5 for f in (NormalGap(solution.u, solution.body) - opening, opening))
    energy = 0.5 * p * Integrate(NormalGap(solution.u, solution.body) * crack, solution.body.mesh) / (np.pi * (1 - 0.3**2) * (p * a) ** 2) - 1
    return error / size, energy, solution.StressIntensity(1).K_I / tension.K_I - 1


def main():
    SetNumThreads(1)
    mesh = square(0.15)
    for pair in PAIRS:
        cells = [
            f"{name} {closed_joint(mesh, pair, method):.0e} {clamped_box(mesh, pair, method):.0e} {clamped_box(mesh, pair, method, Coulomb(5)):.0e}"
            for name, method in METHODS.items()
        ]
        print(f"{pair:6} closed joint, clamped box, sticking: " + "; ".join(cells), flush=True)
    for pair, stabilisation in (("P2/P1", None), ("P2/P0", None), ("P2/P1", BarbosaHughes()), ("P1/P1", BarbosaHughes())):
        rows = [sneddon(h, pair, stabilisation) for h in (0.1, 0.05, 0.025)]
        rates = np.log2([a[0] / b[0] for a, b in zip(rows, rows[1:])])
        name = f"{pair} {'stabilised' if stabilisation else 'no stabilisation'}"
        openings, energies, factors = (" ".join(f"{r[i]:.1e}" for r in rows) for i in range(3))
        print(f"Sneddon {name}: opening {openings} (rates {' '.join(f'{r:.2f}' for r in rates)}), work {energies}, K_I {factors}", flush=True)


if __name__ == "__main__":
    recorded(main)
