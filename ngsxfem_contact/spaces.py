"""The spaces: V_h of displacements (section 3 of docs/method.md) and W_h of multipliers (section 4)."""

from dataclasses import dataclass, replace
from difflib import get_close_matches

import numpy as np
from ngsolve import BilinearForm, CreateVVector, GridFunction, Projector
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import eigsh

from . import _ngsxfem_contact as core
from .arguments import INFINITY, check_number, check_positive, check_type, check_whole
from .elasticity import Elasticity, Isotropic
from .resolution import place, warn, warn_of_coarse
from .tip_disk import largest_disk

UNKNOWN = Elasticity.PlaneStrain(E=2.6, nu=0.3)  # μ = 1: the modes at a tip until its material is known


@dataclass(frozen=True)
class TipEnrichment:
    """χ F_j at a tip: the singular functions and the cut-off χ = 1 for r ≤ r0, 0 for r ≥ r1.

    r1: default 0.9 × the largest possible radius: the tip's clearance (see `body.tips`), and the distance to curved
        elements and, for the modes, to other materials.    r0: default r1 / 50.
    cutoff: "quintic" (χ is C²) or "cubic" (C¹).
    material: with an Elasticity (or Elasticity.ByRegion) the two vector modes of unit K_I and K_II, whose coefficients are the stress
        intensity factors and whose lips are free of traction: 2 unknowns for each tip. Default: that of CrackFESpace(material=...).
    functions: "modes", or "branch" for the four scalar functions (8) of [AHLMR12] in each component, 8 unknowns, whose lips carry
        tractions: in contact pressures and K_I are less accurate. Default: modes; without a material those of the ContactProblem that is made of the space.
    tolerance: of the integration rules around the tip, relative to the integral over an element. The default changes the
        mean errors of energy and K by less than a hundredth of themselves (tests/test_contact.py).
    r0 and r1 are lengths.    Raises ValueError unless 0 <= r0 < r1 < inf, TypeError for a material that is none; CrackFESpace raises
    for a disk that does not fit the body.
    """

    r0: float | None = None
    r1: float | None = None
    cutoff: str = "quintic"
    material: Isotropic | None = None
    functions: str | None = None
    tolerance: float = 1e-5

    def __post_init__(self):
        if self.cutoff not in core.CutOff.__members__:
            raise ValueError(f"TipEnrichment: cutoff={self.cutoff!r} is not one of {list(core.CutOff.__members__)}")
        check_number(self.tolerance, "TipEnrichment: tolerance", lambda tolerance: 0 < tolerance < 1, "lie between 0 and 1")
        if self.r1 is not None:
            check_positive(self.r1, "TipEnrichment: r1")
        if self.r0 is not None:
            r1 = INFINITY if self.r1 is None else self.r1
            check_number(self.r0, "TipEnrichment: r0", lambda r0: 0 <= r0 < r1, f"be less than r1={self.r1}: the cut-off needs 0 <= r0 < r1")
        if self.functions not in (None, "modes", "branch"):
            raise ValueError(f"TipEnrichment: functions={self.functions!r} is not 'modes' or 'branch'")
        if self.functions == "modes" and self.material is None:
            raise ValueError("TipEnrichment: functions='modes' needs material=Elasticity(...), which the modes depend on")
        check_type(self.material, Isotropic | None, "TipEnrichment: material", "an Elasticity")

    def Spec(self, body, tip):
        """What the space needs to know at one tip of `body.tips`. Raises ValueError for a disk that does not fit."""
        material = None if self.functions == "branch" else self.material
        radius, limit = largest_disk(body, tip, material)
        r1 = 0.9 * radius if self.r1 is None else self.r1
        if radius < tip.clearance and not 0 < r1 <= (1 + 1e-10) * radius:
            raise ValueError(
                f"TipEnrichment: the disk r1 = {r1:g} of the tip at ({tip.point[0]:g}, {tip.point[1]:g}) reaches {limit}, at {radius:g}; choose 0 < r1 < {radius:g}, or tip=None"
            )
        r0 = r1 / 50 if self.r0 is None else self.r0
        cutoff = core.CutOff.__members__[self.cutoff]
        if self.functions == "branch":
            return core.TipSpec(core.TipBasis.branch, cutoff, r0, r1, 0, 1)
        here = UNKNOWN if material is None else material.At(body.mesh, tip.point)
        return core.TipSpec(core.TipBasis.modes, cutoff, r0, r1, here.kappa, here.mu)

    def With(self, material):
        """The same with the modes of a material (or None), unless it has functions of its own."""
        return self if self.material is not None or self.functions is not None else replace(self, material=material)

    @property
    def undecided(self):
        """Whether there is neither a material nor a choice of functions."""
        return self.material is None and self.functions is None


class CrackFESpace(core.CrackFESpace):
    """V_h = {Σ a_i φ_i + Σ_{N_H} b_i H φ_i + χ Σ c_j F_j}: vector-valued, one FESpace.

    N_H are the functions with completely cut support. They are stored as ½(H - s_i) φ_i, s_i the sign of the larger
    part of the support: the span is the same, b_i is the nodal jump, and thin parts do no harm.

    body: CrackedMesh.    order: of φ_i, 1 or more.    bubble: with order 1 the cubic bubble of each triangle ("P1+"), with higher orders all
        bubbles of degree order + 1, which nearly incompressible materials need; default: where the material is one and order > 1.
    tip: TipEnrichment for all tips, a list with one (or None) for each of `body.tips`, or None for no tip functions.
    material: Elasticity (or Elasticity.ByRegion) of the body: the tips have its modes, and ContactProblem(V, W) takes it.
    dirichlet: names (a regular expression) of the boundaries on which u is held.    dirichletx, dirichlety: of those on which that component is held:
        rollers, planes of symmetry.    flags: orderinner, print as for NGSolve's H1.
    Warns (AccuracyWarning) of tips without a material, of cracks of less than 2 elements for each tip, and of tips whose functions have less than 2 elements of room.
    Raises TypeError or ValueError for an order that is no whole number ≥ 1, another number of tips than the body has, an unknown
    boundary and other flags, Exception for a disk that leaves the body or meets another crack.    Source: section 3 of [AHLMR12], (6) to (8).
    """

    def __init__(self, body, order=1, tip=TipEnrichment(), bubble=None, dirichlet="", dirichletx="", dirichlety="", material=None, **flags):
        check_flags(flags)
        check_type(body, core.CrackedMesh, "CrackFESpace: body", "a CrackedMesh; build one by CrackedMesh(mesh, crack, ...)")
        check_whole(order, "CrackFESpace: order", 1)
        check_type(material, Isotropic | None, "CrackFESpace: material", "an Elasticity")
        for name, pattern in (("dirichlet", dirichlet), ("dirichletx", dirichletx), ("dirichlety", dirichlety)):
            if pattern:
                flags[name] = joined_names(pattern)
                check_regions(body.mesh, flags[name], f"CrackFESpace: {name}")
        tips = tip_enrichments(tip, body, material)
        specs = [enrichment and enrichment.Spec(body, place) for enrichment, place in zip(tips, body.tips)]
        if len(tips) != len(body.tips):
            raise ValueError(f"CrackFESpace: {len(tips)} tip enrichments for {len(body.tips)} tips; give one for each of body.tips")
        tolerance = min((enrichment.tolerance for enrichment in tips if enrichment), default=1)
        if bubble is None:
            bubble = order > 1 and any(map(is_nearly_incompressible, [material, *(getattr(enrichment, "material", None) for enrichment in tips)]))
        if bubble:
            flags["orderinner"] = max(3, order + 1)
        super().__init__(body, specs, tolerance, order=order, **flags)
        self.material = material
        self.undecided = [number for number, enrichment in enumerate(tips) if isinstance(enrichment, TipEnrichment) and enrichment.undecided]
        warn_of_undecided(body, self.undecided)
        warn_of_coarse(body, specs, material)


def tip_enrichments(tip, body, material):
    """One for each tip, those that are undecided with the modes of the material."""
    tips = tip if isinstance(tip, (list, tuple)) else [tip] * len(body.tips)
    for enrichment in tips:
        if enrichment is not None and not hasattr(enrichment, "Spec"):
            raise TypeError(f"CrackFESpace: tip={enrichment!r} is neither a TipEnrichment nor None")
    return [enrichment.With(material) if isinstance(enrichment, TipEnrichment) else enrichment for enrichment in tips]


def warn_of_undecided(body, tips):
    """Tips whose material is not known."""
    if tips:
        warn(
            f"CrackFESpace: no material is given, so the tips at {', '.join(place(body.tips[number].point) for number in tips)} have modes of a material with ν = 0.3 "
            "until a ContactProblem says which; with another one forms of your own would be less accurate at the tips, and K from the modes wrong. "
            "Give CrackFESpace(..., material=...), or tip=TipEnrichment(functions='branch') for functions that need none"
        )


def decide(V, material):
    """Gives the tips of V whose material was not known that of the problem. Raises ValueError for a disk that reaches another material."""
    for number in getattr(V, "undecided", []):
        tip, spec, here = V.body.tips[number], V.tip_specs[number], material.At(V.mesh, V.body.tips[number].point)
        radius, limit = largest_disk(V.body, tip, material)
        if spec.r1 > (1 + 1e-10) * radius:
            raise ValueError(
                f"ContactProblem: the disk r1 = {spec.r1:g} of the tip at {place(tip.point)} reaches {limit}, at {radius:g}; "
                "give CrackFESpace(..., material=...), so that the disk ends before"
            )
        V.SetTipMaterial(number, here.kappa, here.mu)
    if isinstance(V, CrackFESpace):
        V.undecided = []


FLAGS = ("orderinner", "print")
NO_FLAGS = {
    "complex": "the space is real",
    "dim": "u has two components",
    "definedon": "the space lives on the whole body; take a mesh of the body alone",
    "dgjumps": "u is continuous off the cracks",
    "autoupdate": "the cracks are located in one mesh",
    "dirichlet_bbnd": "hold a vertex by problem.Pin(point, components)",
}


def check_flags(flags):
    """Raises ValueError for a flag of NGSolve's spaces that makes no sense here, TypeError for any other name."""
    for name, value in flags.items():
        if name in NO_FLAGS and value:
            raise ValueError(f"CrackFESpace: {name}={value!r} is not supported; {NO_FLAGS[name]}")
        if name not in FLAGS and name not in NO_FLAGS:
            allowed = ["order", "tip", "bubble", "dirichlet", "dirichletx", "dirichlety", "material", *FLAGS]
            meant = get_close_matches(name, allowed, 1)
            raise TypeError(
                f"CrackFESpace: there is no argument {name!r}{f' (did you mean {meant[0]!r}?)' if meant else ''}; it takes body, {', '.join(allowed)}"
            )


def joined_names(pattern):
    """One regular expression for a list of them; what is none is left to check_regions."""
    return "|".join(pattern) if isinstance(pattern, (list, tuple)) and all(isinstance(name, str) for name in pattern) else pattern


def is_nearly_incompressible(material):
    """Whether a material, or None, is nearly incompressible."""
    return material is not None and material.nearly_incompressible


def check_regions(mesh, pattern, what):
    """Raises TypeError for what is no pattern of boundary names, ValueError if it matches nothing."""
    check_type(pattern, str, what, "the name of a boundary, or a regular expression")
    if not mesh.Boundaries(pattern).Mask().NumSet():
        raise ValueError(f"{what}={pattern!r} matches no boundary; the mesh has {sorted(set(mesh.GetBoundaries()))}")


class TraceSpace(core.TraceSpace):
    """W_h on the cracks: order 0 one constant for each interval, order ≥ 1 continuous.

    basis="nodal" (default): Lagrange functions between the points where the crack meets mesh edges, its kinks and
        ends; a nodal sign is a pointwise sign for order 1.
    basis="trace": restrictions of mesh functions, redundant ones removed in the paper's two steps.
    nodes: arc lengths from 0 to the crack's length, one list for each crack (one list, if there is one crack):
        a multiplier on nodes of its own (H ≠ h). Integrate over `dcrack` of this space, which respects them.
    Raises TypeError or ValueError for an order that is no whole number ≥ 0 and another basis, Exception for nodes that do not increase from
    0 to the length of their crack.    Source: section 4 of [AHLMR12].
    """

    def __init__(self, body, order=1, basis="nodal", nodes=None):
        check_type(body, core.CrackedMesh, "TraceSpace: body", "a CrackedMesh; build one by CrackedMesh(mesh, crack, ...)")
        check_whole(order, "TraceSpace: order", 0)
        if nodes is None:
            nodes = [body.MeshNodes(c, order > 0) for c in range(len(body.cracks))]
        elif np.ndim(nodes) == 1 and len(nodes) and np.ndim(nodes[0]) == 0:
            nodes = [nodes]
        try:
            core.NodalTraceBasis(body, order, nodes)  # refuses nodes that do not fit
        except TypeError:
            raise TypeError(f"TraceSpace: nodes={nodes!r} are no arc lengths, one list of numbers for each crack") from None
        if basis == "nodal" or (basis == "trace" and order == 0):
            functions: core.TraceBasis = core.NodalTraceBasis(body, order, nodes)
        elif basis == "trace":
            functions = core.MeshTraceBasis(body, order, nodes, redundant_functions(body, order, nodes))
        else:
            raise ValueError(f"TraceSpace: basis={basis!r} is not 'nodal' or 'trace'")
        super().__init__(body, functions, order)

    def NodalPositions(self):
        """For each crack the arc lengths of the nodes at which signs are taken (for order 0: the intervals' midpoints)."""
        nodal = core.NodalTraceBasis(self.body, self.order, self.basis.nodes)
        return [nodal.DofPositions(c) for c in range(len(self.body.cracks))]

    def NodalValues(self):
        """The matrix of the functions' values at the nodes, or None where it is the identity."""
        if isinstance(self.basis, core.NodalTraceBasis):
            return None
        points = np.concatenate([crack_points(self.body, c, s) for c, s in enumerate(self.NodalPositions())])
        values = np.empty((len(points), self.ndof))
        function = GridFunction(self)
        for j in range(self.ndof):
            function.vec[:] = 0
            function.vec[j] = 1
            values[:, j] = function(points).ravel()
        if values.shape[0] != values.shape[1]:
            raise ValueError(f"TraceSpace: {values.shape[1]} independent traces for {values.shape[0]} nodes, so nodal signs do not fit; use basis='nodal'")
        return values


def crack_points(body, crack, arclengths):
    """NGSolve's mesh points at arc lengths of a crack, each in an element that carries that part of it."""
    elements, xi, eta = body.OnCrack(crack, list(arclengths))
    points = body.mesh(np.full(len(elements), body.cracks[crack].points[0][0]), np.full(len(elements), body.cracks[crack].points[0][1]))
    points["nr"], points["x"], points["y"] = elements, xi, eta
    return points


def mask(bits):
    """A BitArray as a boolean array; by iteration it takes a third of a second for a million."""
    ones, selected = CreateVVector(len(bits)), CreateVVector(len(bits))
    ones[:] = 1
    selected.data = Projector(bits, True) * ones
    return selected.FV().NumPy() != 0


def to_scipy(matrix):
    """A matrix of NGSolve as a scipy matrix in CSR format."""
    values, columns, rows = matrix.CSR()
    return csr_matrix((np.array(values), np.array(columns), np.array(rows)), shape=(matrix.height, matrix.width))


def csr_view(matrix):
    """The same without a copy: valid as long as the matrix is."""
    values, columns, rows = (np.asarray(part) for part in matrix.CSR())
    return csr_matrix((values, columns, rows), shape=(matrix.height, matrix.width), copy=False)


def add_to(matrix, other):
    """Adds a scipy matrix with a smaller pattern to a matrix of NGSolve."""
    pattern, other = to_scipy(matrix), other.tocoo()
    width = np.int64(matrix.width)
    keys = np.repeat(np.arange(matrix.height, dtype=np.int64), np.diff(pattern.indptr)) * width + pattern.indices
    places = np.searchsorted(keys, other.row * width + other.col)
    np.add.at(matrix.AsVector().FV().NumPy(), places, other.data)


def mass_matrix(W):
    """∫ψ_i ψ_j over the cracks, scipy CSR."""
    lam, mu = W.TnT()
    return to_scipy(BilinearForm(lam * mu * W.dcrack).Assemble().mat)


def redundant_functions(body, order, nodes, tolerance=1e-7):
    """Which traces of mesh functions depend on others: the two steps of section 4 of [AHLMR12].

    First a Gram-Schmidt elimination among functions that overlap, then a Lanczos search for what is left of the kernel
    of the mass matrix, one function (that of the largest component) for each kernel vector.
    """
    mass = mass_matrix(core.TraceSpace(body, core.MeshTraceBasis(body, order, nodes, set()), order))
    diagonal = mass.diagonal()
    traced = np.flatnonzero(diagonal > 1e-14 * diagonal.max())
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1))
    mass = (mass.multiply(scale).T.multiply(scale)).tocsr()
    kept = []
    for i in traced:
        overlapping = np.intersect1d(mass[i].indices, kept)
        block = mass[overlapping][:, overlapping].toarray()
        coupling = mass[overlapping][:, [i]].toarray().ravel()
        projection = np.linalg.lstsq(block, coupling, rcond=tolerance)[0] if len(overlapping) else np.zeros(0)
        if 1 - coupling @ projection > tolerance:
            kept.append(i)
    while True:
        value, vector = smallest_eigenpair(mass[kept][:, kept])
        if value > tolerance:
            return set(range(mass.shape[0])) - set(kept)
        kept.pop(int(np.argmax(np.abs(vector))))


def smallest_eigenpair(matrix):
    """Of a symmetric positive semi-definite scipy matrix with unit diagonal: Lanczos on the shifted matrix."""
    if matrix.shape[0] < 20:
        values, vectors = np.linalg.eigh(matrix.toarray())
        return values[0], vectors[:, 0]
    values, vectors = eigsh(matrix, k=1, sigma=-1e-8, v0=np.ones(matrix.shape[0]))
    return values[0], vectors[:, 0]
