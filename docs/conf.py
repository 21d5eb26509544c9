"""Sphinx: `make docs`."""

import inspect
import re
from importlib.metadata import files

from ngsxfem_contact import __version__ as release  # noqa: E402, F401

project = "ngsxfem_contact"
copyright = "the ngsxfem_contact developers, LGPL-3.0-or-later"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["tutorials/.ipynb_checkpoints"]
html_theme = "furo"
html_title = project


def installed(package, pattern):
    """The path of a file that a package brings."""
    (path,) = (str(file.locate()) for file in files(package) if file.match(pattern))
    return path


# Pages need no network: MathJax, and what draws the scenes of the tutorials.
html_static_path = ["static", installed("django-static-mathjax", "es5/tex-svg-full.js"), installed("webgui_jupyter_widgets", "nbextension/webgui.js")]
mathjax_path = "tex-svg-full.js"
html_css_files = ["wide.css"]
highlight_language = "text"  # tables and commands are not Python

myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
nb_execution_mode = "off"  # tools/notebooks.py executed them
nb_ipywidgets_js = {}  # scenes are frames of their own, which need no network
nb_mime_priority_overrides = [("html", "application/vnd.jupyter.widget-view+json", None)]
suppress_warnings = ["mystnb.unknown_mime_type"]

autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_default_options = {"members": True, "exclude-members": "name, value"}
default_role = "code"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

LONG = {  # pybind11's names of types: what one would write
    r"(?:\w+\.)+(?=[A-Z])": "",
    r"SupportsInt( \| SupportsIndex)?": "int",
    r"SupportsFloat( \| SupportsIndex)?": "float",
    r"Annotated\[(.*), .FixedSize\(\d\).\]": r"\1",
    r"collections\.abc\.": "",
}


def short_signature(app, what, name, obj, options, signature, returned):
    """Without self, and with short types."""
    if not signature:
        return None
    short = [re.sub(r"self: [\w.]+(, )?", "", signature), returned or ""]
    for long, name in LONG.items():
        short = [re.sub(long, name, text) for text in short]
    return short[0], short[1] or None


def escaped(text):
    """|x| is a norm or an absolute value, no substitution."""
    code = re.compile(r"(`[^`]*`|^ *>>>.*$|^ *::\n\n(?:(?: {4}.*)?(?:\n|\Z))+)", re.MULTILINE)
    return "".join(part if code.fullmatch(part) else part.replace("|", r"\|") for part in code.split(text))


def as_written(app, what, name, obj, options, lines):
    """Before napoleon: without the list that pybind11 adds to an enumeration."""
    lines[:] = escaped(re.sub(r"\n(?:Members:|__init__\().*", "", "\n".join(lines), flags=re.DOTALL)).split("\n")


def sentence_of_property(app, what, name, obj, options, lines):
    """After napoleon, which takes what stands before a colon for a type."""
    if what == "property":
        lines[:] = escaped(inspect.getdoc(obj) or "").split("\n")


def setup(app):
    app.connect("autodoc-process-docstring", as_written, priority=400)
    app.connect("autodoc-process-docstring", sentence_of_property, priority=600)
    app.connect("autodoc-process-signature", short_signature)
