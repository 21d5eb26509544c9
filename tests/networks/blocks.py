"""Blocks held by contact and friction: closed forms for a square in four blocks, and for brickwork.

Cracks run in +x and +y. Along them σ_n = n·σn and σ_t = t·σn with n to the left of the direction t; sliding means |σ_t| = μ |σ_n| with the sign of the
slip (u⁺ - u⁻)·t.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ARMS = {"left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1)}  # from the junction


def blocks_beside(arm):
    """The blocks (row, column) on the plus and on the minus side: above and below, left and right."""
    x, y = ARMS[arm]
    return ((1, (x + 1) // 2), (0, (x + 1) // 2)) if y == 0 else (((y + 1) // 2, 0), ((y + 1) // 2, 1))


@dataclass(frozen=True)
class FourBlocks:
    """The unit square cut by a horizontal and a vertical crack through `junction`; each block (row, column) has a uniform stress.

    σ_xy = tau everywhere, σ_xx = -p[row], σ_yy = -q[column]: so the tractions on the faces balance. The lower left block is (0, 0).

    Parameters
    ----------
    lam, mu
        Lamé's constants.
    p, q, tau
        Compression of the rows in x and of the columns in y, and the shear stress.
    slide
        (u_x of the upper row less that of the lower one, u_y of the right column less that of the left one), at the junction.
    """

    lam: float
    mu: float
    p: tuple[float, float] = (1.0, 1.0)
    q: tuple[float, float] = (1.0, 1.0)
    tau: float = 0.0
    slide: tuple[float, float] = (0.0, 0.0)
    junction: tuple[float, float] = (0.5, 0.5)

    @property
    def cracks(self):
        """The horizontal and the vertical one, as points."""
        cx, cy = self.junction
        return [[(0.0, cy), (1.0, cy)], [(cx, 0.0), (cx, 1.0)]]

    def Stress(self, row, column):
        return np.array([[-self.p[row], self.tau], [self.tau, -self.q[column]]])

    def Displacement(self, row, column):
        """(c, G) of u = c + G (x - junction); the lower left block does not move at the junction, and no block turns."""
        stress = self.Stress(row, column)
        strain = (stress - self.lam / (2 * (self.lam + self.mu)) * np.trace(stress) * np.eye(2)) / (2 * self.mu)
        return np.array(self.slide) * (row, column), strain

    def Slip(self, arm, distance):
        """(u⁺ - u⁻)·t at this distance from the junction."""
        horizontal = ARMS[arm][1] == 0
        plus, minus = blocks_beside(arm)
        at = distance * np.array(ARMS[arm], float)
        u = [c + G @ at for c, G in (self.Displacement(*plus), self.Displacement(*minus))]
        return (u[0] - u[1])[0 if horizontal else 1]

    def Forces(self, arm):
        """(∫σ_n, ∫σ_t, ∫σ_n ρ), ρ the distance along the crack from the junction."""
        length, along = self.Length(arm), sum(ARMS[arm])
        horizontal = ARMS[arm][1] == 0
        stress = self.Stress(*blocks_beside(arm)[0])
        normal, shear = (stress[1, 1], self.tau) if horizontal else (stress[0, 0], -self.tau)
        return normal * length, shear * length, normal * along * length**2 / 2

    def Length(self, arm):
        x, y = ARMS[arm]
        c = self.junction[0 if y == 0 else 1]
        return 1 - c if x + y > 0 else c

    def Loads(self):
        """(row, column) → (F_x, F_y, moment about the junction) of the tractions on the sides of each block."""
        return {(row, column): self._Load(row, column) for row in (0, 1) for column in (0, 1)}

    def _Load(self, row, column):
        sx, sy = 2 * column - 1, 2 * row - 1
        width, height = self.Length("right" if column else "left"), self.Length("top" if row else "bottom")
        stress = self.Stress(row, column)
        sides = [(height * stress @ (sx, 0), (sx * width, sy * height / 2)), (width * stress @ (0, sy), (sx * width / 2, sy * height))]
        return (*sum(force for force, _ in sides), sum(at[0] * f[1] - at[1] * f[0] for f, at in sides))

    def Check(self, friction):
        """Raises a ValueError unless every arm obeys Coulomb's law; friction is (μ of the horizontal crack, μ of the vertical one)."""
        for arm in ARMS:
            normal, shear, _ = self.Forces(arm)
            limit = -friction[0 if ARMS[arm][1] == 0 else 1] * normal
            slips = [self.Slip(arm, s) for s in (0, self.Length(arm))]
            slides = max(map(abs, slips)) > 0
            if normal >= 0 or abs(shear) > limit * (1 + 1e-12) or slides and not all(np.isclose(shear, np.sign(s) * limit) for s in slips if s):
                raise ValueError(f"{arm}: ∫σ_n = {normal}, ∫σ_t = {shear}, slips {slips} are against Coulomb's law")


def sticking(lam, mu, p=1.0, q=1.0, tau=0.2, junction=(0.5, 0.5)):
    """No arm slides: one uniform stress; needs |tau| ≤ μ q and |tau| ≤ μ p."""
    return FourBlocks(lam, mu, (p, p), (q, q), tau, junction=junction)


def row_slides(lam, mu, friction, p=(1.0, 1.0), q=1.0, slide=1.0, junction=(0.5, 0.5)):
    """The upper row slides over the lower one, the vertical crack sticks: σ_xy = friction q; needs friction q ≤ μ p of the vertical crack.

    With different p the slip varies along the crack; a large slide keeps its sign.
    """
    return FourBlocks(lam, mu, p, (q, q), np.sign(slide) * friction * q, (slide, 0.0), junction)


def all_slide(lam, mu, friction, p=1.0, slide=(1.0, 1.0), junction=(0.5, 0.5)):
    """Both cracks slide: σ_xy = friction[0] q = friction[1] p, which sets q; both slides have the same sign."""
    return FourBlocks(lam, mu, (p, p), (friction[1] * p / friction[0],) * 2, np.sign(slide[0]) * friction[1] * p, slide, junction)


def pushed_row(q, widths, friction):
    """The upper row pushed in +x over the lower one, which is held, by a smooth plate on its left side; pressure q on top, the vertical crack smooth.

    All of the horizontal crack slides, and statics alone gives, whatever the distribution: name → (∫σ_n, ∫σ_t) on the arms, and the push.
    """
    normal = {"left": -q * widths[0], "right": -q * widths[1]}
    arms = {arm: (n, -friction * n) for arm, n in normal.items()}
    return arms | {"top": (-friction * q * widths[1], 0.0)}, friction * q * sum(widths)


def equilibrium_residuals(forces, loads):
    """(row, column) → (F_x, F_y, moment about the junction) that acts on a block in all; zero for any state of equilibrium.

    Parameters
    ----------
    forces
        Arm → (∫σ_n, ∫σ_t, ∫σ_n ρ) as FourBlocks.Forces gives them.
    loads
        (row, column) → (F_x, F_y, moment about the junction) of all other forces.
    """
    total = {block: np.array(load, float) for block, load in loads.items()}
    for arm, (normal, shear, moment) in forces.items():
        horizontal = ARMS[arm][1] == 0
        on_minus = np.array([shear, normal, moment] if horizontal else [-normal, shear, moment])  # n = (0,1), or (-1,0)
        for sign, block in zip((-1, 1), blocks_beside(arm)):
            total[block] = total[block] + sign * on_minus
    return total


@dataclass(frozen=True)
class Brickwork:
    """The unit square in courses of bricks, each course shifted by half a brick; bed joints are horizontal, head joints end on them.

    Parameters
    ----------
    courses
        Their number.
    bricks
        Their number in the even courses; an odd course has one more, the outer ones half as wide.
    """

    courses: int
    bricks: int

    @property
    def beds(self):
        return [[(0.0, j / self.courses), (1.0, j / self.courses)] for j in range(1, self.courses)]

    @property
    def heads(self):
        return [[(x, j / self.courses), (x, (j + 1) / self.courses)] for j in range(self.courses) for x in self._Joints(j)]

    def _Joints(self, course):
        return [(i + 0.5) / self.bricks for i in range(self.bricks)] if course % 2 else [i / self.bricks for i in range(1, self.bricks)]

    @property
    def areas(self):
        """Of the bricks, course by course."""
        return [width / self.courses for j in range(self.courses) for width in np.diff([0.0, *self._Joints(j), 1.0])]


@dataclass(frozen=True)
class SmoothWall:
    """A column between smooth walls under a pressure on top and its own weight, whatever joints without friction or with it divide it.

    u_x = 0, u_y = 0 at y = 0. On a bed joint σ_n = σ_yy, on a head joint σ_n = σ_xx, σ_t = 0. Arguments may be CoefficientFunctions.
    """

    lam: float
    mu: float
    pressure: float = 1.0
    weight: float = 0.0

    def Displacement(self, y):
        """u_y."""
        return -((self.pressure + self.weight) * y - self.weight * y * y / 2) / (self.lam + 2 * self.mu)

    def Stress(self, y):
        """(σ_xx, σ_yy)."""
        vertical = -(self.pressure + self.weight * (1 - y))
        return self.lam / (self.lam + 2 * self.mu) * vertical, vertical
