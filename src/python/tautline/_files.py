"""Files of other programs in, tables and reports out, and the calibration tables of a dataset."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal

from . import _tautline
from ._arguments import dataset_texts, effects_json, paths, robot_text
from ._calls import fit_options
from ._data import Dataset, EffectLike, Path, Robot, to_json
from ._results import Channels, Import, Precalibration
from ._table import Table, table_of_rows
from ._tautline import TIME_LIMIT_S

_GIB = 1 << 30


def _import_options(
    recipe: Mapping[str, Any] | None,
    assign: Mapping[str, str],
    angles: str | None,
    align_clocks: bool,
    memory_limit_gib: float,
) -> _tautline.ImportOptions:
    return {
        "recipe": None if recipe is None else to_json({"format": "tautline-import-recipe", "version": 1, **recipe}),
        "assignments": [f"{column}={channel}" for column, channel in assign.items()],
        "angles": angles,
        "align_clocks": align_clocks,
        "apply_suggestions": False,
        "is_weighed": False,
        "memory_limit_bytes": int(memory_limit_gib * _GIB),
    }


def channels(
    sources: Path | Iterable[Path],
    robot: Robot,
    *,
    recipe: Mapping[str, Any] | None = None,
    assign: Mapping[str, str] = {},
    angles: str | None = None,
    align_clocks: bool = False,
    memory_limit_gib: float = 2.0,
) -> Channels:
    """Lists the channels of files of other programs, and what would become of them.

    Parameters
    ----------
    sources : str, path or sequence of them
        Files or folders with readings, such as CSV, TwinCAT Scope, Motive, Nexus, `.c3d`, `.mat`, `.npy`, `.parquet`, `.tdms`,
        `.mf4`, `.xlsx`, `.h5`, `.mcap`, `.bag`.
    robot : Robot
        The robot that was measured.
    recipe, assign, angles, align_clocks, memory_limit_gib
        As for `import_readings`.

    Returns
    -------
    Channels
        The channels, and the recipe for them.
    """
    options = _import_options(recipe, assign, angles, align_clocks, memory_limit_gib)
    document = json.loads(_tautline.channels(paths(sources), robot_text(robot), options))
    return Channels(document["recipe"], document["notices"], document)


def import_readings(
    sources: Path | Iterable[Path],
    robot: Robot,
    *,
    recipe: Mapping[str, Any] | None = None,
    assign: Mapping[str, str] = {},
    angles: str | None = None,
    align_clocks: bool = False,
    apply_suggestions: bool = False,
    weighed: bool = False,
    memory_limit_gib: float = 2.0,
) -> Import:
    """Makes a dataset from files written by other programs.

    Parameters
    ----------
    sources : str, path or sequence of them
        Files or folders with readings; see `channels`.
    robot : Robot
        The robot that was measured.
    recipe : mapping, optional
        Recipe that assigns channels to columns, such as that of an earlier import; by default one is proposed from names,
        units and ranges.
    assign : mapping of str to str, optional
        Channels by column of `poses.csv`, with their units: `{"rev_{i}": "theta(:,{i}) [rad]"}`.
    angles : str, optional
        Axes of the angles of commanded and measured poses, each about an axis of the turned frame, as in `zyx`.
    align_clocks : bool, optional
        Whether offset and drift of the clocks of further recorders are estimated from the motion that both recorded.
    apply_suggestions : bool, optional
        Whether the mistakes are corrected that the check of the readings suspects.
    weighed : bool, optional
        Whether the mass of the platform was weighed, so that it may correct the unit of the forces.
    memory_limit_gib : float, optional
        Largest memory for decoded content (GiB), as a small file can hold much.

    Returns
    -------
    Import
        The dataset, its recipe, suspected mistakes and notices.

    Raises
    ------
    TautlineError
        If a channel is missing, no pose is found, or the readings are impossible for this robot.
    """
    options = _import_options(recipe, assign, angles, align_clocks, memory_limit_gib)
    options |= {"apply_suggestions": apply_suggestions, "is_weighed": weighed}
    poses, text = _tautline.import_readings(paths(sources), robot_text(robot), options)
    document = json.loads(text)
    return Import(
        dataset=Dataset.parsed(robot, poses),
        recipe=document["recipe"],
        suggestions=[one["sentence"] for one in document["suggestions"]],
        applied=[one["sentence"] for one in document["applied"]],
        notices=document["notices"],
        document=document,
    )


def import_robot(sources: Path | Iterable[Path]) -> Robot:
    """Reads the robot that files of other programs describe.

    Parameters
    ----------
    sources : str, path or sequence of them
        A table of the places of the pulleys, the text of a firmware or simulator, cables and bodies of CASPR, or a model of WireX.

    Returns
    -------
    Robot
    """
    robot, _ = _tautline.import_robot(paths(sources))
    return Robot(json.loads(robot))


def precalibrate(folder: Path) -> Precalibration:
    """Fits winches, force sensors, home platform and cable elongation to the calibration tables of a dataset.

    Parameters
    ----------
    folder : str or path
        Dataset folder with `robot.json` and some of `winch.csv`, `force.csv`, `home.csv` and `elongation.csv`.

    Returns
    -------
    Precalibration
        The fits, and the robot with the fitted values.
    """
    text, robot, notices = _tautline.precalibrate(folder)
    document = json.loads(text)

    def table(name: str) -> Table:
        rows = document[name]
        return table_of_rows(name, list(rows[0]) if rows else [], rows)

    return Precalibration(
        winches=table("winches"),
        force_sensors=table("force_sensors"),
        home=document["home"],
        elongation=document["elongation"],
        model=Robot(json.loads(robot)),
        notices=notices,
        document=document,
    )


def export(
    dataset: Dataset,
    path: Path,
    tables: str | Sequence[Literal["poses", "values", "readings"]] = "poses",
    effects: EffectLike | Iterable[EffectLike] = (),
) -> None:
    """Writes readings or results as tables for other programs.

    Parameters
    ----------
    dataset : Dataset
        Robot and readings.
    path : str or path
        File to write: `.csv` or `.parquet` with one table, or `.mat` (MATLAB version 5) with one struct for each.
    tables : str or sequence of str, optional
        `poses`: the readings; `values`: the identified values; `readings`: every reading with its residual.
    effects : Effect, str or sequence of them, optional
        Effects that are identified for `values` and `readings`.
    """
    names: list[str] = [tables] if isinstance(tables, str) else list(tables)
    _tautline.export(path, dataset_texts(dataset), names, fit_options(effects=effects_json(effects)))


def report(
    dataset: Dataset,
    path: Path,
    *,
    sections: Sequence[str] = (),
    title: str = "",
    header: str = "",
    operator: str = "",
    company: str = "",
    tolerance_m: float | None = None,
    time_limit_s: float = TIME_LIMIT_S,
) -> None:
    """Identifies, diagnoses and writes a report. It has no picture of the robot; that of the command has.

    Parameters
    ----------
    dataset : Dataset
        Robot and readings, the home pose first.
    path : str or path
        File to write: `.html` or `.pdf`.
    sections : sequence of str, optional
        Parts to include: `result`, `robot`, `instruments`, `data`, `method`, `geometry`, `budget`, `fit`, `causes`, `accuracy`,
        `adjustments`, `limits`, `signatures`, `about`, `log`; by default all.
    title, header, operator, company : str, optional
        Title instead of the name of the robot, line above it, who made the measurements, and for whom.
    tolerance_m : float, optional
        Largest acceptable deviation of a pulley from the drawing (m), by which the report judges.
    time_limit_s : float, optional
        Time after which the diagnosis ends with the best answer so far (s).
    """
    options: _tautline.ReportOptions = {
        "sections": [sections] if isinstance(sections, str) else list(sections),
        "title": title,
        "header": header,
        "operator": operator,
        "company": company,
        "tolerance_m": tolerance_m,
        "time_limit_s": time_limit_s,
    }
    _tautline.report(path, dataset_texts(dataset), options)
