"""What the calls of the package give."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _tautline
from ._data import Dataset, Robot
from ._table import Array, Table, Tabular, numbers, table_of_cells, table_of_rows
from ._tautline import TautlineError


def _by_axis(**columns: Array) -> dict[str, NDArray[Any]]:
    """Columns along x, y and z from arrays with three columns: `entry_m` becomes `entry_x_m`, ..."""
    split: dict[str, NDArray[Any]] = {}
    for name, values in columns.items():
        stem, _, unit = name.rpartition("_")
        for axis, letter in enumerate("xyz"):
            split[f"{stem}_{letter}_{unit}"] = values[:, axis]
    return split


def _quaternions(wxyz: Array) -> dict[str, NDArray[Any]]:
    return {f"q{letter}": wxyz[:, column] for column, letter in enumerate("wxyz")}


def _texts(values: list[str]) -> NDArray[Any]:
    return np.array(values, dtype=np.str_)


@dataclass(repr=False, eq=False)
class Run(Tabular):
    """A simulated run.

    Attributes
    ----------
    dataset : Dataset
        The readings.
    truth : Robot
        The robot that gave them.
    """

    dataset: Dataset
    truth: Robot

    def table(self) -> Table:
        """The readings as a table.

        Returns
        -------
        Table
            The columns of `poses.csv`.
        """
        return Table("poses", self.dataset.columns)

    def __repr__(self) -> str:
        return f"Run({self.dataset!r})"


@dataclass(repr=False, eq=False)
class Prediction(Tabular):
    """Cables at some poses.

    Attributes
    ----------
    length_m : ndarray, shape (poses, cables)
        Length from entry point to platform anchor (m).
    wrap_rad : ndarray, shape (poses, cables)
        Wrap angle on the pulley (rad).
    swivel_rad : ndarray, shape (poses, cables)
        Swivel angle of the pulley (rad); NaN where it has no zero direction.
    cables : list of str
        Names of the cables.
    """

    length_m: Array
    wrap_rad: Array
    swivel_rad: Array
    cables: list[str]

    def table(self) -> Table:
        """One row for each pose and cable.

        Returns
        -------
        Table
            Columns `row` (of the poses, from 0), `cable`, `length_m`, `wrap_rad`, `swivel_rad`.
        """
        poses, cables = self.length_m.shape
        columns: dict[str, NDArray[Any]] = {"row": np.repeat(np.arange(poses), cables), "cable": _texts(self.cables * poses)}
        for name in ("length_m", "wrap_rad", "swivel_rad"):
            columns[name] = getattr(self, name).ravel()
        return Table("cables", columns)

    def __repr__(self) -> str:
        poses, cables = self.length_m.shape
        return f"Prediction({poses} poses, {cables} cables)"


@dataclass(repr=False, eq=False)
class Identification(Tabular):
    """An identified robot.

    Residuals, values and covariances are computed when they are asked for the first time.

    Attributes
    ----------
    converged : bool
        Whether the steps became small.
    chi2 : float
        Sum of the squared standardised residuals.
    dof : float
        Degrees of freedom.
    p_value : float or None
        Probability of a chi-square at least as large if model and noise are right; None without redundancy.
    entry_points_m : ndarray, shape (cables, 3)
        Entry points of the pulleys (m).
    entry_points_sd_m : ndarray, shape (cables, 3)
        Their standard deviations (m); NaN where a coordinate is not determined, and for the published method, which has none.
    positions_m : ndarray, shape (poses, 3)
        Positions of the platform (m).
    orientations_wxyz : ndarray, shape (poses, 4)
        Orientations of the platform, quaternions with w first.
    seconds : float
        Time of the solve alone (s).
    model : Robot
        The identified robot, with its standard deviations.
    document : dict
        Document of the command.
    """

    converged: bool
    chi2: float
    dof: float
    p_value: float | None
    entry_points_m: Array
    entry_points_sd_m: Array
    positions_m: Array
    orientations_wxyz: Array
    seconds: float
    model: Robot
    document: dict[str, Any]
    _request: tuple[tuple[str, str], _tautline.FitOptions]

    @cached_property
    def drawing(self) -> Robot:
        """The robot as described before its calibration."""
        return Robot(json.loads(self._request[0][0]))

    @property
    def poses(self) -> Array:
        """Position and quaternion, shape (poses, 7), as `predict` takes them."""
        return np.hstack([self.positions_m, self.orientations_wxyz])

    @cached_property
    def _tables(self) -> _tautline.FitTables:
        if self.document["method"] == "published":
            raise TautlineError('the method "published" has no standard deviations; use "joint" or "simple"')
        return _tautline.fit_tables(*self._request)

    @cached_property
    def residuals(self) -> Table:
        """Every reading with its residual.

        Columns `pose`, `reading`, `unit`, `residual` (prediction minus reading), `sd`, `redundancy` (share of an error of the
        reading that shows in its residual), `normalised_residual`, `smallest_detectable_error`, `influence_m` (how far such an
        error moves the pulley that it moves most), `moves` (that pulley), `suspect` (`yes` if it fails the test).
        """
        return table_of_cells("readings", self._tables[0])

    @cached_property
    def values(self) -> Table:
        """Every identified value.

        Columns `parameter`, `unit`, `nominal`, `value`, `sd`, `prior_sd`, `from_95` and `to_95` (95 % interval).
        """
        return table_of_cells("values", self._tables[1])

    @property
    def parameters(self) -> list[str]:
        """Names of the identified values, in the order of `covariance`."""
        return self._tables[2][0]

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the identified values, shape (parameters, parameters), in products of their SI units; NaN if the
        readings do not determine all of them."""
        names, cells = self._tables[2]
        return np.frombuffer(cells, "<f8").reshape(len(names), len(names)).copy()

    @property
    def correlation(self) -> Array:
        """Correlation of the identified values, shape (parameters, parameters)."""
        sd = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(sd, sd))

    @cached_property
    def entry_points_covariance_m2(self) -> Array:
        """Covariance of each entry point, shape (cables, 3, 3) (m^2): 0 for coordinates that were given."""
        return np.frombuffer(self._tables[3], "<f8").reshape(-1, 3, 3).copy()

    @property
    def effects(self) -> Table:
        """Identified parameters of the effects: columns `effect`, `targets`, `parameter`, `value`, `unit`, `sd`."""
        titles = ["effect", "targets", "parameter", "value", "unit", "sd"]
        return table_of_rows("effects", titles, self.document["effects"])

    def table(self) -> Table:
        """One row for each pulley.

        Returns
        -------
        Table
            Columns `cable`, `entry_x_m`, ... and `entry_sd_x_m`, ...
        """
        points = _by_axis(entry_m=self.entry_points_m, entry_sd_m=self.entry_points_sd_m)
        return Table("pulleys", {"cable": _texts(self.model.cables), **points})

    def __repr__(self) -> str:
        state = "" if self.converged else ", not converged"
        known = self.entry_points_sd_m[~np.isnan(self.entry_points_sd_m)]
        worst = f", entry points to {1e3 * known.max():.2g} mm or better" if known.size else ""
        return f"Identification(chi2 {self.chi2:.1f} at {self.dof:.0f} degrees of freedom{worst}{state})"


@dataclass
class Cause:
    """A possible cause.

    Attributes
    ----------
    effect : str
        Identifier of the effect.
    targets : list of str
        Names of its cables.
    probability : float
        Its posterior probability.
    """

    effect: str
    targets: list[str]
    probability: float


@dataclass(repr=False)
class Finding:
    """Something that the model gets wrong.

    Attributes
    ----------
    verdict : str
        `named`, `ambiguous` or `unknown`.
    effect : str
        Identifier of the effect.
    targets : list of str
        Names of its cables.
    probability : float
        Posterior probability.
    cause : str
        The cause in a sentence.
    advice : str
        What to do about it.
    parameters : dict of str to tuple
        Value and standard deviation of each parameter (SI units).
    alternatives : list of Cause
        Causes that explain the readings about as well.
    document : dict
        As in the document of the command.
    """

    verdict: str
    effect: str
    targets: list[str]
    probability: float
    cause: str
    advice: str
    parameters: dict[str, tuple[float, float | None]]
    alternatives: list[Cause]
    document: dict[str, Any]

    def __repr__(self) -> str:
        return f"Finding({self.verdict}, {self.probability:.1%}: {self.cause})"


@dataclass(repr=False)
class Diagnosis(Tabular):
    """What the model gets wrong, as far as the readings tell.

    Attributes
    ----------
    adequate : bool
        Whether the model explains the readings as it is.
    findings : list of Finding
        What was found.
    possible : list of Cause
        Causes that are possible and not certain enough to be findings.
    model : Robot
        The identified robot with the effects found.
    seconds : float
        Time taken (s).
    document : dict
        Document of the command.
    """

    adequate: bool
    findings: list[Finding]
    possible: list[Cause]
    model: Robot
    seconds: float
    document: dict[str, Any]

    def table(self) -> Table:
        """One row for each finding.

        Returns
        -------
        Table
            Columns `verdict`, `effect`, `targets`, `probability`, `cause`, `advice`.
        """
        titles = ["verdict", "effect", "targets", "probability", "cause", "advice"]
        return table_of_rows("findings", titles, [{title: getattr(one, title) for title in titles} for one in self.findings])

    def __repr__(self) -> str:
        if self.findings:
            return "Diagnosis(\n" + "".join(f"  {finding!r}\n" for finding in self.findings) + ")"
        return f"Diagnosis({'the model explains the data' if self.adequate else 'nothing was found'})"


@dataclass(repr=False, eq=False)
class Plan(Tabular):
    """Poses to measure and what to expect of them.

    Attributes
    ----------
    positions_m : ndarray, shape (poses, 3)
        Positions in the order of measurement (m).
    orientations_wxyz : ndarray, shape (poses, 4)
        Orientations, quaternions with w first.
    entry_point_sd_after_m : ndarray, shape (poses + 1,)
        Root mean square standard deviation of the entry points after the first 0, 1, 2, ... poses (m); NaN where something is
        not determined.
    document : dict
        Document of the command.
    """

    positions_m: Array
    orientations_wxyz: Array
    entry_point_sd_after_m: Array
    document: dict[str, Any]

    @property
    def poses(self) -> Array:
        """Position and quaternion, shape (poses, 7), as `predict` takes them."""
        return np.hstack([self.positions_m, self.orientations_wxyz])

    def table(self) -> Table:
        """One row for each pose.

        Returns
        -------
        Table
            Columns `x_m`, `y_m`, `z_m`, `qw`, ... and `entry_point_sd_m`, after that pose.
        """
        columns = {f"{letter}_m": self.positions_m[:, axis] for axis, letter in enumerate("xyz")}
        columns |= _quaternions(self.orientations_wxyz)
        columns["entry_point_sd_m"] = self.entry_point_sd_after_m[1:]
        return Table("poses", columns)

    def __repr__(self) -> str:
        sd = self.entry_point_sd_after_m[-1] * 1e3
        return f"Plan({len(self.positions_m)} poses, entry points to {sd:.2g} mm)"


@dataclass(eq=False)
class Change:
    """A part that moved or changed between two sessions, or since a baseline.

    Attributes
    ----------
    targets : list of str
        Names of its cables; none for the target plane and effects of the whole robot.
    effect : str or None
        Identifier of the effect; None for a moved pulley or target plane.
    between : tuple of int or None
        Indices of the sessions before and after it; None for a health check.
    probability : float
        Its posterior probability.
    displacement_m : ndarray, shape (3,), or None
        Along x, y, z (m); None for an effect.
    displacement_sd_m : ndarray, shape (3,), or None
        Its standard deviations (m).
    change : float or None
        Change of the effect's parameter (SI unit); None for a displacement.
    change_sd : float or None
        Its standard deviation.
    """

    targets: list[str]
    effect: str | None
    between: tuple[int, int] | None
    probability: float
    displacement_m: Array | None
    displacement_sd_m: Array | None
    change: float | None
    change_sd: float | None


def _changes(changes: list[Change]) -> Table:
    unknown = np.full(3, np.nan)
    displacement = [unknown if one.displacement_m is None else one.displacement_m for one in changes]
    columns: dict[str, NDArray[Any]] = {
        "part": _texts([", ".join(one.targets) or "robot" for one in changes]),
        "effect": _texts([one.effect or "moved" for one in changes]),
        "probability": numbers([one.probability for one in changes]),
        **_by_axis(moved_m=numbers(displacement).reshape(-1, 3)),
        "change": numbers([one.change for one in changes]),
        "change_sd": numbers([one.change_sd for one in changes]),
    }
    return Table("changes", columns)


@dataclass(repr=False, eq=False)
class History(Tabular):
    """The record of one robot.

    Attributes
    ----------
    sessions : list of str
        Names of files or folders, in the order of time.
    times : ndarray of datetime64, shape (sessions,)
        When their poses were read (UTC); NaT where unknown.
    entry_points_m : ndarray, shape (sessions, cables, 3)
        Entry points with all sessions taken into account (m); NaN for coordinates that are known exactly.
    entry_points_sd_m : ndarray, shape (sessions, cables, 3)
        Their standard deviations (m).
    changes : list of Change
        What changed between sessions.
    notices : list of str
        What the operator should know.
    document : dict
        Document of the command.
    """

    sessions: list[str]
    times: NDArray[np.datetime64]
    entry_points_m: Array
    entry_points_sd_m: Array
    changes: list[Change]
    notices: list[str]
    document: dict[str, Any]

    def table(self) -> Table:
        """One row for each change.

        Returns
        -------
        Table
            Columns `part`, `effect`, `probability`, `moved_x_m`, ..., `change`, `change_sd`.
        """
        return _changes(self.changes)

    def __repr__(self) -> str:
        return f"History({len(self.sessions)} sessions, {len(self.changes)} changes)"


@dataclass(repr=False, eq=False)
class Check(Tabular):
    """Whether a robot is as it was at its calibration.

    Attributes
    ----------
    verdict : str
        `unchanged`, `changed` or `undecided`.
    probability_unchanged : float
        Posterior probability that nothing changed.
    changes : list of Change
        What may have changed.
    detectable_m : dict of str to float or None
        Move of each pulley that would be found with 95 % probability (m); None if none would.
    sentences : list of str
        The verdict in words.
    document : dict
        Document of the command.
    """

    verdict: str
    probability_unchanged: float
    changes: list[Change]
    detectable_m: dict[str, float | None]
    sentences: list[str]
    document: dict[str, Any]

    def table(self) -> Table:
        """One row for each change.

        Returns
        -------
        Table
            Columns `part`, `effect`, `probability`, `moved_x_m`, ..., `change`, `change_sd`.
        """
        return _changes(self.changes)

    def __repr__(self) -> str:
        return f"Check({self.verdict}: {self.sentences[0]})"


@dataclass(repr=False, eq=False)
class Readiness(Tabular):
    """Whether a dataset is fit for identification.

    Attributes
    ----------
    ready : bool
        Whether no part failed.
    document : dict
        Document of the command; `document["isolability"]` says which faults the poses reveal.
    """

    ready: bool
    document: dict[str, Any]

    def table(self) -> Table:
        """One row for each part of the check.

        Returns
        -------
        Table
            Columns `name`, `outcome` (`pass`, `notice`, `fail` or `not_evaluated`), `sentence`, `action`.
        """
        return table_of_rows("checks", ["name", "outcome", "sentence", "action"], self.document["checks"])

    def __repr__(self) -> str:
        said = [one["sentence"] for one in self.document["checks"] if one["outcome"] in ("fail", "notice")]
        return f"Readiness({'; '.join(['ready' if self.ready else 'not ready', *said])})"


@dataclass(repr=False, eq=False)
class Replay(Tabular):
    """A simulator beside the machine.

    Attributes
    ----------
    nearest : str or None
        The model that is nearer to the simulator: `drawing` or `identified`; None if it predicts tensions only.
    document : dict
        Document of the command.
    """

    nearest: str | None
    document: dict[str, Any]

    def table(self) -> Table:
        """One row for each kind of reading.

        Returns
        -------
        Table
            Columns `reading`, `unit`, and errors as root mean square in SI units: `simulator_rms` (NaN for what it does not
            predict), `drawing_rms`, `identified_rms`, `noise_rms`.
        """
        readings = self.document["readings"]
        columns: dict[str, NDArray[Any]] = {name: _texts([one[name] for one in readings]) for name in ["reading", "unit"]}
        for name in ["simulator_rms", "drawing_rms", "identified_rms", "noise_rms"]:
            columns[name] = numbers([one[name] for one in readings])
        return Table("replay", columns)

    def __repr__(self) -> str:
        return f"Replay({self.document['poses']} poses, nearest: {self.nearest})"


@dataclass(repr=False, eq=False)
class Comparison(Tabular):
    """Differences between two runs, second less first.

    Attributes
    ----------
    different : bool
        Whether a pulley, the target plane or an effect differs.
    level : float
        Probability of finding a difference between two runs of an unchanged robot.
    moved : list of str
        Cables whose pulleys moved.
    document : dict
        Document of the command.
    """

    different: bool
    level: float
    moved: list[str]
    document: dict[str, Any]

    def table(self) -> Table:
        """One row for each pulley.

        Returns
        -------
        Table
            Columns `cable`, `moved`, displacement relative to the pulleys that did not move (`moved_x_m`, ...), its
            standard deviations (`moved_sd_x_m`, ...), `length_m`, `length_sd_m`; NaN if too few others are left.
        """
        pulleys = self.document["pulleys"]
        unknown = {"vector_m": [np.nan] * 3, "sd_m": [np.nan] * 3, "length_m": np.nan, "length_sd_m": np.nan}
        relative = [one["relative"] or unknown for one in pulleys]
        columns: dict[str, NDArray[Any]] = {
            "cable": _texts([one["cable"] for one in pulleys]),
            "moved": np.array([one["moved"] for one in pulleys], dtype=np.bool_),
            **_by_axis(
                moved_m=numbers([one["vector_m"] for one in relative]).reshape(-1, 3),
                moved_sd_m=numbers([one["sd_m"] for one in relative]).reshape(-1, 3),
            ),
            "length_m": numbers([one["length_m"] for one in relative]),
            "length_sd_m": numbers([one["length_sd_m"] for one in relative]),
        }
        return Table("pulleys", columns)

    def __repr__(self) -> str:
        if self.moved:
            return f"Comparison(moved: {', '.join(self.moved)})"
        return f"Comparison({'different' if self.different else 'no difference beyond noise'})"


@dataclass(repr=False, eq=False)
class Precalibration(Tabular):
    """Fits to the calibration tables of a dataset.

    Attributes
    ----------
    winches : Table
        One row for each winch of `winch.csv`.
    force_sensors : Table
        One row for each force sensor of `force.csv`.
    home : dict or None
        Home pose of `home.csv`.
    elongation : dict or None
        Elongation surface of `elongation.csv`.
    model : Robot
        The robot with the fitted values.
    notices : list of str
        What the operator should know, such as fitted values that the robot cannot hold.
    document : dict
        Document of the command.
    """

    winches: Table
    force_sensors: Table
    home: dict[str, Any] | None
    elongation: dict[str, Any] | None
    model: Robot
    notices: list[str]
    document: dict[str, Any]

    def table(self) -> Table:
        """One row for each winch.

        Returns
        -------
        Table
            Columns as in `winches`.
        """
        return self.winches

    def __repr__(self) -> str:
        found = [f"{len(self.winches)} winches", f"{len(self.force_sensors)} force sensors"]
        found += [name for name in ("home", "elongation") if self.document[name]]
        return f"Precalibration({', '.join(found)})"


@dataclass(repr=False, eq=False)
class Channels(Tabular):
    """The channels of files of other programs, and the recipe for them.

    Attributes
    ----------
    recipe : dict
        Recipe that assigns channels to columns of `poses.csv`, as `import_readings` takes it.
    notices : list of str
        Assumptions, and what was not understood.
    document : dict
        Document of the command.
    """

    recipe: dict[str, Any]
    notices: list[str]
    document: dict[str, Any]

    def table(self) -> Table:
        """One row for each channel.

        Returns
        -------
        Table
            Columns `file`, `series`, `name`, `unit`, `values` and `gaps` (rows with and without a value), `from` and `to`
            (in the unit of the file), `used_as` (column of `poses.csv`).
        """
        rows = []
        for source in self.document["sources"]:
            for series in source["series"]:
                for channel in series["channels"]:
                    low, high = channel["range"] or (None, None)
                    place = {"file": source["file"], "series": series["name"], "from": low, "to": high}
                    texts = {key: channel[key] or "" for key in ("unit", "used_as")}
                    rows.append({**channel, **place, **texts})
        titles = ["file", "series", "name", "unit", "values", "gaps", "from", "to", "used_as"]
        return table_of_rows("channels", titles, rows)

    def __repr__(self) -> str:
        table = self.table()
        return f"Channels({len(table)} channels, {np.count_nonzero(table['used_as'])} used)"


@dataclass(repr=False, eq=False)
class Import(Tabular):
    """A dataset from files of other programs.

    Attributes
    ----------
    dataset : Dataset
        The poses.
    recipe : dict
        The recipe that was used; keep it for the next file of the same kind.
    suggestions : list of str
        Suspected mistakes in the readings, in sentences.
    applied : list of str
        Suggestions that were applied to the recipe.
    notices : list of str
        Assumptions, and what was not understood or left out.
    document : dict
        Document of the command.
    """

    dataset: Dataset
    recipe: dict[str, Any]
    suggestions: list[str]
    applied: list[str]
    notices: list[str]
    document: dict[str, Any]

    def table(self) -> Table:
        """The imported poses.

        Returns
        -------
        Table
            The columns of `poses.csv`.
        """
        return Table("poses", self.dataset.columns)

    def __repr__(self) -> str:
        return f"Import({self.dataset!r}, {len(self.suggestions)} suggestions, {len(self.notices)} notices)"
