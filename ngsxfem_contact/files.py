"""Files that appear when they are complete."""

import os
import tempfile
from pathlib import Path


def write_whole(path, write):
    """Calls write(temporary path in the same folder) and moves the complete file to its place; returns the path.

    Raises FileNotFoundError if the folder does not exist, IsADirectoryError if the path is one.
    """
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path} cannot be written: there is no folder {path.parent}; create it first")
    if path.is_dir():
        raise IsADirectoryError(f"{path} cannot be written: it is a folder; give the name of a file in it")
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
        temporary = Path(folder) / path.name
        write(temporary)
        os.replace(temporary, path)
    return path
