"""Studies through Python, beside the command."""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arro3.core import Table

import tautline

STUDY: dict[str, Any] = {
    "name": "two lasers",
    "seed": 7,
    "design": {"robots": ["mini"], "lasers": ["class-0.3mm", "none"], "poses": [8], "choice": ["random"]},
    "simulation": {"calibrations": 40, "share": 1.0, "chunk": 20},
}


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> tautline.Study:
    planned = tautline.Study.plan(STUDY, tmp_path_factory.mktemp("study") / "two")
    assert planned.run(threads=2) == 4
    return planned


def test_the_command_merges_the_same(study: tautline.Study, program: Path) -> None:
    result = study.merge()
    written = (study.folder / "result.json").read_bytes()
    subprocess.run([program, "study", "merge", study.folder], check=True, stdout=subprocess.DEVNULL)
    assert (study.folder / "result.json").read_bytes() == written
    assert json.loads(written) == result.document
    assert tautline.Study.open(study.folder).document == study.document


def test_a_chunk_that_is_there_is_not_done_again(study: tautline.Study) -> None:
    assert study.run() == 0
    assert study.run(chunk=(2, 4)) == 0


def test_statistics_are_those_of_the_calibrations(study: tautline.Study) -> None:
    result = study.merge()
    rows = study.calibrations()
    assert len(rows["cell"]) == result.calibrations == 80
    for cell in range(2):
        errors = rows["position_m"][rows["cell"] == cell].astype(np.float64)
        rms = np.sqrt(np.mean(errors**2))
        assert result.columns["simulated_position_m"][cell] == pytest.approx(rms, rel=1e-9)
        ratio = rms / result.columns["expected_position_m"][cell]
        assert result.columns["over_expected"][cell] == pytest.approx(ratio, rel=1e-9)


def test_cells_are_columns(study: tautline.Study) -> None:
    assert study.columns["laser"].tolist() == ["class-0.3mm", "none"]
    assert study.columns["laser_sd_m"][0] == 3e-4 and np.isnan(study.columns["laser_sd_m"][1])
    assert study.columns["expected_position_m"][0] < study.columns["expected_position_m"][1]
    table = Table.from_arrow(study.merge())
    assert table["laser"].to_pylist() == ["class-0.3mm", "none"]
    assert repr(study) == "Study('two lasers', 2 cells)"


def test_a_study_file_is_that_of_the_command(tmp_path: Path, program: Path) -> None:
    file = Path(__file__).parents[3] / "docs/studies/size.toml"
    planned = tautline.Study.plan(file, tmp_path / "python")
    subprocess.run(
        [program, "study", "plan", file, "--out", tmp_path / "command"], check=True, stdout=subprocess.DEVNULL
    )
    assert planned.document == json.loads((tmp_path / "command/plan.json").read_text())


def test_reports_are_written(study: tautline.Study, tmp_path: Path) -> None:
    study.merge()
    study.report(tmp_path / "report.html")
    assert "two lasers" in (tmp_path / "report.html").read_text()


def test_mistakes_are_the_sentences_of_the_command(study: tautline.Study, tmp_path: Path) -> None:
    planned = tautline.Study.plan(STUDY, tmp_path / "two")
    planned.run(chunk=(1, 3))
    wrong = {**STUDY, "design": {**STUDY["design"], "poses": [0]}}
    for call, sentence in [
        (lambda: tautline.Study.plan(wrong, tmp_path / "x"), "/design/poses/0: found 0, expected a number from 1 to 1000"),
        (lambda: planned.run(chunk=(4, 3)), "chunk: found 4/3, expected the number of a chunk"),
        (lambda: planned.merge(), "found 1 of 3 chunks; number 2 is missing"),
        (lambda: planned.report(tmp_path / "a.html"), "result.json: not found, expected the result"),
        (lambda: tautline.Study.open(tmp_path / "y"), "plan.json: not found"),
    ]:
        with pytest.raises(tautline.TautlineError, match=sentence):
            call()
