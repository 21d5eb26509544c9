"""A release in one command: python tools/release.py VERSION, by `make release VERSION=0.2.0`. Nothing is committed, tagged or uploaded.

1. cut: the number in pyproject.toml and CITATION.cff, the date, and CHANGELOG.md, whose "Unreleased" becomes the version;
2. build, from a copy in build/release whose README an index can show: sdist, and a wheel from it, in dist/;
3. check: metadata and README as an index reads them; the wheel in an empty environment, without extras, in an empty folder.

`python tools/release.py index-readme` writes the README for an index in place, for builds in a checkout of their own.
"""

import re
import shutil
import subprocess
import sys
import tempfile
import venv
from datetime import date
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
UNRELEASED = "## [Unreleased]\n"


def edited(path, pattern, new):
    """The text of a file with the one place of the pattern replaced; ends where there is none, or several."""
    text, number = re.subn(pattern, new, path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    if number != 1:
        sys.exit(f"{path.name}: {number} places look like {pattern!r}, there must be one")
    return text


def cut(root, version, day):
    """Writes the version where it stands; all is checked before anything is written."""
    old = re.search(r'^version = "(.*)"$', (root / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)[1]
    if not re.fullmatch(r"\d+\.\d+\.\d+", version) or [*map(int, version.split("."))] <= [*map(int, old.split("."))]:
        sys.exit(f"{version} is no version after {old}; versions are three numbers")
    news = (root / "CHANGELOG.md").read_text(encoding="utf-8").partition(UNRELEASED)[2].partition("\n## [")[0]
    if "\n- " not in news:
        sys.exit("CHANGELOG.md has nothing under [Unreleased]; what is there to release?")
    texts = {
        "pyproject.toml": edited(root / "pyproject.toml", r'^version = ".*"$', f'version = "{version}"'),
        "CITATION.cff": edited(root / "CITATION.cff", r"^version: .*\n(date-released: .*\n)?", f"version: {version}\ndate-released: {day}\n"),
        "CHANGELOG.md": edited(root / "CHANGELOG.md", "^" + re.escape(UNRELEASED), f"{UNRELEASED}\n## [{version}] - {day}\n"),
    }
    for name, text in texts.items():
        (root / name).write_text(text, encoding="utf-8")


def index_readme(text, source=None):
    """The README where the files beside it are not: what leads to them are addresses below `source`; without one, words, and no pictures."""
    if source is None:
        text = re.sub(r"(?m)(?:^\|.*\n)+\n?", lambda table: "" if "![" in table[0] else table[0], text)
        text = re.sub(r"!\[[^\]]*\]\((?!https?:)[^)]*\)\n*", "", text)
        return re.sub(r"\[([^\]]+)\]\((?!https?:|#)[^)]+\)", r"\1", text)
    address = lambda link: f"{link[1]}({source.rstrip('/')}/{'raw' if link[1][0] == '!' else 'blob'}/HEAD/{link[2]})"
    return re.sub(r"(!?\[[^\]]*\])\((?!https?:|#)([^)]+)\)", address, text)


def write_index_readme(root):
    """In place, with the address in pyproject.toml's `Source`, if there is one."""
    address = re.search(r'^Source = "(.*)"$', (root / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)
    (root / "README.md").write_text(index_readme((root / "README.md").read_text(encoding="utf-8"), address and address[1]), encoding="utf-8")


def run(*command, **options):
    """Prints the command and runs it; ends where it fails."""
    print("+", *command, flush=True)
    if subprocess.run([str(word) for word in command], **options).returncode:
        sys.exit(f"failed: {' '.join(map(str, command))}")


def build(root, dist):
    """sdist and wheel of the files that git has, in an empty folder `dist`."""
    copy = root / "build" / "release"
    for folder in (copy, dist):
        shutil.rmtree(folder, ignore_errors=True)
    for name in subprocess.check_output(["git", "ls-files", "-z"], cwd=root, text=True).split("\0")[:-1]:
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(root / name, copy / name)
    write_index_readme(copy)
    run(sys.executable, "-m", "build", "--outdir", dist, copy)  # the wheel from the sdist
    (plain,) = dist.glob("*-linux_*.whl")
    run("sh", copy / "tools" / "repair_wheel.sh", plain, dist, sys.executable)
    plain.unlink()
    run(sys.executable, "-m", "twine", "check", "--strict", *dist.iterdir())


def try_wheel(dist, version):
    """In an empty environment and folder, without extras: the command gives its results."""
    (wheel,) = dist.glob("*manylinux*.whl")
    with tempfile.TemporaryDirectory() as empty:
        venv.create(Path(empty) / "venv", with_pip=True)
        python = Path(empty) / "venv" / "bin" / "python"
        run(python, "-m", "pip", "install", "--quiet", wheel.resolve(), cwd=empty)
        run(python, "-c", f"import ngsxfem_contact; assert ngsxfem_contact.__version__ == {version!r}", cwd=empty)
        run(python, "-m", "ngsxfem_contact", "--output", "results", cwd=empty)
        if not (Path(empty) / "results" / "summary.json").is_file():
            sys.exit("the command of the wheel wrote no summary")


def main(arguments):
    """Runs a command line."""
    if arguments == ["index-readme"]:
        return write_index_readme(ROOT)
    if len(arguments) != 1:
        sys.exit(__doc__)
    (version,), dist = arguments, ROOT / "dist"
    if subprocess.check_output(["git", "status", "--porcelain"], cwd=ROOT, text=True):
        sys.exit("the work tree has changes; commit them first, so that the release is what is committed")
    cut(ROOT, version, date.today())
    build(ROOT, dist)
    try_wheel(dist, version)
    print(f"\n{version} is in dist/. What is left, by hand: look at `git diff`, commit it, tag v{version}, upload dist/ (docs/release.md).")


if __name__ == "__main__":
    main(sys.argv[1:])
