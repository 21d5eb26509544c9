"""Which unknown of V_h is what."""

import numpy as np

from .. import _ngsxfem_contact as core


class Unknowns:
    """The layout of V_h: the coefficients a_i of φ_i, component after component, those b_i of the Heaviside functions, and those c_j of the tips, or of fronts.

    Attributes
    ----------
    components
        Of u.
    functions
        The number of φ_i.
    jumps
        The number of Heaviside functions of one component.
    polynomial, heaviside, regular
        Slices of all a_i, all b_i, and both.
    enriched
        (jumps,) the φ_i that each Heaviside function belongs to.
    """

    def __init__(self, V: core.CrackFESpace) -> None:
        self.V, self.functions, self.jumps, self.components = V, V.scalar_space.ndof, V.num_heaviside, V.mesh.dim
        first, end = self.components * self.functions, self.components * (self.functions + self.jumps)
        self.polynomial, self.heaviside, self.regular = slice(0, first), slice(first, end), slice(0, end)

    def Polynomial(self, component: int) -> slice:
        """The a_i of one component."""
        return slice(component * self.functions, (component + 1) * self.functions)

    def Heaviside(self, component: int) -> slice:
        """The b_i of one component."""
        first = self.heaviside.start + component * self.jumps
        return slice(first, first + self.jumps)

    @property
    def enriched(self) -> np.ndarray:
        """(jumps,): the number of the φ_i of each Heaviside function."""
        return np.array([self.V.Heaviside(j)[0] for j in range(self.jumps)], dtype=int)

    @property
    def shifts(self) -> np.ndarray:
        """(jumps,): the side s_i = ±1 of the larger part of each support."""
        return np.array([self.V.Heaviside(j)[1] for j in range(self.jumps)], dtype=int)

    def Tip(self, tip: int) -> np.ndarray:
        """The c_j of a tip."""
        return np.array(self.V.TipDofs(tip), dtype=int)

    @property
    def tips(self) -> np.ndarray:
        """The c_j of all tips, whose rows are as long as their disks are large."""
        return np.concatenate([np.zeros(0, dtype=int), *(self.Tip(tip) for tip in range(len(self.V.body.tips)))])

    def Kinds(self, dofs: np.ndarray) -> np.ndarray:
        """For each of some unknowns a number, equal where units are: 0 for a_i and b_i, t + 1 for those of tip t, 1 for those of fronts."""
        kinds = np.where(np.asarray(dofs) >= self.regular.stop, 1, 0)
        for tip in range(len(self.V.body.tips)):
            kinds[np.isin(dofs, self.Tip(tip))] = tip + 1
        return kinds


def scalar_flags(V: core.CrackFESpace) -> dict[str, float]:
    """The flags of the space of the φ_i."""
    return {key: value for key, value in V.flags.ToDict().items() if key in ("order", "orderinner")}
