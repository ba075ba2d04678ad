"""The program that the package is compared with, and a run with a hidden fault."""

import os
from pathlib import Path

import pytest

import tautline


@pytest.fixture(autouse=True)
def settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Nobody's settings, such as hypotheses of their own, take part."""
    folder = tmp_path / "settings"
    monkeypatch.setenv("TAUTLINE_HOME", str(folder))
    return folder


@pytest.fixture(scope="session")
def program() -> Path:
    return Path(os.environ["TAUTLINE_PROGRAM"])


@pytest.fixture(scope="session")
def run() -> tautline.Run:
    effect = tautline.Effect("winch_scale", ["cable-3"], {"scale": 0.02})
    return tautline.simulate(tautline.Robot.preset("mini"), poses=25, seed=5, effects=[effect])
