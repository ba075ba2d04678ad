"""Where the program is that the package is compared with."""

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def program() -> Path:
    return Path(os.environ["TAUTLINE_PROGRAM"])
