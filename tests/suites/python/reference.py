"""The reference of the Python package, from its docstrings:

    python tests/suites/python/reference.py >reference.md
"""

import dataclasses
import inspect
import re
from collections.abc import Iterator
from functools import cached_property
from typing import Any

import tautline

GROUPS: list[tuple[str, list[str]]] = [
    ("Robots, effects, readings", ["Robot", "Effect", "Dataset", "presets", "effects", "read_robot", "read_dataset", "read_session"]),
    ("Files of other programs", ["import_readings", "channels", "import_robot", "export", "report"]),
    ("Computing", ["simulate", "predict", "plan", "check", "precalibrate", "identify", "evaluate", "diagnose", "replay", "compare", "history"]),
    ("Studies", ["Study", "StudyResult"]),
    (
        "Results",
        ["Run", "Prediction", "Plan", "Readiness", "Check", "Precalibration", "Identification", "Diagnosis", "Finding", "Cause"]
        + ["Comparison", "Replay", "History", "Change", "Import", "Channels", "Table"],
    ),
]
SECTIONS = ("Parameters", "Attributes", "Returns", "Raises", "Warns", "Examples")


def sections(doc: str) -> dict[str, str]:
    """The text of a numpydoc docstring by section; that before the first is ""."""
    found: dict[str, list[str]] = {"": []}
    current = ""
    lines = inspect.cleandoc(doc).splitlines()
    for line, below in zip(lines, [*lines[1:], ""], strict=True):
        if line in SECTIONS and below == "-" * len(line):
            current = line
            found[current] = []
        elif not (line and set(line) == {"-"}):
            found[current].append(line)
    return {name: "\n".join(text).strip() for name, text in found.items()}


def items(text: str) -> Iterator[tuple[str, str]]:
    """Heads and descriptions of a section that is a list."""
    for part in re.split(r"\n(?=\S)", text):
        head, _, body = part.partition("\n")
        yield head, " ".join(inspect.cleandoc(body).split())


def signature(name: str, call: Any) -> str:
    """Arguments and defaults; their types are in the list below."""
    whole = inspect.signature(call)
    bare = [one.replace(annotation=inspect.Parameter.empty) for one in whole.parameters.values() if one.name not in ("self", "cls")]
    return name + str(whole.replace(parameters=bare, return_annotation=inspect.Signature.empty))


def rendered(doc: str) -> str:
    out = []
    for name, text in sections(doc).items():
        if not name:
            out.append(text)
        elif name == "Examples":
            out.append(f"```python\n{text}\n```")
        else:
            rows = [f"- `{head}`" + (f": {body}" if body else "") for head, body in items(text)]
            out.append(f"**{name}**\n\n" + "\n".join(rows))
    return "\n\n".join(out)


def members(owner: type) -> Iterator[tuple[str, Any]]:
    """Public methods and properties of a class and of ours above it, in the order of their definition."""
    seen = set()
    for one in owner.__mro__:
        if not one.__module__.startswith("tautline"):
            continue
        for name, value in vars(one).items():
            if name.startswith("_") or name in seen:
                continue
            is_call = inspect.isfunction(value) or isinstance(value, (classmethod, property, cached_property))
            if is_call:
                seen.add(name)
                yield name, value


def page() -> str:
    out = ["# Reference of the Python package", ""]
    out += ["`docs/PYTHON.md` is the introduction. Lengths are in metres, angles in radians, forces in newtons; quaternions have w first.", ""]
    for title, names in [*GROUPS, ("Plots", [f"plot.{name}" for name in tautline.plot.__all__])]:
        out += [f"## {title}", ""]
        if title == "Plots":
            out += [inspect.cleandoc(tautline.plot.__doc__ or ""), ""]
        for name in names:
            value: Any = tautline
            for part in name.split("."):
                value = getattr(value, part)
            if not inspect.isclass(value):
                out += [f"### {name}", "", f"    {signature(name, value)}", "", rendered(value.__doc__), ""]
                continue
            # Results are made by calls, so that their own signature is of no use.
            is_made = "Parameters" in sections(value.__doc__ or "")
            out += [f"### {name}", ""] + ([f"    {signature(name, value)}", ""] if is_made else []) + [rendered(value.__doc__ or ""), ""]
            for member, what in members(value):
                if isinstance(what, (property, cached_property)):
                    out += [f"#### {name}.{member}", "", rendered(what.__doc__ or ""), ""]
                else:
                    out += [f"#### {name}.{member}", "", f"    {signature(member, getattr(value, member))}", "", rendered(getattr(value, member).__doc__ or ""), ""]
    return "\n".join(out).rstrip() + "\n"


def public() -> Iterator[tuple[str, Any]]:
    """Everything that needs a docstring, by its full name."""
    names = [name for _, names in GROUPS for name in names]
    for name in names:
        value = getattr(tautline, name)
        yield name, value
        if inspect.isclass(value):
            for member, what in members(value):
                is_property = isinstance(what, (property, cached_property))
                yield f"{name}.{member}", what if is_property else getattr(value, member)
    for name in tautline.plot.__all__:
        yield f"plot.{name}", getattr(tautline.plot, name)


def parameters_of(value: Any) -> set[str]:
    """Names of the arguments of a call, or of the fields of a class that users make."""
    if inspect.isclass(value):
        return {field.name for field in dataclasses.fields(value) if not field.name.startswith("_")}
    return set(inspect.signature(value).parameters) - {"self", "cls"}


if __name__ == "__main__":
    print(page(), end="")
