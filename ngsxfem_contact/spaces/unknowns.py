"""Which unknown of V_h is what."""

import numpy as np


def tip_unknowns(V):
    """Those of the singular functions of all tips, whose rows are as long as their disks are large."""
    return np.array([dof for tip in range(len(V.body.tips)) for dof in V.TipDofs(tip)], dtype=int)
