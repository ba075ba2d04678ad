"""Calibration of cable-driven parallel robots, and the diagnosis of what their model gets wrong.

    import tautline

    robot = tautline.Robot.preset("mini")
    run = tautline.simulate(robot, poses=25, effects=[tautline.Effect("winch_scale", ["cable-3"], {"scale": 0.02})])
    print(tautline.identify(run.dataset))
    print(tautline.diagnose(run.dataset))

Lengths are in metres, angles in radians, forces in newtons; quaternions have w first. Every result carries the whole document
that the command of the same name writes, as `document`.
"""

from __future__ import annotations

import csv
import importlib
import io
import json
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _tautline
from ._tautline import TautlineError, __version__

__all__ = [
    "Cause",
    "Dataset",
    "Diagnosis",
    "Effect",
    "Finding",
    "Identification",
    "Plan",
    "Prediction",
    "Robot",
    "Run",
    "TautlineError",
    "__version__",
    "diagnose",
    "identify",
    "plan",
    "predict",
    "presets",
    "read_dataset",
    "read_robot",
    "read_session",
    "simulate",
]

Path = str | PathLike[str]
Array = NDArray[np.float64]


def _numbers(values: Any) -> Array:
    """An array in which what is unknown (null) is NaN."""
    return np.array(values, dtype=np.float64)


def _json(value: Any) -> str:
    """JSON of plain values and of NumPy's, arrays as lists."""

    def plain(value: Any) -> Any:
        if isinstance(value, (np.ndarray, np.generic)):
            return value.tolist()
        raise TypeError(f"found a value of type {type(value).__name__}, expected what JSON has")

    return json.dumps(value, default=plain)


@dataclass
class Effect:
    """An effect of the catalogue with its targets and the values of its parameters (SI units)."""

    effect: str
    targets: Sequence[str] = ()
    parameters: Mapping[str, float] = field(default_factory=dict)

    def _document(self) -> dict[str, Any]:
        return {
            "effect": self.effect,
            "targets": list(self.targets),
            "parameters": dict(self.parameters),
        }


@dataclass(repr=False)
class Robot:
    """A robot as `robot.json` describes it; `description` may be changed, and is checked where it is used."""

    description: dict[str, Any]

    @classmethod
    def preset(cls, name: str) -> Robot:
        """A robot that comes with the program; see `presets`."""
        return cls(json.loads(_tautline.preset(name)))

    @property
    def name(self) -> str:
        """Its name."""
        return str(self.description["name"])

    @property
    def cables(self) -> list[str]:
        """Names of the cables."""
        return [str(cable["name"]) for cable in self.description["cables"]]

    @property
    def entry_points_m(self) -> Array:
        """Where the cables reach their pulleys, cables by 3 (m)."""
        return _numbers([cable["pulley"]["entry_point_m"] for cable in self.description["cables"]])

    def checked(self) -> Robot:
        """The same robot in its canonical form; raises what is wrong with it."""
        return Robot(json.loads(_tautline.checked_robot(self._text())))

    def write(self, path: Path) -> None:
        """Writes a `robot.json` or model file, atomically."""
        _tautline.write_robot(path, self._text())

    def _text(self) -> str:
        return _json(self.description)

    def __repr__(self) -> str:
        return f"Robot({self.name!r}, {len(self.cables)} cables)"


@dataclass(repr=False)
class Dataset:
    """A robot and what was measured on it: one array for each column of `poses.csv`, NaN where a cell is empty."""

    robot: Robot
    columns: dict[str, NDArray[Any]]

    @classmethod
    def _parsed(cls, robot: Robot, poses: str) -> Dataset:
        header, *rows = csv.reader(io.StringIO(poses))
        columns: dict[str, NDArray[Any]] = {}
        for index, name in enumerate(header):
            cells = [row[index] for row in rows]
            if name == "pose":
                columns[name] = np.array([int(cell) for cell in cells], dtype=np.int64)
                continue
            try:
                columns[name] = np.array([float(cell) if cell else np.nan for cell in cells])
            except ValueError:
                columns[name] = np.array(cells, dtype=np.str_)
        return cls(robot, columns)

    def _poses(self) -> str:
        lengths = {len(values) for values in self.columns.values()}
        if len(lengths) > 1:
            raise TautlineError(f"columns: found lengths {sorted(lengths)}, expected one length for all")
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self.columns)

        def cells(values: NDArray[Any]) -> list[str]:
            texts = np.asarray(values).tolist()
            return ["" if value != value else value if isinstance(value, str) else repr(value) for value in texts]

        writer.writerows(zip(*(cells(values) for values in self.columns.values()), strict=True))
        return out.getvalue()

    def _texts(self) -> tuple[str, str]:
        return self.robot._text(), self._poses()

    def per_cable(self, name: str) -> Array:
        """Columns of all cables as poses by cables: `rev`, `length_m`, `force_n`, `swivel_rad`."""
        quantity, _, unit = name.partition("_")
        count = len(self.robot.cables)
        names = [f"{quantity}_{cable}" + (f"_{unit}" if unit else "") for cable in range(1, count + 1)]
        missing = [one for one in names if one not in self.columns]
        if missing:
            raise TautlineError(f"found no column {missing[0]}, expected one of {', '.join(self.columns)}")
        return np.column_stack([self.columns[one] for one in names])

    def write(self, folder: Path) -> None:
        """Writes the dataset folder: `robot.json` and `poses.csv`, each atomically."""
        _tautline.write_dataset(folder, *self._texts())

    def to_pandas(self) -> Any:
        """The columns as a pandas table, if pandas is installed."""
        return importlib.import_module("pandas").DataFrame(self.columns)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __repr__(self) -> str:
        return f"Dataset({self.robot!r}, {len(self)} poses)"


@dataclass(repr=False)
class Run:
    """A simulated run: the readings, and the robot that gave them."""

    dataset: Dataset
    truth: Robot

    def __repr__(self) -> str:
        return f"Run({self.dataset!r})"


@dataclass(repr=False)
class Prediction:
    """Cables at some poses, poses by cables."""

    length_m: Array
    """From entry point to platform anchor (m)."""
    wrap_rad: Array
    """Wrap angle on the pulley (rad)."""
    swivel_rad: Array
    """Swivel angle of the pulley (rad); NaN where it has no zero direction."""

    def __repr__(self) -> str:
        poses, cables = self.length_m.shape
        return f"Prediction({poses} poses, {cables} cables)"


@dataclass(repr=False)
class Identification:
    """What was identified."""

    converged: bool
    chi2: float
    dof: float
    p_value: float | None
    """Probability of a chi-square at least as large if model and noise are right."""
    entry_points_m: Array
    """Cables by 3 (m)."""
    entry_points_sd_m: Array
    """Their standard deviations (m); NaN where a coordinate is not determined."""
    positions_m: Array
    """Identified poses by 3 (m), home first."""
    orientations_wxyz: Array
    """Identified poses by 4."""
    seconds: float
    """Time of the solve alone (s)."""
    model: Robot
    """The identified robot, with its standard deviations."""
    document: dict[str, Any]

    def __repr__(self) -> str:
        state = "" if self.converged else ", not converged"
        worst = float(np.nanmax(self.entry_points_sd_m)) * 1e3
        return (
            f"Identification(chi2 {self.chi2:.1f} at {self.dof:.0f} degrees of freedom, "
            f"entry points to {worst:.2g} mm or better{state})"
        )


@dataclass
class Cause:
    """A cause that is possible."""

    effect: str
    targets: list[str]
    probability: float


@dataclass(repr=False)
class Finding:
    """Something that the model gets wrong."""

    verdict: str
    """`named`, `ambiguous` or `unknown`."""
    effect: str
    targets: list[str]
    probability: float
    cause: str
    """In a sentence."""
    advice: str
    parameters: dict[str, tuple[float, float | None]]
    """Value and standard deviation of each parameter (SI units)."""
    alternatives: list[Cause]
    document: dict[str, Any]

    def __repr__(self) -> str:
        return f"Finding({self.verdict}, {self.probability:.1%}: {self.cause})"


@dataclass(repr=False)
class Diagnosis:
    """What the model gets wrong, as far as the data tell."""

    adequate: bool
    """Whether the model explains the data as it is."""
    findings: list[Finding]
    possible: list[Cause]
    model: Robot
    """The identified robot with the effects found."""
    seconds: float
    document: dict[str, Any]

    def __repr__(self) -> str:
        if self.findings:
            return "Diagnosis(\n" + "".join(f"  {finding!r}\n" for finding in self.findings) + ")"
        return f"Diagnosis({'the model explains the data' if self.adequate else 'nothing was found'})"


@dataclass(repr=False)
class Plan:
    """Poses to measure and what to expect of them."""

    positions_m: Array
    """Poses by 3, in the order of measurement (m)."""
    orientations_wxyz: Array
    """Poses by 4."""
    entry_point_sd_after_m: Array
    """Standard deviation of the entry points after the first 0, 1, 2, ... poses (m); NaN where something is open."""
    document: dict[str, Any]

    @property
    def poses(self) -> Array:
        """Position and quaternion, poses by 7, as `predict` takes them."""
        return np.hstack([self.positions_m, self.orientations_wxyz])

    def __repr__(self) -> str:
        sd = self.entry_point_sd_after_m[-1] * 1e3
        return f"Plan({len(self.positions_m)} poses, entry points to {sd:.2g} mm)"


def presets() -> list[str]:
    """Names of the robots that come with the program."""
    return _tautline.presets_names()


def read_robot(path: Path) -> Robot:
    """Reads a `robot.json` or model file."""
    return Robot(json.loads(_tautline.read_robot(path)))


def read_dataset(folder: Path) -> Dataset:
    """Reads a dataset folder."""
    robot, poses, notices = _tautline.read_dataset(folder)
    for notice in notices:
        warnings.warn(notice, stacklevel=2)
    return Dataset._parsed(Robot(json.loads(robot)), poses)


def read_session(path: Path) -> Dataset:
    """Robot and measurements of a session file, without the poses that were excluded."""
    robot, poses = _tautline.read_session(path)
    return Dataset._parsed(Robot(json.loads(robot)), poses)


def simulate(
    robot: Robot,
    poses: int = 25,
    seed: int = 1,
    effects: Sequence[Effect] = (),
    *,
    noise: bool = True,
    nominal: bool = False,
) -> Run:
    """Simulates a calibration run; the true entry points are drawn from their priors, or as drawn if `nominal`."""
    hidden = _json([effect._document() for effect in effects])
    text, truth = _tautline.simulate(robot._text(), (poses, seed), hidden, (noise, nominal))
    return Run(Dataset._parsed(robot, text), Robot(json.loads(truth)))


def predict(robot: Robot, poses: ArrayLike) -> Prediction:
    """Lengths and angles of all cables at poses, rows of `x y z qw qx qy qz`."""
    rows = np.asarray(poses, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 7:
        raise TautlineError(f"poses: found an array of shape {rows.shape}, expected rows of x y z qw qx qy qz")
    lengths, wraps, swivels = _tautline.predict(robot._text(), rows.tolist())
    count = len(robot.cables)
    return Prediction(*(_numbers(values).reshape(-1, count) for values in (lengths, wraps, swivels)))


def identify(
    dataset: Dataset, method: str = "joint", effects: Sequence[str] = (), huber: float | None = None
) -> Identification:
    """Identifies the robot.

    `effects` are freed as on the command line: `winch_scale`, `winch_scale:cable-3`, `cable_slip:cable-3:pose=12`. With
    `huber`, residuals beyond so many standard deviations weigh less.
    """
    text, model = _tautline.identify(dataset._texts(), method, list(effects), huber)
    document = json.loads(text)
    return Identification(
        converged=document["converged"],
        chi2=document["chi2"],
        dof=document["dof"],
        p_value=document["p_value"],
        entry_points_m=_numbers(document["entry_points_m"]),
        entry_points_sd_m=_numbers(document["entry_points_sd_m"]),
        positions_m=_numbers([pose["position_m"] for pose in document["poses"]]),
        orientations_wxyz=_numbers([pose["orientation_wxyz"] for pose in document["poses"]]),
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
    text, model = _tautline.diagnose(dataset._texts(), alpha, time_limit_s)
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
    robot: Robot, poses: int = 25, *, candidates: int = 3000, seed: int = 1, explain: bool = False
) -> Plan:
    """Chooses poses to measure; with `explain` the document says which faults they show."""
    document = json.loads(_tautline.plan(robot._text(), (poses, candidates, seed), explain))
    return Plan(
        positions_m=_numbers([pose["position_m"] for pose in document["poses"]]).reshape(-1, 3),
        orientations_wxyz=_numbers([pose["orientation_wxyz"] for pose in document["poses"]]).reshape(-1, 4),
        entry_point_sd_after_m=_numbers(document["entry_point_sd_after_m"]),
        document=document,
    )
