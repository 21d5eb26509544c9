"""Errors beside those of the authors' program on its own meshes: load B, stabilised.

    python benchmarks/program.py FOLDER [--reference STUDY]

FOLDER holds the meshes u0.088.vol ... u0.008.vol; STUDY is the folder of `python -m study`, whose reference is used.
"""

import argparse
import json
from pathlib import Path

from ngsolve import Mesh, TaskManager, ngsglobals
from results import recorded

from ngsxfem_contact import BarbosaHughes
from study.paper import MATERIAL, paper_problem
from study.study import ErrorMeasure, Reference, reference_solution


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--reference", type=Path, default=Path("results/study"))
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    reference = Reference(reference_solution(options.reference))
    table = json.loads((Path(__file__).parent / "program.json").read_text())
    print(f"{'mesh':7}{'pair':8}" + "".join(f"{name + ': ours':>18}{'program':>10}{'ratio':>7}" for name in ("L2", "H1", "multiplier")) + f"{'iterations':>14}")
    measures = {}
    with TaskManager():
        for row in table["rows"]:
            mesh = measures[row["mesh"]].mesh if row["mesh"] in measures else Mesh(str(options.folder / f"u{row['mesh']}.vol"))
            problem = paper_problem(mesh, pair=row["pair"])
            if row["mesh"] not in measures:
                measures[row["mesh"]] = ErrorMeasure(problem.V, reference)
                measures[row["mesh"]].mesh = mesh
            solution = problem.Solve()
            errors = measures[row["mesh"]].Errors(solution, BarbosaHughes().Gamma(problem.V, MATERIAL))
            cells = "".join(f"{errors[name]:18.2e}{row[name]:10.2e}{errors[name] / row[name]:7.2f}" for name in ("L2", "H1", "multiplier"))
            print(f"{row['mesh']:7}{row['pair']:8}{cells}{solution.report.iterations:8} / {row['iterations']}", flush=True)


if __name__ == "__main__":
    recorded(main)
