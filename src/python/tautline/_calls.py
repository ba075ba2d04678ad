"""Simulation, prediction, identification, diagnosis, planning and comparison."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _tautline
from ._arguments import dataset_texts, effects_json, robot_text, whole
from ._data import Dataset, EffectLike, Path, Robot
from ._results import (
    Cause,
    Change,
    Check,
    Comparison,
    Diagnosis,
    Finding,
    History,
    Identification,
    Plan,
    Prediction,
    Readiness,
    Replay,
    Run,
)
from ._table import Table, numbers, table_of_rows
from ._tautline import LEVEL, TIME_LIMIT_S, USUAL_POSES, TautlineError


def effects(robot: Robot | None = None) -> Table:
    """The physical effects that can be simulated, identified and diagnosed.

    Parameters
    ----------
    robot : Robot, optional
        A robot whose hypotheses are listed, too.

    Returns
    -------
    Table
        Columns `effect` (identifier), `title`, `on` (`cable`, `cable_or_all`, `pair` or `robot`), `can_be_estimated`,
        `diagnosed` (when a diagnosis tests it), `in_motion`, `is_damage`, `parameters` (names), `units` (of each), `check` (in
        the workshop) and `source`.
    """
    document = json.loads(_tautline.effects(robot_text(Robot.preset("mini") if robot is None else robot)))
    rows = []
    for effect in document["effects"]:
        names, units = ([one[key] for one in effect["parameters"]] for key in ("name", "unit"))
        rows.append({**effect, "check": effect["check"] or "", "parameters": names, "units": units})
    titles = ["effect", "title", "on", "can_be_estimated", "diagnosed", "in_motion", "is_damage"]
    return table_of_rows("effects", [*titles, "parameters", "units", "check", "source"], rows)


def simulate(
    robot: Robot,
    poses: int = USUAL_POSES,
    seed: int = 1,
    effects: EffectLike | Iterable[EffectLike] = (),
    *,
    noise: bool = True,
    nominal: bool = False,
) -> Run:
    """Simulates a calibration run.

    Parameters
    ----------
    robot : Robot
        The robot as described.
    poses : int, optional
        Number of random poses besides the home pose.
    seed : int, optional
        Seed of everything that is drawn; the same seed gives the same run.
    effects : Effect, str or sequence of them, optional
        Effects that the true robot has.
    noise : bool, optional
        Whether readings have the noise that the robot states.
    nominal : bool, optional
        Whether the true entry points are those of the description, rather than drawn from their priors.

    Returns
    -------
    Run
        The readings, and the robot behind them.

    Examples
    --------
    >>> run = simulate(Robot.preset("mini"), poses=25, effects="winch_scale:cable-3:scale=0.02")
    >>> run.dataset
    Dataset(Robot('mini', 8 cables), 26 poses)
    """
    drawn = whole("poses", poses, 1), whole("seed", seed, 0)
    text, truth = _tautline.simulate(robot_text(robot), drawn, effects_json(effects), (noise, nominal))
    return Run(Dataset.parsed(robot, text), Robot(json.loads(truth)))


def predict(robot: Robot, poses: ArrayLike) -> Prediction:
    """Predicts lengths and angles of all cables at given poses, without effects.

    Parameters
    ----------
    robot : Robot
        The robot.
    poses : array_like, shape (poses, 7)
        Rows of `x y z qw qx qy qz`: position (m) and quaternion of the platform in the base frame.

    Returns
    -------
    Prediction
        Arrays of shape (poses, cables).
    """
    rows = np.asarray(poses, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 7:
        raise TautlineError(f"poses: found an array of shape {rows.shape}, expected rows of x y z qw qx qy qz")
    found = _tautline.predict(robot_text(robot), rows.tolist())
    lengths, wraps, swivels = (numbers(values).reshape(-1, len(robot.cables)) for values in found)
    return Prediction(lengths, wraps, swivels, robot.cables)


def fit_options(**given: Any) -> _tautline.FitOptions:
    """Options of a fit that are as usual except for those given."""
    usual: _tautline.FitOptions = {
        "method": "joint",
        "effects": "[]",
        "huber": None,
        "tolerances": "stated",
        "model": None,
        "poses_held": False,
    }
    return {**usual, **given}  # type: ignore[typeddict-item]


def _identification(texts: tuple[str, str], options: _tautline.FitOptions) -> Identification:
    text, model = _tautline.identify(texts, options)
    document = json.loads(text)
    return Identification(
        converged=document["converged"],
        chi2=document["chi2"],
        dof=document["dof"],
        p_value=document["p_value"],
        entry_points_m=numbers(document["entry_points_m"]),
        entry_points_sd_m=numbers(document["entry_points_sd_m"]),
        positions_m=numbers([pose["position_m"] for pose in document["poses"]]).reshape(-1, 3),
        orientations_wxyz=numbers([pose["orientation_wxyz"] for pose in document["poses"]]).reshape(-1, 4),
        seconds=document["seconds"],
        model=Robot(json.loads(model)),
        document=document,
        _request=(texts, options),
    )


def identify(
    dataset: Dataset,
    method: Literal["joint", "simple", "published"] = "joint",
    effects: EffectLike | Iterable[EffectLike] = (),
    huber: float | None = None,
    *,
    tolerances: Literal["stated", "typical", "none"] = "stated",
) -> Identification:
    """Identifies the pulleys of a robot, and its poses.

    Parameters
    ----------
    dataset : Dataset
        Robot and readings, the home pose first.
    method : {"joint", "simple", "published"}, optional
        `joint`: tensions are unknowns constrained by static equilibrium; `simple`: measured tensions are taken as exact;
        `published`: the method of Jin et al. 2018, which has no effects and no standard deviations.
    effects : Effect, str or sequence of them, optional
        Effects to identify as well, on each cable unless one is named. Parameters that cannot be estimated must be given,
        such as the pose of a slip: `cable_slip:cable-3:pose=12`.
    huber : float, optional
        Number of standard deviations beyond which residuals weigh less (Huber loss).
    tolerances : {"stated", "typical", "none"}, optional
        Tolerances of the parts: those that the robot states, those of the catalogue, or none.

    Returns
    -------
    Identification
        Entry points, poses, standard deviations, and at request residuals and covariance.

    Raises
    ------
    TautlineError
        If the readings cannot be used. Non-convergence is a field of the result.

    Examples
    --------
    >>> run = simulate(Robot.preset("mini"), poses=25, effects="winch_scale:cable-3:scale=0.02")
    >>> identify(run.dataset, effects="winch_scale:cable-3").entry_points_m.shape
    (8, 3)
    """
    options = fit_options(method=method, effects=effects_json(effects), huber=huber, tolerances=tolerances)
    return _identification(dataset_texts(dataset), options)


def evaluate(dataset: Dataset, model: Robot, *, poses_held: bool = False) -> Identification:
    """Estimates poses only, with the geometry and effects of a model kept fixed.

    Parameters
    ----------
    dataset : Dataset
        Readings that the model has not seen.
    model : Robot
        An identified robot, such as `identify(other).model`.
    poses_held : bool, optional
        Whether poses are kept fixed, too, as measured by the external instrument.

    Returns
    -------
    Identification
        The poses, and how well the model explains the readings.
    """
    options = fit_options(model=robot_text(model, "model"), poses_held=poses_held)
    return _identification(dataset_texts(dataset), options)


def _cause(document: dict[str, Any]) -> Cause:
    return Cause(document["effect"], document["targets"], document["probability"])


def diagnose(dataset: Dataset, alpha: float | None = None, time_limit_s: float = TIME_LIMIT_S) -> Diagnosis:
    """Asks what the model gets wrong.

    Parameters
    ----------
    dataset : Dataset
        Robot and readings, the home pose first.
    alpha : float, optional
        Probability of a false finding where the model is right; by default 0.01.
    time_limit_s : float, optional
        Time after which it ends with the best answer so far (s).

    Returns
    -------
    Diagnosis
        Findings with probabilities, and the model with the effects found.
    """
    text, model = _tautline.diagnose(dataset_texts(dataset), alpha, time_limit_s)
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
    """Chooses poses to measure.

    Parameters
    ----------
    robot : Robot
        The robot as described.
    poses : int, optional
        Number of poses besides the home pose.
    candidates : int, optional
        Number of feasible poses among which they are chosen.
    seed : int, optional
        Seed of the candidates.
    explain : bool, optional
        Whether `document["isolability"]` says which faults the poses show.

    Returns
    -------
    Plan
        The poses in the order of measurement, and the expected precision.
    """
    drawn = whole("poses", poses, 1), whole("candidates", candidates, 1), whole("seed", seed, 0)
    document = json.loads(_tautline.plan(robot_text(robot), drawn, explain))
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
    folder: Path,
    tolerance_m: float = 5e-3,
    *,
    position_tolerance_m: float | None = None,
    volume_m: ArrayLike | None = None,
) -> History:
    """Follows one robot over all its sessions: what moved or drifts, and when.

    Parameters
    ----------
    folder : str or path
        Folder of session files and dataset folders of the robot.
    tolerance_m : float, optional
        Largest tolerable displacement of a pulley (m), for the date of the next calibration.
    position_tolerance_m : float, optional
        Largest tolerable root mean square position error of the platform (m); if given, the date of the next calibration is that
        until which it stays within this.
    volume_m : array_like, shape (2, 3), optional
        Smallest and largest coordinates of the box of that error (m), instead of the workspace.

    Returns
    -------
    History
        The coordinates of all pulleys in every session, and what changed.
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


@overload
def check(dataset: Dataset, against: None = None) -> Readiness: ...


@overload
def check(dataset: Dataset, against: Dataset) -> Check: ...


def check(dataset: Dataset, against: Dataset | None = None) -> Readiness | Check:
    """Checks readings before identification, or by few poses whether a robot is still as it was.

    Parameters
    ----------
    dataset : Dataset
        Robot and readings, the home pose first.
    against : Dataset, optional
        Readings of a calibration.

    Returns
    -------
    Readiness or Check
        Without `against`, whether the readings are complete and plausible, determine the geometry, and which faults they
        would reveal; with it, whether the robot is as it was then.
    """
    texts = dataset_texts(dataset)
    if against is None:
        document = json.loads(_tautline.check(texts))
        return Readiness(document["ready"], document)
    text, sentences = _tautline.check_health(texts, dataset_texts(against, "against"))
    document = json.loads(text)
    return Check(
        verdict=document["verdict"],
        probability_unchanged=document["probability_unchanged"],
        changes=[_change(one) for one in document["changes"]],
        detectable_m={one["cable"]: one["move_m"] for one in document["detectable"]},
        sentences=sentences,
        document=document,
    )


def compare(first: Dataset, second: Dataset, level: float = LEVEL) -> Comparison:
    """Compares two runs of a robot: which pulleys moved, and which differences are noise.

    Parameters
    ----------
    first, second : Dataset
        The runs, in the order of time.
    level : float, optional
        Probability of finding a difference between two runs of an unchanged robot.

    Returns
    -------
    Comparison
        Differences, second less first.
    """
    document = json.loads(_tautline.compare(dataset_texts(first, "first"), dataset_texts(second, "second"), level))
    moved = [one["cable"] for one in document["pulleys"] if one["moved"]]
    return Comparison(document["different"], document["level"], moved, document)


def replay(dataset: Dataset, model: Robot, simulated: Dataset) -> Replay:
    """Compares a simulator with the machine: how far its readings are from the measured ones, and what explains it.

    Parameters
    ----------
    dataset : Dataset
        Readings of the machine, with the robot as its drawings describe it.
    model : Robot
        The identified robot, such as `diagnose(dataset).model`.
    simulated : Dataset
        Readings that the simulator predicts for poses with the same labels, and where it has the platform.

    Returns
    -------
    Replay
        Errors of the simulator, of the drawing and of the model, for each kind of reading.
    """
    texts = dataset_texts(simulated, "simulated")
    document = json.loads(_tautline.replay(dataset_texts(dataset), robot_text(model, "model"), texts[1]))
    return Replay(document["nearest"], document)
