"""The convergence study of section 4 of [AHLMR12]: errors against a fine reference, for all pairs and meshes.

Every finished solve is one line of study.jsonl, so that a stopped study goes on where it was.
"""

import csv
import json
from importlib import metadata
from pathlib import Path
from time import perf_counter

import numpy as np
from ngsolve import Grad, TaskManager
from ngsolve.meshes import MakeStructured2DMesh

from ngsxfem_contact.contact.checks import Coercivity, InfSup
from ngsxfem_contact.contact.cones import CONES
from ngsxfem_contact.contact.options import StepOptions
from ngsxfem_contact.contact.solution import ContactSolution
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.contact.stabilisation import BarbosaHughes, BothSides
from ngsxfem_contact.errors import SolveError
from ngsxfem_contact.files import UnreadableFile, only_one, write_whole
from ngsxfem_contact.spaces.trace_space import TraceNodes

from .paper import MATERIAL, PAIRS, REFERENCE, paper_problem, varied_mesh

SIZES = (0.088, 0.057, 0.03, 0.016, 0.008)
REFERENCE_CELLS = 185  # odd, so that the crack crosses cells: longest edge 0.0076, the paper's h = 0.0027 (side / 2)
GAMMA0 = tuple(float(g) for g in np.logspace(-4, 0, 17))
ORDER = 7  # of the rules for errors


def versions():
    """Of this package and of NGSolve: results of other versions are not taken for those of this one."""
    return "-".join(installed_version(package) for package in ("ngsxfem_contact", "ngsolve"))


def installed_version(package):
    """Its number, or "unknown" in a source tree that is not installed."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "unknown"


def realisation_mesh(h, realisation, structured=False):
    """Meshes of the same size that differ; structured: an odd number of cells."""
    return structured_mesh(2 * int(round((0.437 / h - 1) / 2 + realisation)) + 1) if structured else varied_mesh(h, realisation)


def structured_mesh(cells):
    """cells × cells squares, each divided into two triangles."""
    return MakeStructured2DMesh(quads=False, nx=cells, ny=cells, mapping=lambda x, y: (x, y - 0.5))


def reference_solution(folder, cells=REFERENCE_CELLS):
    """The P2/P1 solution on a fine structured mesh, stabilised; computed once and kept in the folder."""
    path = Path(folder) / f"reference-{cells}-{versions()}.solution"
    if not path.exists():
        with TaskManager():
            solution = paper_problem(structured_mesh(cells)).Solve()
        solution.Save(path)
    return path


class Reference:
    """u and λ of the reference at given points; the multiplier as the piecewise linear function of its nodal values."""

    def __init__(self, path):
        try:
            self.solution = ContactSolution.Load(path)
        except UnreadableFile as error:
            raise UnreadableFile(f"{path} is no reference solution ({error}); delete it, it will be computed again") from None
        self.u, self.multiplier = self.solution.u, self.solution.multiplier
        self.nodes = TraceNodes(self.multiplier.space)
        self.nodal_values = self.multiplier.vec.FV().NumPy().copy()

    def Displacement(self, x, y):
        """u (n, 2) and ∂_j u_i (n, 4)."""
        points = self.u.space.mesh(x, y)
        return self.u(points), Grad(self.u)(points)

    def Pressure(self, s):
        """λ at arc lengths."""
        return np.interp(s, self.nodes.arclengths, self.nodal_values)


class ErrorMeasure:
    """Norms of the difference to the reference on one mesh: its own rules, cut where it is cut; the reference by point."""

    def __init__(self, V, reference):
        self.points, self.weights, x, y = measure_points(V.body.dx(space=V), V.mesh)
        self.u, self.gradient = reference.Displacement(x, y)
        self.crack_points, self.crack_weights, s, _ = measure_points(V.body.dcrack(space=V), V.mesh)
        self.pressure = reference.Pressure(s)

    def Norms(self, u=0, gradient=0, pressure=0, gamma=1):
        """Of (reference - given): L2, H1 (full), energy, multiplier, and the theorems' (H1² + ‖γ^½ λ‖²)^½."""
        du, dg, dp = self.u - u, self.gradient - gradient, self.pressure - pressure
        strain = np.stack([dg[:, 0], dg[:, 3], 0.5 * (dg[:, 1] + dg[:, 2])])
        density = MATERIAL.lam * (strain[0] + strain[1]) ** 2 + 2 * MATERIAL.mu * (strain[0] ** 2 + strain[1] ** 2 + 2 * strain[2] ** 2)
        L2, semi, energy = (float(self.weights @ values) for values in ((du**2).sum(axis=1), (dg**2).sum(axis=1), density))
        multiplier, weighted = float(self.crack_weights @ dp**2), float(self.crack_weights @ (gamma * dp**2))
        squares = {"L2": L2, "H1": L2 + semi, "energy": energy, "multiplier": multiplier, "norm": L2 + semi + weighted}
        return {name: float(np.sqrt(value)) for name, value in squares.items()}

    def Errors(self, solution, gamma):
        """Norms of the error of a solution on this mesh; gamma weighs the multiplier in "norm"."""
        u, gradient = (cf(self.points) for cf in (solution.u, Grad(solution.u)))
        pressure, weight = (np.ravel(cf(self.crack_points)) for cf in (solution.multiplier, gamma))
        return self.Norms(u, gradient, pressure, weight)


def measure_points(measure, mesh):
    """NGSolve's mesh points of a measure's rule, their weights, and their places."""
    element, xi, eta, weight, x, y = measure.Points(ORDER)
    points = np.repeat(mesh(np.array([0.25]), np.array([0.25])), len(element))
    points["nr"], points["x"], points["y"] = element, xi, eta
    return points, weight, x, y


def oscillation(solution):
    """Spurious variation of λ_h: its total variation over that of a monotone function of the same range, minus one.

    The exact λ falls monotonously from the transition to the tip, so zero is exact.
    """
    values = solution.multiplier.vec.FV().NumPy()
    return float(np.abs(np.diff(values)).sum() / max(np.ptp(values), np.finfo(float).tiny) - 1)


def convergence_records(measure, mesh, key, stabilisation, pair):
    """One record for each cone; a pair that cannot be solved gives a record that says why."""
    problem = paper_problem(mesh, pair=pair, stabilisation=stabilisation)
    gamma = BarbosaHughes().Gamma(problem.V, MATERIAL)
    start, cones = perf_counter(), ["nonpositive"] + ["weak"] * (PAIRS[pair].multiplier_order > 0)
    try:
        reduced = ReducedProblem(problem)
    except SolveError as error:
        return [key | {"cone": cone, "error": None, "reason": f"{type(error).__name__}: {error}"} for cone in cones]
    seconds = perf_counter() - start
    return [solve_record(reduced, cone, measure, gamma, key) | {"seconds": seconds} for cone in cones]


def solve_record(reduced, cone, measure, gamma, key):
    """The record of one solve."""
    record = key | {"cone": cone, "triangles": reduced.problem.V.mesh.ne, "unknowns": [reduced.problem.V.ndof, reduced.problem.W.ndof]}
    try:
        solution = reduced.Solve(StepOptions(cone=CONES[cone]))
    except SolveError as error:
        return record | {"error": None, "reason": f"{type(error).__name__}: {error}"}
    return record | {
        "error": measure.Errors(solution, gamma),
        "energy_to_fitted": solution.Energy() / REFERENCE["B"]["energy"] - 1,
        "force_to_fitted": solution.ContactForce() / REFERENCE["B"]["contact_force"] - 1,
        "transitions": [float(s) for s in solution.Transitions()],
        "iterations": solution.report.iterations,
        "fallback": solution.report.fallback,
        "oscillation": oscillation(solution),
    }


def gamma0_record(measure, mesh, pair, gamma0, key):
    """Errors and the smallest eigenvalue of K - K_γ for one γ_0, in the coercive zone or beyond it."""
    problem = paper_problem(mesh, pair=pair, stabilisation=BarbosaHughes(gamma0=gamma0))
    gamma = BarbosaHughes().Gamma(problem.V, MATERIAL)
    record = key | {"gamma0": gamma0, "coercivity": Coercivity(problem), "error": None}
    try:
        solution = ReducedProblem(problem, check=False).Solve()
    except (SolveError, np.linalg.LinAlgError) as error:
        return record | {"reason": f"{type(error).__name__}: {error}"}
    return record | {"error": measure.Errors(solution, gamma), "oscillation": oscillation(solution)}


def chosen_record(measure, mesh, pair, key):
    """What BarbosaHughes() chooses: smallest, median and largest γ_T/h_T, and its errors."""
    stabilisation = BarbosaHughes()
    problem = paper_problem(mesh, pair=pair, stabilisation=stabilisation)
    limits = stabilisation.Limits(problem.V, MATERIAL)
    gamma = stabilisation.Gamma(problem.V, MATERIAL)
    solution = problem.Solve()
    return key | {
        "gamma0": [float(limits.min()), float(np.median(limits)), float(limits.max())],
        "coercivity": Coercivity(problem),
        "error": measure.Errors(solution, gamma),
        "oscillation": oscillation(solution),
    }


STABILISATIONS = {"none": None, "larger": BarbosaHughes()}
# the authors' program, and the same made consistent, at its γ_0 = 0.01 (our γ_0 is half of it); on structured meshes,
# where that is in the coercive zone
BOTH_SIDES = {"both": BothSides(0.005), "both-halved": BothSides(0.005, weight=0.5), "none": None, "larger": BarbosaHughes()}


def inf_sup_record(mesh, pair, key):
    """The numerical inf-sup constant of an unstabilised pair."""
    problem = paper_problem(mesh, pair=pair)
    return key | {"value": InfSup(problem.V, problem.W)}


class Study:
    """Runs what is missing in study.jsonl and says how far it is.

    The file may hold records of other references (cells) and versions: they are kept, and are no part of this study's `records`.
    """

    def __init__(self, folder, sizes=SIZES, realisations=5, structured=False, cells=REFERENCE_CELLS, progress=print):
        self.folder, self.sizes, self.realisations, self.structured, self.cells = Path(folder), sizes, realisations, structured, cells
        self.progress = progress
        self.folder.mkdir(parents=True, exist_ok=True)
        self.path = self.folder / "study.jsonl"
        self.setting = {"cells": cells, "versions": versions()}

    def _read(self):
        records = read_records(self.path)
        write_records(self.path, records)  # without a line that was cut off
        self.records = [record for record in records if self.setting.items() <= record.items()]
        self.done = {record_key(record) for record in self.records}

    def Add(self, records):
        """Appends finished records to the file."""
        records = [record | self.setting for record in records]
        with open(self.path, "a", encoding="utf-8") as file:
            file.write("".join(json.dumps(record) + "\n" for record in records))
        self.records += records
        self.done |= {record_key(record) for record in records}

    def Run(self):
        """All that is missing; returns the records. Raises BlockingIOError if another process works in the folder, UnreadableFile for damaged files."""
        with only_one(self.folder / "study.lock", f"the folder {self.folder}"):
            self._read()
            return self._run()

    def _run(self):
        self.progress("reference solution ...")
        self.reference = Reference(reference_solution(self.folder, self.cells))
        meshes = [(h, i, self.structured) for h in self.sizes for i in range(self.realisations)]
        meshes += [] if self.structured else [(h, 0, True) for h in self.sizes]
        with TaskManager():
            for number, (h, i, structured) in enumerate(meshes):
                self.progress(f"mesh {number + 1} of {len(meshes)}: h = {h}, " + ("structured" if structured else f"realisation {i}"))
                self._mesh(h, i, structured)
        write_csv(self.folder / "study.csv", self.records)
        return self.records

    def _mesh(self, h, i, structured):
        base = {"mesh": "structured" if structured else "unstructured", "h": h, "realisation": i}
        missing = [task for task in self._tasks(h, i, base) if record_key(task[0]) not in self.done]
        if not missing:
            return
        mesh = realisation_mesh(h, i, structured)
        measure = ErrorMeasure(paper_problem(mesh, pair="P1/P1").V, self.reference)  # its tip functions grade the rules
        if "reference" not in {record["kind"] for record in self.records}:
            self.Add([{"kind": "reference", "norm": measure.Norms()}])
        for key, run in missing:
            self.Add(run(measure, mesh, key))

    def _tasks(self, h, i, base):
        structured = base["mesh"] == "structured"
        for pair in PAIRS if self.structured or not structured else ["P2/P1"]:
            for name, stabilisation in (BOTH_SIDES if structured and pair == "P2/P1" else STABILISATIONS).items():
                key = {"kind": "convergence"} | base | {"pair": pair, "stabilisation": name}
                yield key, lambda m, mesh, key, s=stabilisation, p=pair: convergence_records(m, mesh, key, s, p)
            if not structured:
                yield {"kind": "infsup"} | base | {"pair": pair}, lambda m, mesh, key, p=pair: [inf_sup_record(mesh, p, key)]
        if h == 0.03 and not structured:
            for pair in ("P1/P0", "P1/P1", "P2/P1"):
                yield {"kind": "chosen"} | base | {"pair": pair}, lambda m, mesh, key, p=pair: [chosen_record(m, mesh, p, key)]
                for gamma0 in GAMMA0:
                    key = {"kind": "gamma0"} | base | {"pair": pair, "gamma0": gamma0}
                    yield key, lambda m, mesh, key, p=pair, g=gamma0: [gamma0_record(m, mesh, p, g, key)]


def record_key(record):
    """What makes a task the same as another."""
    gamma0 = record.get("gamma0") if record["kind"] == "gamma0" else None
    return tuple(record.get(name) for name in ("kind", "mesh", "h", "realisation", "pair", "stabilisation")) + (gamma0,)


def read_records(path):
    """The records of a study; a last line that was cut off is left out. Raises UnreadableFile for any other line that is no record."""
    lines = path.read_text(encoding="utf-8", errors="replace").split("\n") if path.exists() else [""]
    return [read_record(line, path, number + 1) for number, line in enumerate(lines[:-1])]


def read_record(line, path, number):
    """That of a line."""
    try:
        record = json.loads(line)
        record_key(record)
        return record
    except (json.JSONDecodeError, KeyError, TypeError, AttributeError) as error:
        raise UnreadableFile(f"{path}, line {number} is no record of a study ({error}); delete the line, and what it held will be computed again") from None


def write_records(path, records):
    """The whole file anew."""
    text = "".join(json.dumps(record) + "\n" for record in records)
    write_whole(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))


def write_csv(path, records):
    """The convergence records as a table."""
    columns = [
        "mesh",
        "h",
        "realisation",
        "pair",
        "stabilisation",
        "cone",
        "L2",
        "H1",
        "energy",
        "multiplier",
        "norm",
        "energy_to_fitted",
        "force_to_fitted",
        "iterations",
        "oscillation",
        "reason",
    ]

    def write(temporary):
        with open(temporary, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, columns, extrasaction="ignore", restval="")
            writer.writeheader()
            writer.writerows(record | (record["error"] or {}) for record in records if record["kind"] == "convergence")

    write_whole(path, write)
