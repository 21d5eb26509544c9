"""Results as tables: columns with names, for numpy, pandas, CSV files, and to look at."""

from __future__ import annotations

import csv
import html
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from typing_extensions import Self

__all__ = ["Table"]

SHOWN = 20  # rows of a long table at either end


class Table(np.recarray):
    """Rows with named columns: a record array of numpy, so that table["K_I"], table.K_I, table[2] and `pandas.DataFrame(table)` work, and it prints as a table."""

    @classmethod
    def Of(cls, columns: Mapping[str, Any]) -> Self:
        """The table of columns of one length, arrays or lists by their names.

        Parameters
        ----------
        columns : dict
            Name: values.
        """
        arrays = {name: np.asarray(values) for name, values in columns.items()}
        arrays = {name: array.astype("U1") if array.size == 0 and array.dtype.kind == "U" else array for name, array in arrays.items()}
        table = np.empty(len(next(iter(arrays.values()))), dtype=[(name, array.dtype) for name, array in arrays.items()])
        for name, array in arrays.items():
            table[name] = array
        return table.view(cls)

    @classmethod
    def OfRows(cls, rows: Iterable[Mapping[str, Any]], names: Iterable[str] = ()) -> Self:
        """The table of rows that have the same names.

        Parameters
        ----------
        rows
            Dictionaries {name: value}.
        names
            Of the columns of a table without rows.
        """
        rows = list(rows)
        return cls.Of({name: [row[name] for row in rows] for name in (rows[0] if rows else names)})

    def SaveCSV(self, path: str | Path) -> Path:
        """Writes the table as a CSV file, names first, numbers with all digits; returns its path. The file appears when it is complete.

        Parameters
        ----------
        path
            Of the file.

        Raises
        ------
        FileNotFoundError, OSError
            If there is no such folder, or the disk is full.
        """

        def write(temporary: Path) -> None:
            with open(temporary, "w", newline="", encoding="utf-8") as file:
                csv.writer(file).writerows([self._names, *self.tolist()])

        return write_whole(Path(path), write)

    @property
    def _names(self) -> list[str]:
        return [*(self.dtype.names or ())]

    def _cells(self) -> tuple[list[list[str]], int | None]:
        """Rows as text, and where some are left out of a long table."""
        long = len(self) > 2 * SHOWN
        rows = [*self[:SHOWN].tolist(), *self[-SHOWN:].tolist()] if long else self.tolist()
        return [[f"{cell:.6g}" if isinstance(cell, float) else str(cell) for cell in row] for row in rows], SHOWN if long else None

    def __str__(self) -> str:
        if self.ndim != 1 or not self._names:
            return super().__str__()
        rows, cut = self._cells()
        widths = [max(map(len, column)) for column in zip(self._names, *rows)]
        is_text = [self.dtype[name].kind == "U" for name in self._names]
        line = lambda row: "  ".join(cell.ljust(width) if left else cell.rjust(width) for cell, width, left in zip(row, widths, is_text)).rstrip()
        lines = [line(row) for row in (self._names, *rows)]
        return "\n".join(lines if cut is None else [*lines[: cut + 1], f"... {len(self)} rows", *lines[cut + 1 :]])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """For notebooks."""
        rows, cut = self._cells()
        cells = lambda row, tag: "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in row) + "</tr>"
        lines = [cells(row, "td") for row in rows]
        lines = lines if cut is None else [*lines[:cut], f'<tr><td colspan="{len(self._names)}">... {len(self)} rows</td></tr>', *lines[cut:]]
        return "<table>" + cells(self._names, "th") + "".join(lines) + "</table>"
