"""Files that appear when they are complete."""

import os
import tempfile
from pathlib import Path


def write_whole(path, write):
    """Calls write(temporary path in the same folder) and moves the complete file to its place; returns the path."""
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
        temporary = Path(folder) / path.name
        write(temporary)
        os.replace(temporary, path)
    return path
