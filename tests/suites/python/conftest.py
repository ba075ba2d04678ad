"""The program that the package is compared with, and a run with a hidden fault."""

import os
from pathlib import Path

import pytest

import tautline


@pytest.fixture(scope="session")
def program() -> Path:
    return Path(os.environ["TAUTLINE_PROGRAM"])


@pytest.fixture(scope="session")
def run() -> tautline.Run:
    effect = tautline.Effect("winch_scale", ["cable-3"], {"scale": 0.02})
    return tautline.simulate(tautline.Robot.preset("mini"), poses=25, seed=5, effects=[effect])
