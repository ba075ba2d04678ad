"""What the calls of the package give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._data import Dataset, Robot
from ._table import Array


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


@dataclass
class Change:
    """A part that moved or changed between two sessions, or since a baseline."""

    targets: list[str]
    """Names of its cables; none for the target plane and effects of the whole robot."""
    effect: str | None
    """None for a moved pulley or target plane."""
    between: tuple[int, int] | None
    """Indices of the sessions before and after it; None for a health check."""
    probability: float
    displacement_m: Array | None
    """Along x, y, z (m); None for an effect."""
    displacement_sd_m: Array | None
    change: float | None
    """Change of the effect's parameter (SI unit); None for a displacement."""
    change_sd: float | None


@dataclass(repr=False)
class History:
    """The life of one robot."""

    sessions: list[str]
    """Names of files or folders, in the order of time."""
    times: NDArray[np.datetime64]
    """When their poses were read, as datetime64 (UTC); NaT where unknown."""
    entry_points_m: Array
    """Sessions by cables by 3 (m), with all sessions taken into account; NaN for coordinates that are known exactly."""
    entry_points_sd_m: Array
    changes: list[Change]
    notices: list[str]
    document: dict[str, Any]

    def __repr__(self) -> str:
        return f"History({len(self.sessions)} sessions, {len(self.changes)} changes)"


@dataclass(repr=False)
class Check:
    """Whether a robot is as it was at its calibration."""

    verdict: str
    """`unchanged`, `changed` or `undecided`."""
    probability_unchanged: float
    changes: list[Change]
    detectable_m: dict[str, float | None]
    """Move of each pulley that would be found with 95 % probability (m); None if none would."""
    sentences: list[str]
    document: dict[str, Any]

    def __repr__(self) -> str:
        return f"Check({self.verdict}: {self.sentences[0]})"
