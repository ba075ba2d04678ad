"""Calibration of cable-driven parallel robots, and the diagnosis of what their model gets wrong.

    import tautline

    robot = tautline.Robot.preset("mini")
    run = tautline.simulate(robot, poses=25, effects="winch_scale:cable-3:scale=0.02")
    fitted = tautline.identify(run.dataset)
    fitted.residuals.to_pandas()
    tautline.diagnose(run.dataset)

Lengths are in metres, angles in radians, forces in newtons; quaternions have w first. Every result carries the whole document
that the command of the same name writes, as `document`. `tautline.plot` draws results with matplotlib.
"""

from . import plot
from ._calls import check, compare, diagnose, effects, evaluate, history, identify, plan, predict, replay, simulate
from ._data import Dataset, Effect, Robot, presets, read_dataset, read_robot, read_session
from ._files import channels, export, import_readings, import_robot, precalibrate, report
from ._results import (
    Cause,
    Change,
    Channels,
    Check,
    Comparison,
    Diagnosis,
    Finding,
    History,
    Identification,
    Import,
    Plan,
    Precalibration,
    Prediction,
    Readiness,
    Replay,
    Run,
)
from ._study import Study, StudyResult
from ._table import Table
from ._tautline import TautlineError, __version__

__all__ = [
    "Cause",
    "Change",
    "Channels",
    "Check",
    "Comparison",
    "Dataset",
    "Diagnosis",
    "Effect",
    "Finding",
    "History",
    "Identification",
    "Import",
    "Plan",
    "Precalibration",
    "Prediction",
    "Readiness",
    "Replay",
    "Robot",
    "Run",
    "Study",
    "StudyResult",
    "Table",
    "TautlineError",
    "__version__",
    "channels",
    "check",
    "compare",
    "diagnose",
    "effects",
    "evaluate",
    "export",
    "history",
    "identify",
    "import_readings",
    "import_robot",
    "plan",
    "plot",
    "precalibrate",
    "predict",
    "presets",
    "read_dataset",
    "read_robot",
    "read_session",
    "replay",
    "report",
    "simulate",
]
