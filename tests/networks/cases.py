"""Cracks that meet, under loads, and what boundary-fitted meshes say of them.

    python -m tests.networks.cases

solves each case on three meshes and writes `reference.json`: the arms and loads, and each figure as [value, error]. The error is the largest change from the
second to the third mesh among the figures of its kind and case. E = 1, ν = 0.3, plane strain. Arms are numbered from 0; + is left of the way from the first point to the
second. Forces are resultants on the plus side, compression > 0, and friction along the arm; K_II > 0 where the left face, seen towards the tip, is ahead.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from .fitted import FittedBody

FILE = Path(__file__).with_name("reference.json")
A = 0.3  # length of an arm; the body is [-1,1]²
FRACTIONS = (0.25, 0.5, 0.75)  # of an arm, where it is opened
LEVELS = [dict(order=3, maxh=0.06, tip_h=1e-4), dict(order=4, maxh=0.03, tip_h=1e-5), dict(order=5, maxh=0.02, tip_h=1e-6)]


def star(*degrees, length=A):
    """Arms from the origin."""
    ends = np.round([(length * np.cos(t), length * np.sin(t)) for t in np.radians(degrees)], 15)
    return [((0.0, 0.0), tuple(map(float, end + 0.0))) for end in ends]


CROSS, Y = star(0, 90, 180, 270), star(90, 210, 330)
T = star(180, 0, 270)  # a straight crack of half length A, and an arm below its middle

PRESSURE = dict(pressure=1.0)
CASES = {
    "cross, pressure": (CROSS, PRESSURE),
    "Y, pressure": (Y, PRESSURE),
    "Y, tension in x": (Y, dict(sigma=((1, 0), (0, 0)))),
    "Y, tension in y": (Y, dict(sigma=((0, 0), (0, 1)))),
    "T, pressure": (T, PRESSURE),
    "T, tension in x": (T, dict(sigma=((1, 0), (0, 0)))),
    "T, tension in y": (T, dict(sigma=((0, 0), (0, 1)))),
    "star, pressure": (star(*range(0, 360, 60)), PRESSURE),
    "Y, two arms closed": (Y, dict(sigma=((0.5, 0.2), (0.2, -1)))),
    "Y, one arm closed in part": (Y, dict(sigma=((-0.2, 0.2), (0.2, -1)))),
    "T, straight crack closed": (T, dict(sigma=((0.5, 0.2), (0.2, -1)))),
    "Y, two arms closed, friction 0.3": (Y, dict(sigma=((0.5, 0.2), (0.2, -1)), friction=0.3)),
    "T, straight crack closed, friction 0.2": (T, dict(sigma=((0.5, 0.2), (0.2, -1)), friction=0.2)),
    "T, one arm closed in part": (T, dict(sigma=((-1, 0.5), (0.5, -0.2)))),
    "kink of 120 degrees, pressure": (star(180, 120), PRESSURE),
    "kink of 120 degrees, tension in y": (star(180, 120), dict(sigma=((0, 0), (0, 1)))),
}
# K_I = 0.8636 p√(πA) (1 + 0.67 (A/w)²): the infinite plane within 0.3 % from a half-width w = 15 A on
CASES |= {f"cross, pressure, half-width {ratio} A": (CROSS, dict(half_width=ratio * A, **PRESSURE)) for ratio in (5, 10, 20, 40)}


def figures(arms, level, half_width=1.0, **load):
    """Name → value; K in a disk that touches no other arm, K_I at tips that are open only, K_II of tips that rub from the slip."""
    body = FittedBody(arms, half_width, **level)
    solution, found = body.Solve(**load), {}
    directions = np.array([arm.t for arm in body.arms])
    for arm, end in body.tips:
        nearest = max([0.5] + [d @ body.arms[arm].t for k, d in enumerate(directions) if k != arm])  # cosine
        radius = 0.95 * A * np.sqrt(1 - nearest**2)
        K_I, K_II = solution.StressIntensity((arm, end), radius)
        found |= {} if np.isnan(K_I) else {f"K_I, arm {arm}": K_I}
        found |= {f"K_II, arm {arm}": solution.StressIntensityFromJumps((arm, end), 0.02 * A)[1] if np.isnan(K_II) else K_II}
    for arm in range(len(arms)):
        for fraction in FRACTIONS:
            opening, slip = solution.Jump(arm, fraction)
            found |= {f"opening, arm {arm} at {fraction}": opening, f"slip, arm {arm} at {fraction}": slip}
        normal, tangential = solution.ContactForce(arm)
        found |= {f"force, arm {arm}": normal, f"closed, arm {arm}": solution.ClosedPart(arm)}
        found |= {f"friction force, arm {arm}": tangential} if solution.friction else {}
    return found | {"energy": solution.energy}


def kind(name):
    """What errors are compared within: jumps with jumps, K_I with K_II."""
    head = name.split(",")[0]
    return {"slip": "opening", "K_II": "K_I", "friction force": "force"}.get(head, head)


def with_errors(fine, medium):
    """Name → [value, error]; the closed part of an arm is known to one element."""
    change = {name: abs(value - medium.get(name, np.inf)) for name, value in fine.items()}
    largest = {k: max(c for name, c in change.items() if kind(name) == k) for k in map(kind, fine)}
    largest["closed"] = max(largest["closed"], LEVELS[-2]["maxh"] / A if any(0.05 < fine[n] < 0.95 for n in fine if kind(n) == "closed") else 0)
    return {name: [float(f"{value:.9g}"), float(f"{largest[kind(name)]:.2g}")] for name, value in fine.items()}


def reference(case):
    """Name → (value, error) of a case, from the file."""
    return {name: tuple(pair) for name, pair in json.loads(FILE.read_text(encoding="utf-8"))[case]["figures"].items()}


def text(kept):
    """JSON with a line for each figure."""
    lines = []
    for name, case in kept.items():
        head = "".join(f" {json.dumps(key)}: {json.dumps(value)},\n" for key, value in case.items() if key != "figures")
        body = ",\n".join(f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in case["figures"].items())
        lines.append(f'{json.dumps(name)}: {{\n{head} "figures": {{\n{body}}}}}')
    return "{\n" + ",\n".join(lines) + "}\n"


def main(names):
    """Solves the named cases, all without names, and keeps the others of the file."""
    kept = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    for name in names or CASES:
        arms, load = CASES[name]
        coarse, medium, fine = (figures(arms, level, **load) for level in LEVELS)
        kept[name] = dict(arms=arms, **load, figures=with_errors(fine, medium))
        print(
            name,
            *(f"  {key}: {value} ± {error}   {medium[key] - coarse.get(key, np.nan):.1e}" for key, (value, error) in kept[name]["figures"].items()),
            sep="\n",
            flush=True,
        )
        FILE.write_text(text({name: kept[name] for name in CASES if name in kept}), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
