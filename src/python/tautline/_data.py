"""Robots, effects and datasets: what is calibrated, and what was measured on it."""

from __future__ import annotations

import csv
import io
import json
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _tautline
from ._table import Array, Columns, numbers
from ._tautline import TautlineError

Path = str | PathLike[str]


def to_json(value: Any) -> str:
    """JSON of plain values and of NumPy's, arrays as lists."""

    def plain(value: Any) -> Any:
        if isinstance(value, (np.ndarray, np.generic)):
            return value.tolist()
        raise TypeError(f"found a value of type {type(value).__name__}, expected what JSON has")

    return json.dumps(value, default=plain)


@dataclass
class Effect:
    """An effect of the catalogue, or a hypothesis of the robot, with its targets and values.

    Every call that takes effects takes the text of the commands as well: `"winch_scale:cable-3:scale=0.02"`.

    Parameters
    ----------
    effect : str
        Identifier; see `effects`.
    targets : str or sequence of str, optional
        Names of the cables; none for the robot, for all cables together, or, where it is identified, for each cable by itself.
    parameters : mapping of str to float, optional
        Values by name (SI units). Those that are left out are neutral where the effect is simulated, and start values where
        it is identified.

    Examples
    --------
    >>> Effect("winch_scale", "cable-3", {"scale": 0.02}) == Effect.parse("winch_scale:cable-3:scale=0.02")
    True
    """

    effect: str
    targets: Sequence[str] = ()
    parameters: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.targets = [self.targets] if isinstance(self.targets, str) else list(self.targets)
        self.parameters = dict(self.parameters)

    @classmethod
    def parse(cls, text: str) -> Effect:
        """The effect that a text of the commands names.

        Parameters
        ----------
        text : str
            `ID[:CABLE]..[:NAME=NUMBER,..]`.

        Returns
        -------
        Effect
        """
        return cls(**json.loads(_tautline.parse_effect(text)))

    def document(self) -> dict[str, Any]:
        """The effect as JSON has it.

        Returns
        -------
        dict
        """
        return {"effect": self.effect, "targets": list(self.targets), "parameters": dict(self.parameters)}

    def __str__(self) -> str:
        values = ",".join(f"{name}={value!r}" for name, value in self.parameters.items())
        return ":".join([self.effect, *self.targets, *([values] if values else [])])


EffectLike = Effect | str
"""An effect, or the text that the commands have for it."""


@dataclass(repr=False)
class Robot:
    """A robot as `robot.json` describes it.

    Parameters
    ----------
    description : dict
        Content of `robot.json`. It may be changed, and is checked where it is used.
    """

    description: dict[str, Any]

    @classmethod
    def preset(cls, name: str) -> Robot:
        """A robot that comes with the program.

        Parameters
        ----------
        name : str
            One of `presets()`.

        Returns
        -------
        Robot
        """
        return cls(json.loads(_tautline.preset(name)))

    @classmethod
    def from_arrays(
        cls,
        pulleys_m: ArrayLike,
        platform_m: ArrayLike | None = None,
        *,
        name: str = "robot",
        drum_diameters_m: ArrayLike | None = None,
    ) -> Robot:
        """A robot from the places of its parts.

        The home pose is assumed to be about the middle of the frame, a length to have a standard deviation of 1 mm, and all parts
        typical tolerances; without `drum_diameters_m` a revolution pays out 1 m. Correct `description`.

        Parameters
        ----------
        pulleys_m : array of shape (cables, 2) or (cables, 3)
            Where the cables come from their pulleys (m). With two coordinates the robot moves in the plane.
        platform_m : array of the same shape, optional
            Where the cables are fixed, in the platform's frame (m); without it the platform is a point.
        name : str
            Name of the robot.
        drum_diameters_m : array of shape (cables,), optional
            Diameters of the drums (m).

        Returns
        -------
        Robot
        """
        pulleys = _places(pulleys_m)
        platform = [] if platform_m is None else _places(platform_m)
        drums = [] if drum_diameters_m is None else numbers(drum_diameters_m).tolist()
        for one in (platform, drums):
            if one and len(one) != len(pulleys):
                raise ValueError(f"found {len(one)} rows for {len(pulleys)} cables, expected one for each")
        return cls(json.loads(_tautline.robot_of_places(name, pulleys, platform, drums)))

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
        """Where the cables reach their pulleys, shape (cables, 3) (m)."""
        return numbers([cable["pulley"]["entry_point_m"] for cable in self.description["cables"]])

    def with_hypothesis(self, text: str) -> Robot:
        """The same robot, which also knows an effect of your own.

        Parameters
        ----------
        text : str
            Text of a hypothesis file.

        Returns
        -------
        Robot
        """
        known = [*self.description.get("hypotheses", []), text]
        return Robot({**self.description, "hypotheses": known}).checked()

    def checked(self) -> Robot:
        """The same robot in its canonical form.

        Returns
        -------
        Robot

        Raises
        ------
        TautlineError
            If something is wrong with it.
        """
        return Robot(json.loads(_tautline.checked_robot(self.text())))

    def write(self, path: Path) -> None:
        """Writes a `robot.json` or model file, atomically.

        Parameters
        ----------
        path : str or path
            File; it is replaced if it exists.
        """
        _tautline.write_robot(path, self.text())

    def text(self) -> str:
        """Content of `robot.json`.

        Returns
        -------
        str
        """
        return to_json(self.description)

    def __repr__(self) -> str:
        return f"Robot({self.name!r}, {len(self.cables)} cables)"


def _places(points: ArrayLike) -> list[list[float]]:
    """Three coordinates for each cable, NaN where there are two."""
    given = numbers(points)
    if given.ndim != 2 or given.shape[1] not in (2, 3):
        raise ValueError(f"found an array of shape {given.shape}, expected (cables, 2) or (cables, 3)")
    places = np.full((len(given), 3), np.nan)
    places[:, : given.shape[1]] = given
    return places.tolist()


def _column(name: str, values: Any) -> NDArray[Any]:
    """A column as datasets have it: whole numbers for `pose`, texts, else numbers with NaN where a cell is empty."""
    if hasattr(values, "to_numpy") and hasattr(values, "isna"):
        # Columns of pandas that have a mark of their own for missing cells.
        values = values.to_numpy(dtype=object, na_value=None)
    array = np.asarray(values)
    if array.ndim != 1:
        raise TautlineError(f"columns, {name}: found shape {array.shape}, expected one value for each pose")
    is_text = array.dtype.kind == "U" or (array.dtype.kind == "O" and any(isinstance(value, str) for value in array))
    if is_text:
        return np.array(["" if value is None else str(value) for value in array.tolist()], dtype=np.str_)
    try:
        column = array.astype(np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"columns, {name}: found values of type {array.dtype}, expected numbers or texts") from None
    if name != "pose":
        return column
    whole = np.isfinite(column) & (column == np.round(column))
    if not whole.all():
        raise TautlineError(f"columns, pose: found {column[~whole][0]}, expected whole numbers")
    return column.astype(np.int64)


@dataclass(init=False, repr=False, eq=False)
class Dataset(Columns):
    """A robot and what was measured on it: one array for each column of `poses.csv`.

    `data["rev_1"]` is a column, `data[:10]`, `data[mask]` and `data[[0, 3]]` are datasets of some poses. The first row is
    usually the home pose, from which revolutions are counted: keep it in a part that is to be identified.

    Parameters
    ----------
    robot : Robot
        The robot as described before its calibration.
    columns : mapping or DataFrame
        Arrays of one length by name, as in `poses.csv` (SI units), or a table of pandas or polars; NaN where a cell is empty.

    Raises
    ------
    TypeError
        If `robot` is no robot, or `columns` no table.
    TautlineError
        If the columns cannot be those of this robot.

    Warns
    -----
    UserWarning
        If a column is not known, which is then left out of all calls.

    Examples
    --------
    >>> run = simulate(Robot.preset("mini"), poses=12)
    >>> data = Dataset(run.dataset.robot, run.dataset.to_pandas())
    >>> data[:9]
    Dataset(Robot('mini', 8 cables), 9 poses)
    """

    robot: Robot
    columns: dict[str, NDArray[Any]]

    def __init__(self, robot: Robot, columns: Any) -> None:
        if not isinstance(robot, Robot):
            raise TypeError(f'robot: found a value of type {type(robot).__name__}, expected a Robot, such as Robot.preset("mini")')
        is_table = not isinstance(columns, Mapping) and hasattr(columns, "columns")
        if not (is_table or isinstance(columns, Mapping)):
            kind = type(columns).__name__
            raise TypeError(f"columns: found a value of type {kind}, expected a mapping from names to arrays, or a DataFrame")
        names = columns.columns if is_table else columns
        self.robot = robot
        self.columns = {str(name): _column(str(name), columns[name]) for name in names}
        for notice in _tautline.check_poses(*self.texts()):
            warnings.warn(notice, stacklevel=2)

    @classmethod
    def _of(cls, robot: Robot, columns: dict[str, NDArray[Any]]) -> Dataset:
        """A dataset of columns that are right already."""
        dataset = cls.__new__(cls)
        dataset.robot, dataset.columns = robot, columns
        return dataset

    @classmethod
    def from_pandas(cls, robot: Robot, table: Any) -> Dataset:
        """A dataset from a pandas table.

        Parameters
        ----------
        robot : Robot
            The robot as described before its calibration.
        table : pandas.DataFrame
            Columns as in `poses.csv`; `pose` may be the index.

        Returns
        -------
        Dataset
        """
        if "pose" not in table.columns and table.index.name == "pose":
            table = table.reset_index()
        return cls(robot, table)

    @classmethod
    def parsed(cls, robot: Robot, poses: str) -> Dataset:
        """A robot with the text of a `poses.csv`, which is not checked here.

        Parameters
        ----------
        robot : Robot
            The robot that was measured.
        poses : str
            Content of `poses.csv`.

        Returns
        -------
        Dataset
        """
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
        return cls._of(robot, columns)

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

    def texts(self) -> tuple[str, str]:
        """`robot.json` and `poses.csv`.

        Returns
        -------
        tuple of str
        """
        return self.robot.text(), self._poses()

    @overload
    def __getitem__(self, key: str) -> NDArray[Any]: ...

    @overload
    def __getitem__(self, key: slice | Sequence[int] | Sequence[bool] | NDArray[Any]) -> Dataset: ...

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            return self._column(key)
        if isinstance(key, slice):
            return self._of(self.robot, {name: values[key].copy() for name, values in self.columns.items()})
        rows = np.asarray(key)
        if rows.ndim != 1 or (rows.dtype.kind not in "iub" and rows.size):
            kind = type(key).__name__
            raise TypeError(f"found {key!r} of type {kind}, expected the name of a column, a slice, a mask or a list of rows")
        if rows.dtype.kind == "b" and len(rows) != len(self):
            raise IndexError(f"found a mask of {len(rows)} values, expected {len(self)}")
        rows = rows if rows.size else rows.astype(np.int64)
        return self._of(self.robot, {name: values[rows] for name, values in self.columns.items()})

    def __setitem__(self, name: str, values: ArrayLike) -> None:
        column = _column(name, np.broadcast_to(values, len(self)) if np.ndim(values) == 0 else values)
        if self.columns and len(column) != len(self):
            raise TautlineError(f"columns, {name}: found {len(column)} values, expected {len(self)}")
        self.columns[name] = column

    def copy(self) -> Dataset:
        """A copy whose columns can be changed.

        Returns
        -------
        Dataset
        """
        robot = Robot(json.loads(self.robot.text()))
        return self._of(robot, {name: values.copy() for name, values in self.columns.items()})

    def per_cable(self, name: str) -> Array:
        """One column for each cable, side by side.

        Parameters
        ----------
        name : str
            Quantity and unit without the number of the cable: `rev`, `length_m`, `force_n`, `swivel_rad`.

        Returns
        -------
        ndarray
            Shape (poses, cables).

        Raises
        ------
        KeyError
            If there is no such column.
        """
        quantity, _, unit = name.partition("_")
        count = len(self.robot.cables)
        names = [f"{quantity}_{cable}" + (f"_{unit}" if unit else "") for cable in range(1, count + 1)]
        return np.column_stack([self._column(one) for one in names])

    def write(self, folder: Path) -> None:
        """Writes the dataset folder: `robot.json` and `poses.csv`, each atomically.

        Parameters
        ----------
        folder : str or path
            Folder, which is made if it does not exist.
        """
        _tautline.write_dataset(folder, *self.texts())

    def __repr__(self) -> str:
        return f"Dataset({self.robot!r}, {len(self)} poses)"


def presets() -> list[str]:
    """Names of the robots that come with the program.

    Returns
    -------
    list of str
    """
    return _tautline.presets_names()


def read_robot(path: Path) -> Robot:
    """Reads a `robot.json` or model file.

    Parameters
    ----------
    path : str or path
        File.

    Returns
    -------
    Robot
    """
    return Robot(json.loads(_tautline.read_robot(path)))


def read_dataset(folder: Path) -> Dataset:
    """Reads a dataset folder, with the hypotheses beside it and in the settings folder of the user.

    Parameters
    ----------
    folder : str or path
        Folder with `robot.json` and `poses.csv`.

    Returns
    -------
    Dataset

    Warns
    -----
    UserWarning
        What the operator should know, such as a column that is not known.
    """
    robot, poses, notices = _tautline.read_dataset(folder)
    for notice in notices:
        warnings.warn(notice, stacklevel=2)
    return Dataset.parsed(Robot(json.loads(robot)), poses)


def read_session(path: Path) -> Dataset:
    """Reads robot and measurements of a session.

    Parameters
    ----------
    path : str or path
        Session file of the window or of `tautline measure`.

    Returns
    -------
    Dataset
        Without the poses that were excluded.
    """
    robot, poses = _tautline.read_session(path)
    return Dataset.parsed(Robot(json.loads(robot)), poses)
