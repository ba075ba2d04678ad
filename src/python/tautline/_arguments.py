"""Arguments of the calls: what is of the wrong kind is a TypeError, what is of the right kind but wrong a TautlineError."""

from __future__ import annotations

import operator
from collections.abc import Iterable
from os import PathLike, fspath
from typing import Any

from ._data import Dataset, Effect, EffectLike, Path, Robot, to_json
from ._tautline import TautlineError


def _kind(value: object) -> str:
    return f"{value!r}" if isinstance(value, (str, int, float)) else f"a value of type {type(value).__name__}"


def whole(name: str, value: Any, least: int) -> int:
    """A whole number, of Python or NumPy."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: found {_kind(value)}, expected a whole number") from None
    if isinstance(value, bool):
        raise TypeError(f"{name}: found {value}, expected a whole number")
    if not least <= number < 2**63:
        raise TautlineError(f"{name}: found {number}, expected a whole number from {least} on")
    return number


def robot_text(robot: Robot, name: str = "robot") -> str:
    """`robot.json` of a robot."""
    if not isinstance(robot, Robot):
        raise TypeError(f'{name}: found {_kind(robot)}, expected a Robot, such as Robot.preset("mini") or read_robot("robot.json")')
    return robot.text()


def dataset_texts(dataset: Dataset, name: str = "dataset") -> tuple[str, str]:
    """`robot.json` and `poses.csv` of a dataset."""
    if not isinstance(dataset, Dataset):
        raise TypeError(f'{name}: found {_kind(dataset)}, expected a Dataset, such as read_dataset("run-7") or Dataset(robot, table)')
    return dataset.texts()


def effects_json(effects: EffectLike | Iterable[EffectLike]) -> str:
    """JSON of an effect or of several."""
    if isinstance(effects, (str, Effect)):
        effects = [effects]

    def wrong(value: object) -> TypeError:
        expected = 'an Effect, a text such as "winch_scale:cable-3", or a list of them'
        return TypeError(f"effects: found {_kind(value)}, expected {expected}")

    def document(effect: EffectLike) -> dict[str, Any]:
        if isinstance(effect, str):
            effect = Effect.parse(effect)
        if not isinstance(effect, Effect):
            raise wrong(effect)
        return effect.document()

    if not isinstance(effects, Iterable):
        raise wrong(effects)
    return to_json([document(effect) for effect in effects])


def paths(sources: Path | Iterable[Path]) -> list[Path]:
    """One path or several."""
    if isinstance(sources, (str, PathLike)):
        return [fspath(sources)]
    return [fspath(source) for source in sources]
