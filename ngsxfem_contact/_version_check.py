"""Refuses to load the extension with an NGSolve other than the one it was built with."""

from ngsolve.config import NGSOLVE_VERSION_PYTHON

try:
    from ._build_info import NGSOLVE_VERSION
    from ._build_info import VERSION as VERSION
except ImportError:  # none, or one without the version
    raise ImportError(
        "this copy of ngsxfem_contact is source code that has not been built: run `make dev` "
        "in its folder, or `pip install .` and start Python in another folder"
    ) from None


def check(installed: str, expected: str) -> None:
    """Raises ImportError unless both versions are equal: NGSolve's binary interface changes with each."""
    if installed != expected:
        raise ImportError(
            f"ngsxfem_contact was built with NGSolve {expected} and does not work with the installed "
            f"NGSolve {installed}: run `pip install ngsolve=={expected}`, or rebuild ngsxfem_contact "
            f"with NGSolve {installed} pinned in its pyproject.toml"
        )


check(NGSOLVE_VERSION_PYTHON, NGSOLVE_VERSION)
