"""Calibration of cable-driven parallel robots, and the diagnosis of what their model gets wrong.

    import tautline

    robot = tautline.Robot.preset("mini")
    run = tautline.simulate(robot, poses=25, effects=[tautline.Effect("winch_scale", ["cable-3"], {"scale": 0.02})])
    print(tautline.identify(run.dataset))
    print(tautline.diagnose(run.dataset))

Lengths are in metres, angles in radians, forces in newtons; quaternions have w first. Every result carries the whole document
that the command of the same name writes, as `document`.
"""

from ._calls import check, diagnose, history, identify, plan, predict, simulate
from ._data import Dataset, Effect, Robot, presets, read_dataset, read_robot, read_session
from ._results import Cause, Change, Check, Diagnosis, Finding, History, Identification, Plan, Prediction, Run
from ._study import Study, StudyResult
from ._tautline import TautlineError, __version__

__all__ = [
    "Cause",
    "Change",
    "Check",
    "Dataset",
    "Diagnosis",
    "Effect",
    "Finding",
    "History",
    "Identification",
    "Plan",
    "Prediction",
    "Robot",
    "Run",
    "Study",
    "StudyResult",
    "TautlineError",
    "__version__",
    "check",
    "diagnose",
    "history",
    "identify",
    "plan",
    "predict",
    "presets",
    "read_dataset",
    "read_robot",
    "read_session",
    "simulate",
]
