"""Docstrings, the reference made of them, and the tutorial."""

import doctest
import inspect
import json
import subprocess
import sys
from functools import cached_property
from pathlib import Path
from typing import Any

import matplotlib
import pytest

import tautline
from reference import page, parameters_of, public, sections

DOCS = Path(__file__).parents[3] / "docs"


@pytest.mark.parametrize(("name", "value"), list(public()))
def test_docstrings_name_every_parameter_with_its_type(name: str, value: Any) -> None:
    found = sections(value.__doc__ or "")
    assert found[""], f"{name} has no docstring"
    if isinstance(value, (property, cached_property)):
        return
    stated = found.get("Parameters", "") + "\n" + found.get("Attributes", "")
    heads = [line for line in stated.splitlines() if line and not line.startswith(" ")]
    named = {one.strip() for head in heads for one in head.partition(":")[0].split(",")}
    assert named == parameters_of(value), name
    if not inspect.isclass(value):
        # Who refers to another call does not repeat its types.
        assert all(" : " in head for head in heads) or "As for `" in stated, name
        gives = inspect.signature(value).return_annotation
        assert ("Returns" in found) == (gives not in ("None", None)), name


def test_every_public_name_is_in_the_reference() -> None:
    listed = {name.partition(".")[0] for name, _ in public()}
    assert set(tautline.__all__) - listed == {"TautlineError", "__version__"}
    headings = [line.lstrip("# ") for line in page().splitlines() if line.startswith("###")]
    assert sorted(headings) == sorted(name for name, _ in public())


def test_the_reference_is_printed_as_one_page() -> None:
    printed = subprocess.run([sys.executable, Path(__file__).with_name("reference.py")], capture_output=True, check=True, encoding="utf-8")
    assert printed.stdout == page()


def test_examples_in_docstrings_are_true() -> None:
    finder = doctest.DocTestFinder()
    runner = doctest.DocTestRunner()
    for name, value in public():
        for example in finder.find(value, name, globs=dict(vars(tautline))):
            runner.run(example)
    assert runner.tries >= 8
    assert runner.failures == 0


def test_the_tutorial_runs_as_it_is_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs the cells of the notebook one after another, as Jupyter does."""
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    notebook = json.loads((DOCS / "tutorial.ipynb").read_text(encoding="utf-8"))
    assert notebook["nbformat"] == 4
    names: dict[str, Any] = {"__name__": "__main__"}
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(cells) >= 10
    for number, cell in enumerate(cells, 1):
        assert cell["outputs"] == [] and cell["execution_count"] is None, "outputs are not stored"
        exec(compile("".join(cell["source"]), f"tutorial.ipynb, cell {number}", "exec"), names)
    assert names["found"].findings[0].effect == "winch_scale"
    assert (tmp_path / "report.html").exists()
