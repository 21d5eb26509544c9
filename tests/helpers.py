"""Small meshes, brute-force geometry and linear algebra that the tests share."""

from contextlib import contextmanager

import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import CF, BilinearForm, GridFunction, LinearForm, Mesh, SetNumThreads, TaskManager
from ngsolve.meshes import MakeStructured2DMesh
from pyngcore import GetNumThreads
from scipy.sparse import csr_matrix

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.exact import closed_forms as cf


@contextmanager
def threads(number=2):
    """NGSolve works with so many threads while the block runs, whatever the machine has; else the tests run with one."""
    SetNumThreads(number)
    try:
        with TaskManager():
            assert GetNumThreads() == number
            yield
    finally:
        SetNumThreads(1)


def rectangle(maxh, lower=(0, 0), upper=(1, 1)):
    geometry = SplineGeometry()
    geometry.AddRectangle(lower, upper, bcs=["bottom", "right", "top", "left"])
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def structured(n):
    """n × n squares of the unit square, each divided by the diagonal from upper left to lower right."""
    return MakeStructured2DMesh(quads=False, nx=n, ny=n)


def array(vector):
    return vector.FV().NumPy().copy()


def matrix(form, *spaces):
    """The assembled matrix as a scipy matrix."""
    return to_scipy(BilinearForm(form, *spaces).Assemble().mat)


def to_scipy(mat):
    values, columns, rows = (np.array(part) for part in mat.CSR())
    return csr_matrix((values, columns, rows), shape=(mat.height, mat.width))


def vector(form):
    return array(LinearForm(form).Assemble().vec)


def random_function(space, seed=0):
    function = GridFunction(space)
    function.vec.FV().NumPy()[:] = np.random.default_rng(seed).uniform(-1, 1, space.ndof)
    return function


def basis_function(space, dof):
    function = GridFunction(space)
    function.vec[dof] = 1
    return function


def vertices(mesh, element):
    from ngsolve import VOL, ElementId

    return np.array([mesh[v].point for v in mesh[ElementId(VOL, element)].vertices])


def clip(polygon, point, normal):
    """The part of a convex polygon where (x - point)·normal ≥ 0."""
    polygon, result = [np.asarray(p, float) for p in polygon], []
    d = [float(np.dot(p - point, normal)) for p in polygon]
    for i in range(len(polygon)):
        j = (i + 1) % len(polygon)
        if d[i] >= 0:
            result.append(polygon[i])
        if d[i] * d[j] < 0:
            result.append(polygon[i] + d[i] / (d[i] - d[j]) * (polygon[j] - polygon[i]))
    return result


def moment(polygon, a=0, b=0):
    """∫ x^a y^b over a polygon, counter-clockwise, by Green's theorem: exact up to round-off."""
    nodes, weights = np.polynomial.legendre.leggauss(a + b + 2)
    total = 0.0
    for i in range(len(polygon)):
        p, q = np.asarray(polygon[i]), np.asarray(polygon[(i + 1) % len(polygon)])
        points = p + 0.5 * (1 + nodes[:, None]) * (q - p)
        total += 0.5 * (q - p)[1] * (weights @ (points[:, 0] ** (a + 1) * points[:, 1] ** b)) / (a + 1)
    return total


def left_normal(p, q):
    t = np.subtract(q, p) / np.hypot(*np.subtract(q, p))
    return np.array([-t[1], t[0]])


def on_crack(body, s, crack=0):
    """Points of the mesh on a crack, for GridFunctions and their operators."""
    from ngsxfem_contact.points import crack_points

    return crack_points(body, crack, s)


MATERIAL = Elasticity(lam=1, mu=1)
OFFSET = (0.03, -0.02)  # of the rotated square


def rotated_problem(exact, orders, maxh, angle=0.41, tip=None, through=False, **options):
    """Exact displacement on the boundary of a rotated square, crack from a mouth to the origin or through the body."""
    start, end = cf.mouths(angle, OFFSET)
    body = CrackedMesh(cf.rotated_square(angle, OFFSET, maxh), cf.crack_on_axis(start, end if through else 0))
    V = CrackFESpace(body, order=orders.order, bubble=orders.bubble, tip=tip, dirichlet="outer")
    problem = ContactProblem(V, TraceSpace(body, order=orders.multiplier_order), MATERIAL, **options)
    problem.SetDirichlet(exact.u, "outer")
    return problem


def pull(problem, upper, stress=1.0):
    """σ_yy = stress at the top and the bottom of a rectangle that is symmetric to y = 0, with its upper right corner."""
    v = problem.V.TestFunction()
    problem.f += CF((0, stress)) * v * problem.body.ds("top") + CF((0, -stress)) * v * problem.body.ds("bottom")
    problem.Pin((upper[0], -upper[1]), "xy")
    problem.Pin(upper, "x")
    return problem


def side_areas(body, place, crack=0):
    """(plus, minus): the areas of an element on either side of a crack that meets it, beside a tip also of its straight extension."""
    facets = [facet for facet in body.Facets(place.element) if facet.crack == crack]
    plus, minus = ({getattr(facet, side) for facet in facets} for side in ("plus", "minus"))
    areas = {1: 0.0, -1: 0.0}
    for part in body.Parts(place.element):
        here = int(body.cracks[crack].SideOf(tuple(np.mean(part.triangle, axis=0)))) if part.part in plus & minus else 1 if part.part in plus else -1
        areas[here] += part.area
    return areas[1], areas[-1]
