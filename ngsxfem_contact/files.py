"""Files that appear when they are complete, and folders that one process works in."""

from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

try:
    import fcntl
except ImportError:  # Windows has none: there the user sees to it
    fcntl = None  # type: ignore[assignment]


class UnreadableFile(ValueError):
    """A file is damaged, or not of the kind that it must be; the message says where, and what to do."""


def write_whole(path: Path, write: Callable[[Path], Any], end: bytes = b"") -> Path:
    """Calls write(temporary path in the same folder) and moves the complete file to its place; returns the path.

    Parameters
    ----------
    end
        What the file must end with, for writers that do not say when the disk is full.

    Raises
    ------
    FileNotFoundError
        If the folder does not exist.
    IsADirectoryError
        If the path is one.
    OSError
        If the file could not be written completely; then there is no new file, and an old one is left as it was.
    """
    write_all([(path, write, end)])
    return path


def write_all(files: Sequence[tuple[Path, Callable[[Path], Any], bytes]]) -> None:
    """The same for some files of one folder, (path, write, end) each: none is moved to its place before all are complete."""
    folder = files[0][0].parent
    if not folder.is_dir():
        raise FileNotFoundError(f"{files[0][0]} cannot be written: there is no folder {folder}; create it first")
    for path, _, _ in files:
        if path.is_dir():
            raise IsADirectoryError(f"{path} cannot be written: it is a folder; give the name of a file in it")
    with tempfile.TemporaryDirectory(dir=folder, prefix=f".{files[0][0].name}.") as beside:
        for path, write, end in files:
            temporary = Path(beside) / path.name
            write(temporary)
            check_complete(temporary, path, end)
        for path, _, _ in files:
            os.replace(Path(beside) / path.name, path)


def check_complete(temporary: Path, path: Path, end: bytes) -> None:
    """Raises OSError unless a file has reached the disk, up to its end."""
    try:
        with open(temporary, "rb+") as file:
            os.fsync(file.fileno())
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - 100))
            complete = file.read().rstrip().endswith(end)
    except FileNotFoundError:
        size, complete = 0, False
    if not complete:
        raise OSError(f"{path} cannot be written: it broke off after {size} bytes; is the disk full, or the size of files limited?")


@contextmanager
def only_one(path: str | Path, what: str) -> Iterator[Any]:
    """Holds a lock on a file while the block runs; raises BlockingIOError if another process does. The system frees it when the process ends."""
    with open(path, "w", encoding="utf-8") as file:
        if fcntl is not None:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise BlockingIOError(f"{what} is in use by another process; wait for it, or take another folder") from None
        yield
