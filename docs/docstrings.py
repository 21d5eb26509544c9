"""The docstrings of the package as reStructuredText.

They are written to be read as they are: paragraphs, and lines "name: what it is.    other: ..." with continuations indented.
Indented paragraphs are code or formulas, and ">>>" begins an example.
"""

import re

NAMES = r"(?:[\w*]+(?:, | and ))*[\w*]+"
ITEM = re.compile(rf"^({NAMES}): ")


def as_restructured_text(app, what, name, obj, options, lines):
    """Sphinx calls this for each docstring; lines are changed in place."""
    text = "\n".join(lines)
    text = re.sub(r"\n(?:Members:|__init__\().*", "", text, flags=re.S)  # of pybind11
    lines[:] = [line for paragraph in re.split(r"\n(?:[ \t]*\n)+", text) for line in paragraph_lines(paragraph)]


def paragraph_lines(paragraph):
    """A paragraph, or one line block if it lists arguments, or code."""
    written = paragraph.splitlines()
    if written and written[0].startswith(">>>"):
        return [*written, ""]
    if written and all(line.startswith("    ") for line in written):
        return ["::", "", *written, ""]
    items = joined(written)
    if not any(ITEM.match(item) for item in items):
        return [escaped(" ".join(items)), ""]
    return [*("| " + emphasised(item) for item in items), ""]


def emphasised(item):
    """The names of an argument's item in bold."""
    match = ITEM.match(item)
    return f"**{escaped(match[1])}**: {escaped(item[match.end() :])}" if match else escaped(item)


def joined(lines):
    """Continuations joined to their line, and lines with several items divided."""
    items = []
    for line in lines:
        parts = re.split(rf"(?<=\S) {{4}}(?={NAMES}: )", line) if line.strip() else []
        if not parts:
            continue
        sentence_after_item = items and ITEM.match(items[-1]) and items[-1].endswith(".") and not line.startswith(" ")
        starts = ITEM.match(parts[0]) or not items or sentence_after_item
        if starts:
            items.append(parts[0].strip())
        else:
            items[-1] += " " + parts[0].strip()
        items += [part.strip() for part in parts[1:]]
    return items


def escaped(text):
    """Code in backticks as literals, all else without meaning for docutils."""
    parts = re.split(r"`([^`]*)`", text)
    return "".join(f"``{part}``" if i % 2 else re.sub(r"([*|_\\])", r"\\\1", part) for i, part in enumerate(parts))


def short_signature(app, what, name, obj, options, signature, returned):
    """pybind11's signatures with the types that one would write."""
    if not signature:
        return None
    short = [re.sub(r"self: [\w.]+(, )?", "", signature), returned or ""]
    for long, name in LONG.items():
        short = [re.sub(long, name, text) for text in short]
    return short[0], short[1] or None


LONG = {
    r"(?:\w+\.)+(?=[A-Z])": "",
    r"SupportsInt( \| SupportsIndex)?": "int",
    r"SupportsFloat( \| SupportsIndex)?": "float",
    r"Annotated\[(.*), .FixedSize\(\d\).\]": r"\1",
    r"collections\.abc\.": "",
}
