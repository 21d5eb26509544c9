"""The constants behind γ, element by element, and the element matrices that they are made of."""

from collections import Counter

import numpy as np
import pytest
from helpers import rectangle
from ngsolve import BilinearForm, CoefficientFunction, ElementId, InnerProduct, SetNumThreads, TaskManager

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace
from ngsxfem_contact import _ngsxfem_contact as core
from ngsxfem_contact.algebra.matrices import assembled, to_scipy
from ngsxfem_contact.contact.stabilisation import BarbosaHughes, tip_weight, trace_constants
from ngsxfem_contact.loads.face_traction import ComparedTraction
from ngsxfem_contact.operators import NORMAL, TANGENTIAL, NormalGap, Strain

MATERIAL = Elasticity.PlaneStrain(E=7, nu=0.3)
CRACKS = {"one": [Crack([(0, 0.5), (0.5, 0.52)])], "two in one element": [Crack([(0.2, 0.5), (0.7, 0.51)]), Crack([(0.3, 0.57), (0.6, 0.56)])]}


def space(cracks, order, functions):
    body = CrackedMesh(rectangle(0.1), *CRACKS[cracks])
    return CrackFESpace(body, order=order, tip=TipEnrichment(r1=0.05, material=MATERIAL, functions=functions), dirichlet="bottom")


def one_ratio(V, element, trace, energy):
    """The largest eigenvalue of one element's matrices, the functions without energy left out, then the kernel."""
    ei = ElementId(element)
    R, A = (np.array(form.integrators[0].CalcElementMatrix(V.GetFE(ei), V.mesh.GetTrafo(ei))) for form in (trace, energy))
    diagonal, dofs = A.diagonal(), np.array(V.GetDofNrs(ei))
    kind = sum((tip + 1) * np.isin(dofs, V.TipDofs(tip)) for tip in range(len(V.body.tips)))
    used = diagonal > 1e-28 * np.array([diagonal[kind == k].max() for k in kind])
    scale = 1 / np.sqrt(diagonal[used])
    R, A = (M[np.ix_(used, used)] * scale[:, None] * scale for M in (R, A))
    values, vectors = np.linalg.eigh(A)
    regular = values > 1e-10 * values[-1]
    basis = vectors[:, regular] / np.sqrt(values[regular])
    return np.linalg.eigvalsh(basis.T @ R @ basis)[-1]


def one_by_one(V, components):
    """C_T for each element of each crack."""
    u, v = V.TnT()
    body = V.body
    traces = tip_weight(V) * ComparedTraction(body, MATERIAL, BarbosaHughes.sides).Squared(u, v, components)
    sharing = Counter(T.element for crack in range(len(body.cracks)) for T in body.Elements(crack))
    constants = []
    for crack in range(len(body.cracks)):
        energy = BilinearForm(V)
        energy += core.StressPower(V, CoefficientFunction(MATERIAL.lam), CoefficientFunction(MATERIAL.mu), body.dlarger(crack=crack))
        trace = BilinearForm(traces * body.dcrack(crack=crack))
        constants += [sharing[T.element] * T.h * one_ratio(V, T.element, trace, energy) for T in body.Elements(crack)]
    return constants


@pytest.mark.parametrize("components", [(NORMAL,), (NORMAL, TANGENTIAL)])
@pytest.mark.parametrize("functions", ["modes", "branch"])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cracks", CRACKS)
def test_all_at_once_are_those_one_by_one(cracks, order, functions, components):
    V = space(cracks, order, functions)
    assert any(len(V.body.CracksOf(T.element)) > 1 for T in V.body.Elements(0)) == (cracks != "one")
    rel = 1e-12 if functions == "modes" else 1e-11  # the eight functions (8) of a tip are nearly dependent on an element: round-off is amplified
    assert trace_constants(V, MATERIAL, components) == pytest.approx(one_by_one(V, components), rel=rel)


def test_they_are_computed_once_for_a_material():
    V = space("one", 1, "modes")
    assert trace_constants(V, MATERIAL) is trace_constants(V, Elasticity.PlaneStrain(E=7, nu=0.3))
    before = trace_constants(V, MATERIAL)
    V.SetTipMaterial(0, 2.5, 1.0)
    assert trace_constants(V, MATERIAL) is not before


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("functions", ["modes", "branch"])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_stress_power_is_that_of_the_symbolic_form(order, functions, threads):
    V = space("two in one element", order, functions)
    u, v = V.TnT()
    symbolic = BilinearForm(InnerProduct(MATERIAL.Stress(Strain(u)), Strain(v)) * V.body.dx)
    form = core.CrackBilinearForm(V)
    form += core.StressPower(V, CoefficientFunction(MATERIAL.lam), CoefficientFunction(MATERIAL.mu), V.body.dx)
    SetNumThreads(threads)
    with TaskManager():
        A, B = (to_scipy(one.Assemble().mat) for one in (form, symbolic))
    SetNumThreads(1)
    scale = 1 / np.sqrt(B.diagonal())
    assert np.abs((A - B).multiply(scale[:, None]).multiply(scale)).max() < 1e-13


def test_a_stress_power_keeps_to_its_elements_and_regions():
    V = space("one", 2, "modes")
    u, v = V.TnT()
    measure = V.body.dx("default", definedonelements=V.body.CrackElements(None), bonus_intorder=2)
    symbolic = BilinearForm(InnerProduct(MATERIAL.Stress(Strain(u)), Strain(v)) * measure)
    form = BilinearForm(V)
    form += core.StressPower(V, CoefficientFunction(MATERIAL.lam), CoefficientFunction(MATERIAL.mu), measure)
    A, B = (to_scipy(one.Assemble().mat) for one in (form, symbolic))
    assert abs(A - B).max() < 1e-13 * abs(B).max()


def test_matrices_of_some_elements_make_the_matrix():
    V = space("two in one element", 2, "modes")
    W = TraceSpace(V.body, order=1)
    form = BilinearForm(trialspace=V, testspace=W)
    form += W.TestFunction() * NormalGap(V.TrialFunction(), V.body) * W.dcrack
    whole = to_scipy(form.Assemble().mat)
    elements = [i for i, bit in enumerate(V.body.CrackElements(None)) if bit]
    assert abs(assembled(form, elements) - whole).max() < 1e-15 * abs(whole).max()
    assert assembled(form, elements[:3]).nnz < whole.nnz
