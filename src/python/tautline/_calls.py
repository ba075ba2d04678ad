"""Simulation, prediction, identification, diagnosis and planning."""

from __future__ import annotations

import json
from collections.abc import Sequence
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _tautline
from ._data import Dataset, Effect, Robot, to_json
from ._results import (
    Cause,
    Change,
    Check,
    Diagnosis,
    Finding,
    History,
    Identification,
    Plan,
    Prediction,
    Run,
)
from ._table import numbers
from ._tautline import USUAL_POSES, TautlineError


def simulate(
    robot: Robot,
    poses: int = USUAL_POSES,
    seed: int = 1,
    effects: Sequence[Effect] = (),
    *,
    noise: bool = True,
    nominal: bool = False,
) -> Run:
    """Simulates a calibration run; the true entry points are drawn from their priors, or as drawn if `nominal`."""
    hidden = to_json([effect.document() for effect in effects])
    text, truth = _tautline.simulate(robot.text(), (poses, seed), hidden, (noise, nominal))
    return Run(Dataset.parsed(robot, text), Robot(json.loads(truth)))


def predict(robot: Robot, poses: ArrayLike) -> Prediction:
    """Lengths and angles of all cables at poses, rows of `x y z qw qx qy qz`."""
    rows = np.asarray(poses, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 7:
        raise TautlineError(f"poses: found an array of shape {rows.shape}, expected rows of x y z qw qx qy qz")
    lengths, wraps, swivels = _tautline.predict(robot.text(), rows.tolist())
    count = len(robot.cables)
    return Prediction(*(numbers(values).reshape(-1, count) for values in (lengths, wraps, swivels)))


def identify(
    dataset: Dataset, method: str = "joint", effects: Sequence[str] = (), huber: float | None = None
) -> Identification:
    """Identifies the robot.

    `effects` are freed as on the command line: `winch_scale`, `winch_scale:cable-3`, `cable_slip:cable-3:pose=12`. With
    `huber`, residuals beyond so many standard deviations weigh less.
    """
    text, model = _tautline.identify(dataset.texts(), method, list(effects), huber)
    document = json.loads(text)
    return Identification(
        converged=document["converged"],
        chi2=document["chi2"],
        dof=document["dof"],
        p_value=document["p_value"],
        entry_points_m=numbers(document["entry_points_m"]),
        entry_points_sd_m=numbers(document["entry_points_sd_m"]),
        positions_m=numbers([pose["position_m"] for pose in document["poses"]]),
        orientations_wxyz=numbers([pose["orientation_wxyz"] for pose in document["poses"]]),
        seconds=document["seconds"],
        model=Robot(json.loads(model)),
        document=document,
    )


def _cause(document: dict[str, Any]) -> Cause:
    return Cause(document["effect"], document["targets"], document["probability"])


def diagnose(
    dataset: Dataset, alpha: float | None = None, time_limit_s: float | None = None
) -> Diagnosis:
    """Asks what the model gets wrong.

    `alpha` is the probability of a false finding where the model is right, by default 0.01; after `time_limit_s`, by default
    a minute, it ends with the best answer so far.
    """
    text, model = _tautline.diagnose(dataset.texts(), alpha, time_limit_s)
    document = json.loads(text)
    findings = [
        Finding(
            verdict=finding["verdict"],
            effect=finding["effect"],
            targets=finding["targets"],
            probability=finding["probability"],
            cause=finding["cause"],
            advice=finding["advice"],
            parameters={one["name"]: (one["value"], one["sd"]) for one in finding["parameters"]},
            alternatives=[_cause(other) for other in finding["alternatives"]],
            document=finding,
        )
        for finding in document["findings"]
    ]
    return Diagnosis(
        adequate=document["adequate"],
        findings=findings,
        possible=[_cause(other) for other in document["possible"]],
        model=Robot(json.loads(model)),
        seconds=document["seconds"],
        document=document,
    )


def plan(
    robot: Robot, poses: int = USUAL_POSES, *, candidates: int = 3000, seed: int = 1, explain: bool = False
) -> Plan:
    """Chooses poses to measure; with `explain` the document says which faults they show."""
    document = json.loads(_tautline.plan(robot.text(), (poses, candidates, seed), explain))
    return Plan(
        positions_m=numbers([pose["position_m"] for pose in document["poses"]]).reshape(-1, 3),
        orientations_wxyz=numbers([pose["orientation_wxyz"] for pose in document["poses"]]).reshape(-1, 4),
        entry_point_sd_after_m=numbers(document["entry_point_sd_after_m"]),
        document=document,
    )


def _change(document: dict[str, Any]) -> Change:
    def array(values: list[float] | None) -> Any:
        return None if values is None else numbers(values)

    between = document.get("between")
    return Change(
        targets=document["targets"],
        effect=document["effect"],
        between=None if between is None else (between[0], between[1]),
        probability=document["probability"],
        displacement_m=array(document["displacement_m"]),
        displacement_sd_m=array(document["sd_m"]),
        change=document["change"],
        change_sd=document["change_sd"],
    )


def history(
    folder: str | PathLike[str],
    tolerance_m: float = 5e-3,
    *,
    position_tolerance_m: float | None = None,
    volume_m: ArrayLike | None = None,
) -> History:
    """Follows one robot over all sessions and dataset folders in a folder.

    `tolerance_m` is the largest tolerable displacement of a pulley, for the date of the next calibration. With `position_tolerance_m`, it
    is the date until which the root mean square position error of the platform stays within that, over the workspace or the box
    from `volume_m[0]` to `volume_m[1]` instead.
    """
    volume = None if volume_m is None else np.asarray(volume_m, dtype=float).tolist()
    text, notices = _tautline.history(folder, tolerance_m, position_tolerance_m, volume)
    document = json.loads(text)
    sessions = document["sessions"]
    times = [np.datetime64(one["time"].removesuffix("Z") if one["time"] else "NaT", "s") for one in sessions]
    return History(
        sessions=[one["path"] for one in sessions],
        times=np.array(times, dtype="datetime64[s]"),
        entry_points_m=numbers([one["entry_points_m"] for one in sessions]),
        entry_points_sd_m=numbers([one["entry_points_sd_m"] for one in sessions]),
        changes=[_change(one) for one in document["changes"]],
        notices=notices,
        document=document,
    )


def check(dataset: Dataset, against: Dataset) -> Check:
    """Says by few poses whether a robot is still as it was at a calibration."""
    text, sentences = _tautline.check_health(dataset.texts(), against.texts())
    document = json.loads(text)
    return Check(
        verdict=document["verdict"],
        probability_unchanged=document["probability_unchanged"],
        changes=[_change(one) for one in document["changes"]],
        detectable_m={one["cable"]: one["move_m"] for one in document["detectable"]},
        sentences=sentences,
        document=document,
    )
