"""The material of the references, E = 1 and ν = 0.3 in plane strain, and the fields at the tip of a crack."""

from __future__ import annotations

import numpy as np
from ngsolve import CF, Id, IfPos, Sym, Trace, atan2, cos, sin, sqrt, x, y
from scipy.special import beta

E, NU = 1.0, 0.3
MU, LAM = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
KAPPA = 3 - 4 * NU  # Kolosov's constant


def stress(gradient):
    strain = Sym(gradient)
    return 2 * MU * strain + LAM * Trace(strain) * Id(2)


class TipFields:
    """The fields of unit K_I and K_II at a tip with direction e1, and the weight q = (1 - r²/radius²)⁴."""

    def __init__(self, tip, e1, radius):
        self.tip, self.e1, self.e2 = np.array(tip), e1, np.array([-e1[1], e1[0]])
        self.X, self.Y = ((x - tip[0]) * e[0] + (y - tip[1]) * e[1] for e in (self.e1, self.e2))
        self.r = sqrt(self.X**2 + self.Y**2)
        self.q_gradient = IfPos(radius - self.r, -8 / radius**2 * (1 - self.r**2 / radius**2) ** 3, 0) * CF((x - tip[0], y - tip[1]))
        self.faces = (KAPPA + 1) / (4 * MU) * np.sqrt(radius / (2 * np.pi)) * beta(0.25, 5)  # ∫ q (κ + 1) / (2μ √(2πr)) dr

    def Gradients(self):
        """Of the displacements, in the axes of the plane."""
        angle = atan2(self.Y, self.X) / 2
        c, s, scale = cos(angle), sin(angle), sqrt(self.r / (2 * np.pi)) / (2 * MU)
        one = c * (KAPPA - 1 + 2 * s * s), s * (KAPPA + 1 - 2 * c * c)
        two = s * (KAPPA + 1 + 2 * c * c), -c * (KAPPA - 1 - 2 * s * s)
        for local in (one, two):
            u = [scale * (local[0] * self.e1[i] + local[1] * self.e2[i]) for i in (0, 1)]
            yield CF(tuple(component.Diff(variable) for component in u for variable in (x, y)), dims=(2, 2))
