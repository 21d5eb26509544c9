"""solution.Save and ContactSolution.Load: what was solved goes on in another process as it would have here."""

import json
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from ngsolve import CF, H1, Grad, GridFunction, Sym, VectorH1, specialcf, x, y
from saved_cases import CASES, MATERIAL, Case, factors, numbers, pull, refined, same, solved, square

from ngsxfem_contact import ContactProblem, ContactSolution, Coulomb, Crack, CrackedMesh, CrackFESpace, CrackGrowth, GivenIncrement, Jump, LoadSteps, TraceSpace
from ngsxfem_contact.contact import LinearCohesive, PathSteps
from ngsxfem_contact.plotting import plot_body

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")


@pytest.fixture
def path(tmp_path):
    return tmp_path / "step.solution"


@pytest.mark.parametrize("name", CASES)
def test_what_is_read_is_what_was_saved_and_goes_on(name, path):
    case = CASES[name]
    V, W = case.Spaces()
    solution = case.Problem(V, W, 6).Solve()
    expected, K = numbers(solution), factors(solution, name)
    assert solution.Save(path) == path and [p.name for p in path.parent.iterdir()] == [path.name]
    read = ContactSolution.Load(path)
    assert read.body is read.problem.V.body is read.problem.W.body is not solution.body and read.u.space is read.problem.V
    same(numbers(read), expected), same(factors(read, name), K, 1e-13)
    assert str(read.report) == str(solution.report)
    read.CheckLoad()
    here = case.Problem(V, W, -2).Solve(previous=solution)
    there = case.Problem(read.problem.V, read.problem.W, -2).Solve(previous=read)
    tolerance = 1e-12 if name.startswith("refined") else 1e-14  # other numbers, other round-off of the factorisation
    same(numbers(there), numbers(here), tolerance)
    same(numbers(read.problem.Solve(previous=read)), numbers(solution.problem.Solve(previous=solution)), tolerance)


def test_a_solution_is_read_in_another_process(path):
    """Friction's history and that of a cohesive law; the numbers of the other process are those of this one to the last digits."""
    for name in ("friction", "linear cohesive", "refined, everything"):
        V, W = CASES[name].Spaces()
        solution = CASES[name].Problem(V, W, 6).Solve()
        solution.Save(path)
        code = f"""if True:
            import json, sys
            sys.path.insert(0, {str(Path(__file__).parent)!r})
            from ngsolve import SetNumThreads
            from ngsxfem_contact import ContactSolution
            from saved_cases import CASES, numbers
            SetNumThreads(1)
            read = ContactSolution.Load({str(path)!r})
            further = CASES[{name!r}].Problem(read.problem.V, read.problem.W, -2).Solve(previous=read)
            print(json.dumps([numbers(read).tolist(), numbers(further).tolist()]))"""
        run = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, check=True, cwd=path.parent)
        there = [np.array(row) for row in json.loads(run.stdout)]
        same(there[0], numbers(solution))
        same(there[1], numbers(CASES[name].Problem(V, W, -2).Solve(previous=solution)), 1e-12 if name.startswith("refined") else 1e-14)


def test_a_file_that_was_read_is_saved_again(path):
    solution = solved("refined, everything")
    solution.Save(path)
    ContactSolution.Load(path).Save(path)
    same(numbers(ContactSolution.Load(path)), numbers(solution))


def test_load_steps_go_on(path):
    """One factorisation of the problem that was read; slip is measured from the step that was saved, its displacement recovered before."""
    V, W = CASES["friction"].Spaces()
    steps = LoadSteps(CASES["friction"].Problem(V, W, 6))
    first = steps.Solve(0.5)
    first.Save(path)
    read = ContactSolution.Load(path)
    further = LoadSteps(read.problem)
    further.last = read
    for t in (1, 0.2):
        same(numbers(further.Solve(t)), numbers(steps.Solve(t)))


def test_path_steps_go_on(path):
    """A specimen that is opened from one side until its load falls."""
    V, W = Case(order=1, cracks=(Crack([(0, 0.5), (1, 0.5)]),), dirichlet="bottom|top", law=LinearCohesive(0.1, 0.005)).Spaces()
    problem = ContactProblem(V, W, law=LinearCohesive(0.1, 0.005))
    problem.SetDirichlet((0, x), "top")
    steps = PathSteps(problem)
    for _ in range(4):
        solution = steps.Solve(0.01)
    solution.Save(path)
    read = ContactSolution.Load(path)
    further = PathSteps(read.problem, previous=read)
    assert further.t == steps.t > 0
    for _ in range(3):
        same(numbers(further.Solve(0.01)), numbers(steps.Solve(0.01)), 1e-12)
        assert further.t == pytest.approx(steps.t, rel=1e-13)
    assert PathSteps(problem, previous=problem.Solve()).t == 0  # a solution of a given load is a history, no point of a path


def test_growth_and_pictures_go_on(path, tmp_path):
    solution = solved()
    solution.Save(path)
    read = ContactSolution.Load(path)

    def table(solution):
        mesh, law = solution.body.mesh, Coulomb(0.4)

        def make(cracks):
            body = CrackedMesh(mesh, *cracks)
            V = CrackFESpace(body, order=2, material=MATERIAL, dirichlet="bottom")
            problem = ContactProblem(V, TraceSpace(body, order=1), law=law)
            pull(problem, V.TestFunction(), 1)
            return problem

        growth = CrackGrowth(make, solution.body.cracks, GivenIncrement(0.15))
        growth.Run(2)
        return str(growth)

    assert table(read) == table(solution)
    vtk = [Path(s.SaveVTK(tmp_path / name)).read_bytes() for s, name in ((solution, "a.vtu"), (read, "b.vtu"))]
    assert vtk[0] == vtk[1]
    plot_body(read)


# Pickle itself


def test_bodies_spaces_problems_and_solutions_are_pickled():
    solution = solved("everything")
    body, V, W, problem, history, again = pickle.loads(
        pickle.dumps((solution.body, solution.problem.V, solution.problem.W, solution.problem, solution.state.history, solution))
    )
    assert V.body is W.body is body is problem.body and problem.V is V and again.problem is problem
    assert V.material == MATERIAL and V.undecided == []
    same(numbers(problem.Solve()), numbers(solution.problem.Solve()))
    same(numbers(again), numbers(solution))
    same(history.jump, solution.state.history.jump)


FUNCTIONS = {
    "gradient": lambda f, w, u: Grad(f)[0],
    "gradient of a vector": lambda f, w, u: Grad(w)[0, 1],
    "symmetric gradient": lambda f, w, u: Sym(Grad(w))[0, 1],
    "jump": lambda f, w, u: Jump(u)[1],
    "function": lambda f, w, u: f * x,
    "normal": lambda f, w, u: u.space.body.normal[0] * u.space.body.larger_side + u.space.body.crack_number,
    "side": lambda f, w, u: u.space.body.cracks[0].side * u.space.body.InLargerPart(None) + u.space.body.InLargerPart("plus"),
    "limit": lambda f, w, u: u.space.body.LimitOnCrack(x * u[0], -1),
    "mesh size": lambda f, w, u: specialcf.mesh_size,
}


def test_components_on_refined_meshes_are_refused():
    """NGSolve would give them values of other unknowns."""
    mesh = refined()
    both = GridFunction(H1(mesh, order=2) * H1(mesh, order=1))
    with pytest.raises(pickle.PicklingError, match="components of GridFunctions"):
        pickle.dumps(x * both.components[0])
    both.components[0].Set(x * y)
    mesh2, copy = pickle.loads(pickle.dumps((mesh, both)))
    assert copy.components[0](mesh2(0.3, 0.4)) == pytest.approx(0.12, rel=1e-12)


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("mesh", [square, refined])
def test_functions_are_pickled(name, mesh):
    """Those that NGSolve does not pickle, or reads back as others, on a refined mesh, too, whose unknowns have other numbers when it is read."""
    V, W = Case(mesh).Spaces()
    f, w, u = GridFunction(H1(V.mesh, order=2)), GridFunction(VectorH1(V.mesh, order=2)), GridFunction(V)
    f.Set(x * y)
    w.Set((x * y, y * y))
    u.vec.FV().NumPy()[:] = np.cos(np.arange(V.ndof))
    function = FUNCTIONS[name](f, w, u)
    W2, copy = pickle.loads(pickle.dumps((W, function)))
    values = [CF(g)(space.nodes.points) for space, g in ((W, function), (W2, copy))]
    assert np.ptp(values[0]) > 0 or name == "mesh size"
    same(*values)
