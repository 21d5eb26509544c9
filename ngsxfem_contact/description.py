"""What objects say of themselves: a name and some lines, in notebooks a table."""

from __future__ import annotations

import html
from abc import abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ._ngsxfem_contact import CrackedMesh, CrackedSolid

Lines = list[tuple[str, str]]


class Described:
    """An object that says what it is."""

    @abstractmethod
    def Description(self) -> Lines:
        """Pairs (name, what there is), the lines of its repr."""

    def __repr__(self) -> str:
        return as_text(type(self).__name__, self.Description())

    def _repr_html_(self) -> str:
        return as_html(type(self).__name__, self.Description())


def as_text(title: str, lines: Lines) -> str:
    """A title with its lines below."""
    width = max((len(name) for name, _ in lines), default=0)
    return "\n".join([title, *(f"  {name:{width}}  {what}" for name, what in lines)])


def as_html(title: str, lines: Lines) -> str:
    """The same for notebooks."""
    rows = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(what)}</td></tr>" for name, what in lines)
    return f"<b>{html.escape(title)}</b><table>{rows}</table>"


def numbered(number: int, what: str, many: str = "") -> str:
    """A number with its noun."""
    return f"{number} {what if number == 1 else many or what + 's'}"


def joined(words: Iterable[str], nothing: str = "none") -> str:
    """Words in one line."""
    return ", ".join(words) or nothing


def of_body(body: CrackedMesh) -> Lines:
    """The mesh, the cracks with their ends, and what was moved."""
    lines = [("mesh", numbered(body.mesh.ne, "triangle"))]
    for number, crack in enumerate(body.cracks):
        ends = "closed" if crack.closed else joined(f"{end.kind.name.lower()} ({end.point[0]:.6g}, {end.point[1]:.6g})" for end in body.Ends(number))
        lines.append((f"crack {number}", f"length {crack.length:.6g}, {ends}"))
    return [*lines, *(("note", note) for note in body.notes)]


def of_solid(body: CrackedSolid) -> Lines:
    """The mesh, the sheets with what they cut, their fronts, and what was moved."""
    lines = [("mesh", numbered(body.mesh.ne, "tetrahedron", "tetrahedra"))]
    for number in range(len(body.cracks)):
        cut = body.CrackElements(number)
        area = sum(body.FacetArea(cell.element) for cell in body.Elements(number))
        lines.append((f"sheet {number}", f"area {area:.6g} in {numbered(cut.NumSet(), 'element')}"))
    for number, front in enumerate(body.fronts):
        lines.append((f"front {number}", f"of sheet {front.sheet}, length {front.length:.6g}, {'closed' if front.closed else 'open'}"))
    return [*lines, *(("note", note) for note in body.notes)]
