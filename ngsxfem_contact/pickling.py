"""What pickle has to know of NGSolve's functions, whose own pickling lacks some and gives others back wrong.

NGSolve pickles a function node by node, so that the nodes named here are saved in whatever function they are:

- trial and test functions, which NGSolve does not save: of a space, with the name of an operator;
- operators of GridFunctions, such as Grad(u) and Jump(u), which NGSolve reads back as others: asked again of the GridFunction;
- GridFunctions, whose coefficients NGSolve numbers in another way after a refined mesh was read: they are saved in the order of `numbering`;
- meshes that were refined and then curved, which NGSolve reads back straight;
- the normal and tangential vectors, the mesh size and the Jacobian matrices on boundaries of `specialcf`.
"""

from __future__ import annotations

import copyreg
import pickle
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CoefficientFunction, GridFunction, Mesh, comp, specialcf
from ngsolve.fem import PointEvaluationFunctional

from . import _ngsxfem_contact as core

if TYPE_CHECKING:
    from ngsolve import FESpace


def numbering(space: FESpace) -> np.ndarray:
    """The unknowns of a space in the order in which its elements name them: the same for a mesh and for what is read of it again.

    The numbers themselves are not: a refined mesh keeps the edges of the coarse one, what is read has those of the fine one only.
    """
    return core.ElementOrder(space)


def numbers_of(space: FESpace, *dofs: np.ndarray) -> list[np.ndarray]:
    """Where unknowns, some arrays of them, are in the order of `numbering`."""
    order, place = numbering(space), np.full(space.ndof, -1)
    place[order] = np.arange(len(order))
    return [place[some] for some in dofs]


def dofs_of(space: FESpace, *numbers: np.ndarray) -> list[np.ndarray]:
    """The unknowns at places in the order of `numbering`."""
    order = numbering(space)
    return [order[some] for some in numbers]


class Unnumbered(ValueError):
    """What was read has other unknowns than what was saved."""


def packed(space: FESpace, array: np.ndarray) -> np.ndarray:
    """The values of an array for all unknowns of a space, in the order of `numbering`."""
    return array[numbering(space)]


def unpacked(space: FESpace, values: np.ndarray) -> np.ndarray:
    """An array for all unknowns of a space of the values in the order of `numbering`. Raises Unnumbered for another number of them."""
    order = numbering(space)
    if len(order) != len(values):
        raise Unnumbered(f"the space that was made again has {len(order)} unknowns, {len(values)} were saved")
    array = np.zeros(space.ndof)
    array[order] = values
    return array


def curved_mesh(state: Any, order: int) -> Mesh:
    """The mesh of NGSolve's state, curved again."""
    mesh = Mesh.__new__(Mesh)
    mesh.__setstate__(state)
    mesh.Curve(order)
    return mesh


def reduce_mesh(mesh: Mesh) -> Any:
    """NGSolve's own way; of a refined plane mesh with the order of its curved elements."""
    create, arguments, state, *_ = mesh.__reduce_ex__(2)
    if mesh.dim != 2 or mesh.levels == 1 or mesh.GetCurveOrder() == 1:
        return create, arguments, state
    return curved_mesh, (state, mesh.GetCurveOrder())


def gridfunction_of(space: FESpace, name: str, values: np.ndarray) -> GridFunction:
    """A GridFunction with values in the order of `numbering`."""
    function = GridFunction(space, name)
    function.vec.FV().NumPy()[:] = unpacked(space, values)
    return function


def reduce_gridfunction(function: GridFunction) -> Any:
    """NGSolve's own way; on a refined mesh the space, the name, and the values. Raises PicklingError there unless all unknowns are real and belong to elements."""
    space = function.space
    if space.mesh.levels == 1:
        return function.__reduce_ex__(2)
    if isinstance(function, comp.ComponentGridFunction) or space.is_complex or len(function.vecs) > 1:
        raise pickle.PicklingError(
            "components of GridFunctions, complex ones and those with many vectors are not saved on a refined mesh; take a real one of its own"
        )
    order, values = numbering(space), function.vec.FV().NumPy()
    if np.count_nonzero(values[order]) != np.count_nonzero(values):
        raise pickle.PicklingError(
            "a GridFunction on a refined mesh has unknowns that belong to no element, which cannot be saved; interpolate it by one of H1 or L2"
        )
    return gridfunction_of, (space, function.name, values[order].copy())


def operator_of(function: Any, name: str) -> CoefficientFunction:
    """An operator of a GridFunction, a trial or a test function."""
    return function.Deriv() if name == "deriv" else function.Operator(name)


def reduce_operator(function: comp.GridFunctionCoefficientFunction) -> Any:
    """Its GridFunction, and the name of the operator; raises PicklingError where NGSolve does not know them."""
    u, name = core.GridFunctionOf(function), core.OperatorOf(function)
    if u is None or name is None:
        raise pickle.PicklingError("an operator of a GridFunction has no name, so that NGSolve cannot save it; interpolate it by a GridFunction of its own")
    return operator_of, (u, name)


def proxy_of(space: FESpace, is_test: bool, name: str) -> CoefficientFunction:
    """A trial or test function with an operator."""
    proxy = space.TestFunction() if is_test else space.TrialFunction()
    for candidate in (proxy, proxy.Deriv()):
        if core.OperatorName(candidate) == name:
            return candidate
    return proxy.Operator(name)


def reduce_proxy(proxy: comp.ProxyFunction) -> Any:
    """Its space, and the name of its operator."""
    return proxy_of, (proxy.space, core.IsTestFunction(proxy), core.OperatorName(proxy))


def special(name: str, dimension: int) -> CoefficientFunction:
    """A function of NGSolve's specialcf in the plane, or in space."""
    function = getattr(specialcf, name)
    if name == "JacobianMatrix":
        return function(dimension, dimension - 1)
    return function if isinstance(function, CoefficientFunction) else function(dimension)


SPECIAL = {
    (core.NameOf(special(name, dim)), special(name, dim).dim): (special, (name, dim))
    for name in ("normal", "tangential", "mesh_size", "JacobianMatrix")
    for dim in (3, 2)
}


def reduce_function(function: CoefficientFunction) -> Any:
    """As NGSolve, but for the functions of `specialcf`."""
    return SPECIAL.get((core.NameOf(function), function.dim)) or function.__reduce_ex__(2)


def functional_of(function: Any, point: tuple[float, ...]) -> PointEvaluationFunctional:
    """The value of a form's function in a point."""
    return function(*point)


def reduce_functional(functional: PointEvaluationFunctional) -> Any:
    """Its function and its point."""
    return functional_of, (core.FunctionOf(functional), core.PointOf(functional))


copyreg.pickle(CoefficientFunction, reduce_function)
copyreg.pickle(Mesh, reduce_mesh)
for kind in (GridFunction, comp.GridFunctionD, comp.GridFunctionC, comp.ComponentGridFunction):  # D and C: out of functions that they are part of
    copyreg.pickle(kind, reduce_gridfunction)
copyreg.pickle(comp.GridFunctionCoefficientFunction, reduce_operator)
copyreg.pickle(comp.ProxyFunction, reduce_proxy)
copyreg.pickle(PointEvaluationFunctional, reduce_functional)
