"""What the calls of the package give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

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
