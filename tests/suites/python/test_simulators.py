"""A simulator beside the machine: MuJoCo, driven to the poses, against what the program says of it."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import tautline

REPOSITORY = Path(__file__).parents[3]
EXAMPLE = REPOSITORY / "src/python/examples/correct_a_simulator.py"


def test_mujoco_corrected_by_the_machine_errs_as_noise_and_the_page_says_so(program: Path, tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, EXAMPLE, tmp_path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    page = (REPOSITORY / "docs/SIMULATORS.md").read_text(encoding="utf-8")
    assert done.stdout.strip() in page, done.stdout
    drawn, found = ([float(word) for word in line.split() if word.replace(".", "").isdigit()] for line in done.stdout.splitlines()[-2:])
    assert drawn[0] > 20 * drawn[1]
    # The residuals of 480 lengths: beyond a fifth by chance in fewer than one of 10,000 runs.
    assert found[0] < 1.2 * found[1]
    command = [program, "replay", tmp_path / "machine", "--simulated", tmp_path / "simulated-drawn/poses.csv"]
    picture = tmp_path / "simulators.svg"
    printed = subprocess.run([*command, "--picture", picture], capture_output=True, text=True, check=True).stdout
    assert printed.strip() in page, printed
    assert picture.read_text(encoding="utf-8") == (REPOSITORY / "docs/simulators.svg").read_text(encoding="utf-8")


def test_replay_is_that_of_the_command(run: tautline.Run, program: Path, tmp_path: Path) -> None:
    found = tautline.diagnose(run.dataset)
    simulated = run.dataset.copy()
    simulated["x_m"] = simulated["x_m"] + 0.002
    replay = tautline.replay(run.dataset, found.model, simulated)
    errors = replay.table()
    assert list(errors["reading"][:2]) == ["length", "tension"]
    assert np.all(errors["identified_rms"] < errors["drawing_rms"] + 1e-12)
    run.dataset.write(tmp_path / "machine")
    simulated.write(tmp_path / "simulated")
    found.model.write(tmp_path / "model.json")
    out = tmp_path / "replay.json"
    files = ["--simulated", tmp_path / "simulated/poses.csv", "--model", tmp_path / "model.json", "--json", out]
    subprocess.run([program, "replay", tmp_path / "machine", *files], check=True, capture_output=True)
    assert json.loads(out.read_text())["readings"] == replay.document["readings"]
