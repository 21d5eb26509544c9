"""What is read along a crack, and the state at the nodes that it is read from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..operators import TANGENTIAL, NormalGap, Slip
from ..points import crack_points
from ..protocols import Cone, Nodes
from ..tables import Table
from .faces import FaceHistory, FaceWork

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..algebra.face_path import PathPoint
    from .solution import ContactSolution


class CrackProfile(Table):
    """A Table of n points along a crack, in the user's units of length and stress; its columns are arrays (n,).

    Attributes
    ----------
    s
        Arc length.
    x, y
        The points.
    gap
        g_n = jump(u)·n of u_h, without the initial gap g_0 of the problem. Contact keeps g_n + g_0 ≥ 0 in the mean with each function of the multiplier; between nodes the
        faces may overlap by the error of discretisation.
    slip
        g_t.
    sigma_n
        λ: ≤ 0, but where a law pulls.
    sigma_t
        λ_t with friction, see Profile.
    """


@dataclass
class State:
    """Of the nodes where signs are taken.

    Attributes
    ----------
    nodes
        The Nodes of the multipliers.
    cone
        What their values mean.
    L
        The multipliers there.
    residual
        (B - C_γ) U + D_γ L - G: -∫ψ_i (g_n + g_0) and -∫ψ_i g_t with their stabilising parts.
    history
        Tractions, jumps and the law's variables, for the next load step.
    work
        Of the faces in this step.
    path
        Of PathSteps: the load factor, and the PathPoint before, from which the next step goes on; None for other solutions.
    """

    nodes: Nodes
    cone: Cone
    L: np.ndarray
    residual: np.ndarray
    history: FaceHistory | None = None
    work: FaceWork = FaceWork()
    path: tuple[float, PathPoint | None] | None = None


def profile(solution: ContactSolution, crack: int, n: int) -> CrackProfile:
    """That of a solution at n points of a crack, equally spaced in arc length."""
    body = solution.body
    s = np.linspace(0, body.cracks[crack].length, n)
    points = crack_points(body, crack, s)
    x, y = np.array([body.cracks[crack].PointAt(si) for si in s]).T
    gap, slip, sigma_n = (f(points).ravel() for f in (NormalGap(solution.u, body), Slip(solution.u, body), solution.multiplier))
    columns = {"s": s, "x": x, "y": y, "gap": gap, "slip": slip, "sigma_n": sigma_n}
    if solution.tangential_multiplier:
        return CrackProfile.Of(columns | {"sigma_t": solution.tangential_multiplier(points).ravel()})
    # at a tip itself the terms of the stress cancel only in exact arithmetic
    inside = crack_points(body, crack, np.clip(s, 1e-6 * s[-1], (1 - 1e-6) * s[-1]))
    return CrackProfile.Of(columns | {"sigma_t": solution.Traction(TANGENTIAL, "larger")(inside).ravel()})


def changes(nodes: Any, crack: int, states: np.ndarray, where: Callable[..., Any]) -> np.ndarray:
    """Arc lengths half-way between neighbours on a crack whose states differ; nodes: the plane's, which have arc lengths."""
    pairs = nodes.neighbours[nodes.cracks[nodes.neighbours[:, 0]] == crack]
    a, b = states[pairs.T]
    return nodes.arclengths[pairs[(a != b) & where(a, b)]].mean(axis=1)


def step_values(solution: ContactSolution) -> dict[str, Any]:
    """What a table of steps says of each, without its displacement: iterations, the part of the cracks whose nodes are in contact, forces, and energies of the faces."""
    state, report = solution.state, solution.report
    weights, history = state.nodes.weights, state.history
    forces = np.zeros(2) if history is None else np.append(history.traction @ weights, [0.0, 0.0])
    return {
        "iterations": report.iterations,
        "in_contact": float(weights[report.active[-1]].sum() / max(weights.sum(), np.finfo(float).tiny)),
        "contact_force": float(forces[0]),
        "tangential_force": float(forces[1]) if len(forces) < 5 else float(np.linalg.norm(forces[1:3])),
        "dissipated": state.work.dissipated,
        "stored": state.work.stored,
    }
