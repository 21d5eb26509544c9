"""Sphinx: `make docs`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import docstrings  # noqa: E402

from ngsxfem_contact import __version__ as release  # noqa: E402, F401

project = "ngsxfem_contact"
copyright = "the ngsxfem_contact developers, LGPL-3.0-or-later"
extensions = ["myst_nb", "sphinx.ext.autodoc"]
exclude_patterns = ["tutorials/.ipynb_checkpoints"]
html_theme = "furo"
html_title = project
html_static_path = ["static"]
html_css_files = ["wide.css"]

myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
nb_execution_mode = "off"  # tools/notebooks.py executed them
nb_mime_priority_overrides = [("html", "application/vnd.jupyter.widget-view+json", None)]
suppress_warnings = ["mystnb.unknown_mime_type"]

autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_default_options = {"members": True, "exclude-members": "name, value"}


def setup(app):
    app.connect("autodoc-process-docstring", docstrings.as_restructured_text)
    app.connect("autodoc-process-signature", docstrings.short_signature)
