"""Importing this lets a script import `study`: the folder above comes last on the path, so that it does not hide the installed package."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
