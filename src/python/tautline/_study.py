"""Studies: many simulated calibrations, in chunks on any number of processes and machines."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _tautline
from ._arguments import whole
from ._data import Path, to_json
from ._table import Columns, numbers

_COMBINATION = ("size_m", "home_sd_m", "inclinometer_sd_rad", "length_sd_m", "tension_sd_n")
_EXPECTED = ("position_m", "entry_m", "position_m_per_kelvin")


def _cells(robots: list[str], cells: Iterable[dict[str, Any]]) -> dict[str, NDArray[Any]]:
    """One array for each quantity of the cells; NaN where it is as the robot states it, or open."""
    cells = list(cells)
    combinations = [cell["combination"] for cell in cells]

    def texts(values: list[str]) -> NDArray[Any]:
        return np.array(values, dtype=np.str_)

    columns = {
        "robot": texts([robots[one["robot"]] for one in combinations]),
        "laser": texts([one["laser"] for one in combinations]),
        "laser_sd_m": numbers([cell["laser_sd_m"] for cell in cells]),
        "poses": np.array([one["poses"] for one in combinations], dtype=np.int64),
        "choice": texts([one["choice"] for one in combinations]),
        "method": texts([one["method"] for one in combinations]),
    }
    columns |= {name: numbers([one[name] for one in combinations]) for name in _COMBINATION}
    columns |= {f"expected_{name}": numbers([cell["expected"][name] for cell in cells]) for name in _EXPECTED}
    return columns


@dataclass(repr=False, eq=False)
class StudyResult(Columns):
    """The merged result of a study.

    Attributes
    ----------
    calibrations : int
        Number of simulated calibrations.
    columns : dict of str to ndarray
        One row for each cell: what the cell is, what the expected covariance says, and what simulation found: root mean square
        errors (m), simulated over expected position error with its 95 % interval, and whether they differ by more than 5 %.
    document : dict
        Document of the command.
    """

    calibrations: int
    columns: dict[str, NDArray[Any]]
    document: dict[str, Any]

    @classmethod
    def _of(cls, robots: list[str], document: dict[str, Any]) -> StudyResult:
        """The result of a study of these robots from its document."""
        cells = document["cells"]
        found = [cell["simulated"] or {} for cell in cells]
        columns = _cells(robots, cells)
        columns["calibrations"] = np.array([one.get("calibrations", 0) for one in found], dtype=np.int64)
        for name in ("position", "entry", "accuracy", "position_with_fault"):
            columns[f"simulated_{name}_m"] = numbers([(one.get(name) or {}).get("rms_m") for one in found])
        ratios = numbers([one.get("over_expected") or [None] * 3 for one in found]).reshape(-1, 3)
        for index, name in enumerate(("over_expected", "over_expected_low", "over_expected_high")):
            columns[name] = ratios[:, index]
        columns["is_marked"] = np.array([one.get("is_marked", False) for one in found], dtype=np.bool_)
        return cls(document["calibrations"], columns, document)

    def __repr__(self) -> str:
        marked = int(self.columns["is_marked"].sum())
        return f"StudyResult({len(self)} cells, {self.calibrations} calibrations, {marked} cells marked)"


@dataclass(repr=False, eq=False)
class Study(Columns):
    """A study of many simulated calibrations that is planned, in its folder.

    Attributes
    ----------
    folder : path
        Folder of the study.
    columns : dict of str to ndarray
        One row for each cell, as the expected covariance answers it.
    document : dict
        Plan of the study.
    """

    folder: FilePath
    columns: dict[str, NDArray[Any]]
    document: dict[str, Any]

    @classmethod
    def plan(cls, study: Path | Mapping[str, Any], folder: Path) -> Study:
        """Plans a study and writes its folder.

        Parameters
        ----------
        study : str, path or mapping
            Study file (TOML), or a mapping with the same keys.
        folder : str or path
            Folder to write.

        Returns
        -------
        Study
        """
        if isinstance(study, Mapping):
            text, robots = to_json({"format": "tautline-study", "version": 1, **study}), FilePath()
        else:
            text, robots = _tautline.study_from_toml(study), FilePath(study).parent
        return cls._of(folder, _tautline.plan_study(text, robots, folder))

    @classmethod
    def open(cls, folder: Path) -> Study:
        """Opens a study that was planned before.

        Parameters
        ----------
        folder : str or path
            Folder of the study.

        Returns
        -------
        Study
        """
        return cls._of(folder, _tautline.read_study(folder))

    @classmethod
    def _of(cls, folder: Path, plan: str) -> Study:
        document = json.loads(plan)
        return cls(FilePath(folder), _cells(cls._robots(document), document["cells"]), document)

    @staticmethod
    def _robots(document: dict[str, Any]) -> list[str]:
        return [str(robot["name"]) for robot in document["robots"]]

    def run(self, chunk: tuple[int, int] | None = None, threads: int | None = None) -> int:
        """Simulates all chunks, or one of them; those that are there are not done again.

        Parameters
        ----------
        chunk : tuple of int, optional
            Number of a chunk and how many there are, `(3, 7)`.
        threads : int, optional
            Number of threads; by default the number of processor cores.

        Returns
        -------
        int
            Number of chunks that were done.
        """
        part = None if chunk is None else f"{chunk[0]}/{chunk[1]}"
        if threads is not None:
            threads = whole("threads", threads, 1)
        done, _ = _tautline.run_study(self.folder, part, threads)
        return done

    def merge(self) -> StudyResult:
        """Joins the chunks.

        Returns
        -------
        StudyResult

        Raises
        ------
        TautlineError
            If a chunk is missing or damaged, or chunks do not belong together.
        """
        document = json.loads(_tautline.merge_study(self.folder))
        return StudyResult._of(self._robots(self.document), document)

    def report(self, out: Path) -> None:
        """Writes the report of the merged result.

        Parameters
        ----------
        out : str or path
            File to write: `.html` or `.pdf`.
        """
        _tautline.report_study(self.folder, out)

    def calibrations(self) -> dict[str, NDArray[Any]]:
        """Every calibration of the chunks that are there, in the order of the study.

        Returns
        -------
        dict of str to ndarray
            One array for each quantity, with one value for each calibration.
        """
        columns = _tautline.study_calibrations(self.folder)
        return {name: np.frombuffer(data, kind) for name, kind, data in columns}

    def __repr__(self) -> str:
        return f"Study({self.document['study']['name']!r}, {len(self)} cells)"
