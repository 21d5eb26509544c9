"""What several processes do: `mpirun -n 3 python tests/mpi/cases.py NAME` runs the case of that name and prints "passed" on each of them."""

import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from mpi4py import MPI
from netgen.csg import unit_cube
from netgen.geom2d import SplineGeometry, unit_square
from netgen.occ import Circle, OCCGeometry
from netgen.occ import Sphere as OccSphere
from ngsolve import CF, H1, GridFunction, IfPos, Integrate, Interpolate, Mesh, ds, dx, sqrt, x, y, z

from ngsxfem_contact import BarbosaHughes, ContactProblem, ContactSolution, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.algebra.multigrid import is_available
from ngsxfem_contact.algebra.substructuring import check_memory
from ngsxfem_contact.contact import ConditionNumber, CrackScaling, strategy
from ngsxfem_contact.contact.carried import written
from ngsxfem_contact.errors import NotCoercive, NotSaved, SingularSystem
from ngsxfem_contact.estimate import SolveAdaptive
from ngsxfem_contact.files import UnreadableFile
from ngsxfem_contact.plotting import plot_body, plot_mesh
from ngsxfem_contact.plotting.picture import Picture
from ngsxfem_contact.plotting.plots import animate, split_displacement
from ngsxfem_contact.processes import DistributedMesh, alone, together
from ngsxfem_contact.sheets import Sheet
from ngsxfem_contact.spaces import FrontEnrichment
from ngsxfem_contact.spaces.exchange import exchange_of

COMM = MPI.COMM_WORLD
STEEL = Elasticity.PlaneStrain(E=210e3, nu=0.3)
INCLINED, THROUGH = Crack([(0.3, 0.45), (0.7, 0.55)]), Crack([(0, 0.5), (1, 0.52)])


def square(maxh=0.15):
    return unit_square.GenerateMesh(maxh=maxh)


def disk(maxh=0.3):
    geometry = SplineGeometry()
    geometry.AddCircle((0, 0), 1)
    return geometry.GenerateMesh(maxh=maxh)


def disk_of_occ():
    return OCCGeometry(Circle((0, 0), 1).Face(), dim=2).GenerateMesh(maxh=0.3)


def refused(action, kind, *words):
    """Whether action() is refused with the same words on all processes; none of them waits for another one."""
    message = None
    try:
        action()
    except kind as error:
        message = str(error)
    messages = COMM.allgather(message)
    assert all(message is not None and all(word in message for word in words) for message in messages), messages
    return messages


def distributed_mesh():
    """All elements are there, once."""
    mesh = DistributedMesh(square)
    assert COMM.allreduce(mesh.ne) == COMM.bcast(Mesh(square()).ne if COMM.rank == 0 else None)
    assert abs(COMM.allreduce(Integrate(CF(1) * dx, mesh)) - 1) < 1e-14
    assert mesh.comm.size == COMM.size


def errors_are_raised_on_all():
    """Whichever process fails, and where make() does."""
    assert together(COMM, lambda: COMM.rank) == COMM.rank
    for failing in range(COMM.size):
        messages = refused(lambda failing=failing: together(COMM, lambda: 1 / (COMM.rank - failing)), ZeroDivisionError, "division by zero")
        assert [message.startswith("process") for message in messages] == [rank != failing for rank in range(COMM.size)]

    def wrong():
        raise KeyError("no mesh today")

    refused(lambda: DistributedMesh(wrong), KeyError, "no mesh today")
    refused(lambda: DistributedMesh(lambda: 3), TypeError, "not a mesh of Netgen")


def a_mesh_of_each_process_is_refused():
    """It would solve everything several times."""
    if COMM.size > 1:
        refused(lambda: CrackedMesh(Mesh(square()), INCLINED), NotImplementedError, f"one of {COMM.size} processes", "DistributedMesh")


def problem(crack=INCLINED, make=square, material=STEEL, load=(0, 1), **options):
    body = CrackedMesh(DistributedMesh(make), crack)
    V = CrackFESpace(body, order=2, material=material, dirichlet=options.pop("dirichlet", "bottom"), tip=None)
    problem = ContactProblem(V, TraceSpace(body), **options)
    problem.f += CF(load) * V.TestFunction() * body.ds("top")
    return problem


def what_is_not_supported_is_refused():
    """In words, the same on all processes, before any work."""
    if COMM.size == 1:
        return
    words = "not supported by several processes"
    solution = problem().Solve()
    for action in (
        lambda: TraceSpace(solution.body, order=2, basis="trace"),
        lambda: problem().Solve(inverse="sparsecholesky"),
        lambda: ConditionNumber(solution.problem),
        lambda: CrackScaling(solution.problem.Assemble().stiffness, solution.problem.V),
        lambda: SolveAdaptive(lambda mesh: problem(), DistributedMesh(square)),
        lambda: animate([solution], "body.gif", ["body"]),
    ):
        refused(action, NotImplementedError, words)
    refused(solution.ErrorEstimate, NotImplementedError, words, "solution.Save(path)", "loads the file")
    refused(lambda: CrackedMesh(solution.body.mesh, INCLINED), NotImplementedError, "DistributedMesh")


def what_cannot_be_saved_or_read_is_refused_on_all():
    """Also where the first process alone sees it; files stay as they were, and nothing is left beside them."""
    folder = COMM.bcast(tempfile.mkdtemp() if COMM.rank == 0 else None)
    path = Path(folder) / "body.solution"
    solution = problem(gap=1e-3).Solve()
    refused(lambda: solution.Save(Path(folder) / "none" / "body"), FileNotFoundError, "no folder")
    refused(lambda: ContactSolution.Load(path), FileNotFoundError, "body.solution")
    solution.Save(path)
    content = path.read_bytes()
    COMM.barrier()
    other = problem()
    other.f += 0.01 * Interpolate(x * y, H1(other.body.mesh, order=1)) * other.V.TestFunction()[0] * other.body.dx
    refused(lambda: other.Solve().Save(path), NotSaved, "cannot be saved", "interpolated by a GridFunction")
    if COMM.size > 1:
        other = problem()
        far = GridFunction(H1(other.body.share.source, order=1))
        refused(lambda: setattr(other, "gap", far) or written(other.Solve()), NotSaved, "another mesh")
    assert path.read_bytes() == content and [other.name for other in Path(folder).iterdir()] == [path.name]
    COMM.barrier()
    if COMM.rank == 0:
        path.write_bytes(content[:-100])
    COMM.barrier()
    refused(lambda: ContactSolution.Load(path), UnreadableFile, "not complete")
    read = ContactSolution.Load(saved_traces(folder)) if COMM.size == 1 else None
    if COMM.size > 1:
        refused(lambda: ContactSolution.Load(saved_traces(folder)), NotImplementedError, "basis='trace'")
    assert read is None or read.problem.W.order == 2


def saved_traces(folder):
    """The file of one process, with multipliers that are numbered by edges."""
    path = Path(folder) / "traces"
    if COMM.rank == 0:
        with alone():
            body = CrackedMesh(Mesh(square()), INCLINED)
            V = CrackFESpace(body, order=2, material=STEEL, dirichlet="bottom")
            ContactProblem(V, TraceSpace(body, order=2, basis="trace")).Solve().Save(path)
    COMM.barrier()
    return path


def what_is_not_supported_in_space_is_refused():
    """In the same way."""
    if COMM.size == 1:
        return
    words = "not supported by several processes"
    make = lambda: unit_cube.GenerateMesh(maxh=0.3)
    sheet = Sheet.Polygon([(-1, -1, 0.47), (0.5, -1, 0.53), (0.5, 2, 0.53), (-1, 2, 0.47)])
    body = CrackedMesh(DistributedMesh(make), sheet)
    V = CrackFESpace(body, material=Elasticity.Solid(E=210e3, nu=0.3), dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body, order=0))
    problem.f += CF((0, 0, 1)) * V.TestFunction() * body.ds("top")
    solution = problem.Solve()
    of_round = DistributedMesh(lambda: OCCGeometry(OccSphere((0, 0, 0), 1)).GenerateMesh(maxh=0.7))
    of_round.Curve(2)
    for action in (
        lambda: CrackFESpace(body, front=FrontEnrichment(radius=2.0)),
        lambda: problem.Solve(inverse="cg"),
        lambda: solution.StressIntensity(radius=3.0),
        lambda: solution.Save("body.solution"),
        lambda: solution.Draw(),
        lambda: plot_body(solution),
        lambda: CrackedMesh(of_round, Sheet.Disk((0, 0, 0), (0, 0, 1), 0.5)),
    ):
        refused(action, NotImplementedError, words)
    refused(lambda: CrackedMesh(DistributedMesh(make), Sheet.Disk((3, 3, 3), (0, 0, 1), 0.5)), Exception, "lies outside of the body")
    points = np.unique(np.concatenate(COMM.allgather(body.mesh.ngmesh.Coordinates())), axis=0)
    assert body.share.AtPoints(points, CF((x, y, z))) == pytest.approx(points, abs=1e-14)


def curved_elements():
    """Of both kinds of geometry: they have the area and the boundary of the whole mesh."""
    for make in (disk, lambda: disk(0.15), disk_of_occ):
        mesh, whole = DistributedMesh(make), Mesh(make())
        for each in (mesh, whole):
            each.Curve(3)
        body = CrackedMesh(mesh, Crack([(-1, 0.1), (0.3, 0)]))
        area, length = (Integrate(CF(1) * measure, whole) for measure in (dx, ds))
        assert COMM.allreduce(Integrate(body.share.Own(CF(1) * body.dx), body.mesh)) / (1 if body.share.several else COMM.size) == pytest.approx(
            area, rel=1e-13
        )
        assert Integrate(CF(1) * body.ds, body.mesh) == pytest.approx(length, rel=1e-7) and body.mesh.GetCurveOrder() == 3  # another rule along ∂Ω


def point_loads():
    """A point is that of one process, also between processes; outside of the body none is."""
    solved = problem()
    vertices = np.unique(np.concatenate(COMM.allgather(solved.body.mesh.ngmesh.Coordinates()[:, :2])), axis=0)
    share, points = solved.body.share, np.concatenate([vertices, 0.5 * (vertices + 0.3 * vertices[::-1] + 0.35)])
    assert (np.sum(COMM.allgather(share.Has(points).astype(int)), axis=0) == 1).all()
    assert share.AtPoints(points, CF((x, y))) == pytest.approx(points, abs=1e-14)
    refused(lambda: solved.f.__iadd__(solved.V.TestFunction()[1](1.5, 0.5)), ValueError, "problem.f: the point of a load (1.5, 0.5) lies outside of the body")


def what_is_counted_twice_is_found():
    """Processes that do not agree on what they share are stopped, whatever the order: before anything is solved."""
    body = CrackedMesh(DistributedMesh(lambda: square(0.06)), INCLINED)
    for order in (1, 2, 3):
        V = CrackFESpace(body, order=order, material=STEEL, bubble=order == 1)
        assert exchange_of(V).Count(V.ndof) > 0
    if COMM.size > 2:
        body.share.interface[:] = False
        V = CrackFESpace(body, order=2, material=STEEL)
        refused(lambda: exchange_of(V), RuntimeError, "functions φ_i", "do not agree")


def pictures_are_drawn_by_the_first():
    """With all that belongs to the body, once; others draw nothing."""
    matplotlib.use("Agg")
    solution, folder = problem().Solve(), tempfile.mkdtemp()
    split, u = split_displacement(solution)
    picture = Picture(split, solution.body.share)
    of_mesh = plot_mesh(solution.problem.V)
    assert (of_mesh is not None) == (COMM.rank == 0)
    if of_mesh is not None:
        marked = next(line for line in of_mesh.get_lines() if line.get_label() == "Heaviside function")
        mesh = Mesh(square())
        whole = CrackFESpace(CrackedMesh(mesh, INCLINED), order=2, material=STEEL, dirichlet="bottom", tip=None) if COMM.size == 1 else None
        assert whole is None or len(marked.get_xdata()) == len([dof for dof in range(whole.num_heaviside) if whole.Heaviside(dof)[0] < mesh.nv])
        distance = [INCLINED.Distance(tuple(point)) for point in marked.get_xydata()]
        assert len(distance) > 0 and max(distance) < 0.25
        assert sum(len(line.get_xdata()) for line in of_mesh.get_lines() if line.get_color() == "0.7" and line.get_linestyle() == "-") > 3 * mesh.ne
    ax, drawn = plot_body(solution), solution.Draw(filename=f"{folder}/body.html", show=False)
    assert [figure is not None for figure in (ax, drawn)] == [COMM.rank == 0] * 2
    if COMM.rank == 0:
        area = Integrate(CF(1), picture.mesh)
        length = {name: Integrate(CF(1), picture.mesh, definedon=picture.mesh.Boundaries(name)) for name in set(picture.mesh.GetBoundaries())}
        crack = INCLINED.length
        assert area == pytest.approx(1, abs=1e-13) and length == pytest.approx({"left": 1, "right": 1, "top": 1, "bottom": 1, "crack": 2 * crack}, abs=1e-12)
        assert {line.get_label(): len(line.get_xdata()) for line in ax.get_lines()}.keys() == {"plus lip", "minus lip"}
        assert picture.points.shape == picture.Whole(u).shape if COMM.size == 1 else len(picture.points) > 0
    refused(lambda: plot_body(solution, scale=float("inf")), ValueError, "scale=inf must be finite")


def conjugate_gradients_are_chosen():
    """Where there is too much between processes for a dense matrix; not for rubber."""
    assert problem().Solve().report.choice == ""
    strategy.MOST_BETWEEN = 10
    report = problem().Solve().report
    between = COMM.size > 2 and is_available()
    assert (report.inverse == "cg") == ("unknowns between processes" in report.choice) == ("conjugate gradients" in str(report)) == between
    assert (problem(material=Elasticity.PlaneStrain(E=1, nu=0.4999)).Solve().report.inverse == "substructuring") == (COMM.size > 1)


def what_is_wrong_is_refused_on_all():
    """Also where one process alone sees it."""
    refused(lambda: problem(THROUGH, dirichlet="bottom|top").Pin((0.123, 0.5), "x"), ValueError, "no mesh vertex")
    refused(lambda: problem(Crack([(0.2, 0.5), (2, 3), (0.4, 0.5)])), Exception, "leaves the body")
    refused(lambda: problem(stabilisation=BarbosaHughes(gamma0=1)).Solve(), NotCoercive, "γ is too large")
    refused(lambda: problem(dirichlet="").Solve(), SingularSystem, "3 rigid motion(s)")
    nowhere = IfPos((x - 0.85) ** 2 + (y - 1) ** 2 - 0.01, 0, sqrt(-1 - x))
    refused(lambda: problem(load=(0, nowhere)).Solve(), ValueError, "the load `f` is not finite")
    refused(lambda: check_memory(10**7), MemoryError, "2400000 GB on each process", "take fewer processes")
    check_memory(100)


def what_differs_is_refused_on_all():
    """Processes that are given something else than the others would wait for them for ever."""
    if COMM.size == 1:
        return
    last = COMM.rank == COMM.size - 1
    not_a_number = float("nan") if last else 1e-3
    refused(lambda: problem(THROUGH if last else INCLINED), ValueError, "different cracks")
    refused(lambda: problem().Pin((1, 1) if last else (0, 1), "x"), ValueError, "pin different points")
    refused(lambda: problem(load=(0, not_a_number)).Solve(), ValueError, "the load `f` is not finite")
    refused(lambda: problem(gap=CF(not_a_number)).Solve(), ValueError, "gap is not finite")
    held = problem(dirichlet="bottom|top", load=(0, 0))
    refused(lambda: held.SetDirichlet((0, not_a_number), "top"), ValueError, "not finite", "top")
    refused(lambda: held.SetDirichlet((0, 0), "nowhere" if last else "top"), ValueError, "matches no boundary")
    assert held.Solve().Energy() == 0


def processes_without_elements():
    """More of them than elements beside the crack, and than elements."""
    for maxh, count in ((0.5, 1), (2, 0)):
        body = CrackedMesh(DistributedMesh(lambda: square(maxh)), THROUGH)
        V = CrackFESpace(body, order=2, material=STEEL, dirichlet="bottom|top")
        pressed = ContactProblem(V, TraceSpace(body))
        pressed.SetDirichlet((0, -1e-3), "top")
        solution = pressed.Solve()
        assert solution.ContactForce() == pytest.approx(-210e3 / (1 - 0.3**2) * 1e-3, rel=0.1 if count else 0.2)


def an_error_of_one_process_ends_all():
    """Run by a test of its own: the others wait for it."""
    solved = problem()
    if COMM.rank == COMM.size - 1:
        raise RuntimeError("of one process")
    solved.Solve()


CASES = [
    distributed_mesh,
    errors_are_raised_on_all,
    a_mesh_of_each_process_is_refused,
    what_is_not_supported_is_refused,
    what_is_not_supported_in_space_is_refused,
    conjugate_gradients_are_chosen,
    what_is_wrong_is_refused_on_all,
    what_cannot_be_saved_or_read_is_refused_on_all,
    what_differs_is_refused_on_all,
    processes_without_elements,
    curved_elements,
    point_loads,
    what_is_counted_twice_is_found,
    pictures_are_drawn_by_the_first,
]

if __name__ == "__main__":
    globals()[sys.argv[1]]()
    sys.stdout.write("passed\n")  # in one piece: lines of several processes do not mix
