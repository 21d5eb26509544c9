"""Screenshots of pages that NGSolve's webgui wrote, in headless Chromium without a network.

python tools/screenshot.py page.html picture.png [width height]
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from re import sub

import webgui_jupyter_widgets

SCRIPT = Path(webgui_jupyter_widgets.__file__).parent / "nbextension" / "webgui.js"
CHROMIUM = ["chromium", "--headless=new", "--no-sandbox", "--hide-scrollbars", "--allow-file-access-from-files", "--virtual-time-budget=8000"]
SOFTWARE_GL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def screenshot(page, picture, width=1000, height=800):
    """Writes the picture; the page's webgui.js is taken from the installed widgets instead of the network."""
    text = sub(r"https://[^\"]*/webgui\.js", SCRIPT.as_uri(), Path(page).read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        local = Path(folder) / "page.html"
        local.write_text(text, encoding="utf-8")
        options = [f"--user-data-dir={folder}/profile", f"--window-size={width},{height}", f"--screenshot={Path(picture).absolute()}"]
        subprocess.run([*CHROMIUM, *SOFTWARE_GL, *options, local.as_uri()], check=True, timeout=120, stderr=subprocess.DEVNULL)


if __name__ == "__main__":
    screenshot(*sys.argv[1:3], *map(int, sys.argv[3:5]))
