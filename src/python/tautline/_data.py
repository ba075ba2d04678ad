"""Robots, effects and datasets: what is calibrated, and what was measured on it."""

from __future__ import annotations

import csv
import io
import json
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    """An effect of the catalogue with its targets and the values of its parameters (SI units)."""

    effect: str
    targets: Sequence[str] = ()
    parameters: Mapping[str, float] = field(default_factory=dict)

    def document(self) -> dict[str, Any]:
        """As JSON has it."""
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
        return numbers([cable["pulley"]["entry_point_m"] for cable in self.description["cables"]])

    def with_hypothesis(self, text: str) -> Robot:
        """The same robot, which also knows the effect that the text of a hypothesis file states."""
        known = [*self.description.get("hypotheses", []), text]
        return Robot({**self.description, "hypotheses": known}).checked()

    def checked(self) -> Robot:
        """The same robot in its canonical form; raises what is wrong with it."""
        return Robot(json.loads(_tautline.checked_robot(self.text())))

    def write(self, path: Path) -> None:
        """Writes a `robot.json` or model file, atomically."""
        _tautline.write_robot(path, self.text())

    def text(self) -> str:
        """`robot.json`."""
        return to_json(self.description)

    def __repr__(self) -> str:
        return f"Robot({self.name!r}, {len(self.cables)} cables)"


@dataclass(repr=False)
class Dataset(Columns):
    """A robot and what was measured on it: one array for each column of `poses.csv`, NaN where a cell is empty."""

    robot: Robot
    columns: dict[str, NDArray[Any]]

    @classmethod
    def parsed(cls, robot: Robot, poses: str) -> Dataset:
        """A robot with the text of a `poses.csv`."""
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

    def texts(self) -> tuple[str, str]:
        """`robot.json` and `poses.csv`."""
        return self.robot.text(), self._poses()

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
        _tautline.write_dataset(folder, *self.texts())

    def __repr__(self) -> str:
        return f"Dataset({self.robot!r}, {len(self)} poses)"


def presets() -> list[str]:
    """Names of the robots that come with the program."""
    return _tautline.presets_names()


def read_robot(path: Path) -> Robot:
    """Reads a `robot.json` or model file."""
    return Robot(json.loads(_tautline.read_robot(path)))


def read_dataset(folder: Path) -> Dataset:
    """Reads a dataset folder, with the hypotheses beside it and in the settings folder of the user."""
    robot, poses, notices = _tautline.read_dataset(folder)
    for notice in notices:
        warnings.warn(notice, stacklevel=2)
    return Dataset.parsed(Robot(json.loads(robot)), poses)


def read_session(path: Path) -> Dataset:
    """Robot and measurements of a session file, without the poses that were excluded."""
    robot, poses = _tautline.read_session(path)
    return Dataset.parsed(Robot(json.loads(robot)), poses)
