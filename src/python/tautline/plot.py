"""Plots of results with matplotlib, which comes with `pip install 'tautline[plot]'`.

Every function draws into the axes that it is given, or into new ones, and returns them. Lengths are in millimetres.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ._results import Diagnosis, History, Identification, Plan
from ._table import optional

__all__ = ["correlation", "findings", "history", "plan", "pulleys", "residuals"]

_AXES = "xyz"
_WITHIN_95 = 1.96


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    return optional("matplotlib.pyplot", "plot").subplots(layout="constrained")[1]


def residuals(identification: Identification, ax: Any = None) -> Any:
    """Plots the normalised residuals of all readings over the poses, with suspect ones marked.

    Parameters
    ----------
    identification : Identification
        A result of the methods `joint` or `simple`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into.

    Returns
    -------
    matplotlib.axes.Axes
        The axes; residuals beyond the dashed lines occur in 3 of 1000 readings if model and noise are right.
    """
    ax = _axes(ax)
    table = identification.residuals
    kinds = np.array([name.split(" of ")[0] for name in table["reading"]])
    for kind in dict.fromkeys(kinds.tolist()):
        chosen = kinds == kind
        ax.plot(table["pose"][chosen], table["normalised_residual"][chosen], ".", label=kind)
    suspect = table["suspect"] == "yes"
    if suspect.any():
        style = {"markerfacecolor": "none", "markeredgecolor": "tab:red", "label": "suspect"}
        ax.plot(table["pose"][suspect], table["normalised_residual"][suspect], "o", **style)
    for limit in (-3.0, 3.0):
        ax.axhline(limit, color="gray", linestyle="--", linewidth=0.8)
    ax.set(xlabel="pose", ylabel="normalised residual")
    ax.legend()
    return ax


def pulleys(identification: Identification, ax: Any = None) -> Any:
    """Plots how far each entry point is from the drawing, along x, y and z, with 95 % intervals.

    Parameters
    ----------
    identification : Identification
        An identification.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    off = 1e3 * (identification.entry_points_m - identification.drawing.entry_points_m)
    half = 1e3 * _WITHIN_95 * np.nan_to_num(identification.entry_points_sd_m)
    places = np.arange(len(off))
    for axis, name in enumerate(_AXES):
        ax.errorbar(places + 0.2 * (axis - 1), off[:, axis], half[:, axis], fmt="o", capsize=3, label=name)
    ax.axhline(0.0, color="gray", linewidth=0.8)
    ax.set_xticks(places, identification.model.cables, rotation=45, ha="right")
    ax.set_ylabel("identified less drawing (mm)")
    ax.legend()
    return ax


def correlation(identification: Identification, ax: Any = None) -> Any:
    """Plots the correlation of the identified values as a matrix.

    Parameters
    ----------
    identification : Identification
        A result of the methods `joint` or `simple`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    image = ax.imshow(identification.correlation, cmap="RdBu_r", vmin=-1.0, vmax=1.0)
    names = identification.parameters
    ax.set_yticks(np.arange(len(names)), names, fontsize="xx-small")
    ax.set_xticks([])
    ax.figure.colorbar(image, ax=ax, label="correlation")
    return ax


def findings(diagnosis: Diagnosis, ax: Any = None) -> Any:
    """Plots the probabilities of the findings of a diagnosis, of their alternatives, and of further possible causes.

    Parameters
    ----------
    diagnosis : Diagnosis
        A diagnosis.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)

    def name(effect: str, targets: list[str]) -> str:
        return f"{effect} ({', '.join(targets)})" if targets else effect

    rows = []
    for one in diagnosis.findings:
        rows.append((name(one.effect, one.targets), one.probability, "tab:red"))
        rows += [(name(other.effect, other.targets), other.probability, "tab:orange") for other in one.alternatives]
    rows += [(name(other.effect, other.targets), other.probability, "tab:gray") for other in diagnosis.possible]
    if not rows:
        text = "the model explains the readings" if diagnosis.adequate else "nothing was found"
        ax.text(0.5, 0.5, text, ha="center", transform=ax.transAxes)
    names, probabilities, colours = (list(values) for values in zip(*rows, strict=True)) if rows else ([], [], [])
    places = np.arange(len(rows))
    ax.barh(places, probabilities, color=colours)
    ax.set_yticks(places, names)
    ax.invert_yaxis()
    ax.set(xlim=(0.0, 1.0), xlabel="probability")
    return ax


def plan(plan: Plan, ax: Any = None) -> Any:
    """Plots the expected standard deviation of the entry points over the number of measured poses.

    Parameters
    ----------
    plan : Plan
        A plan.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    ax.semilogy(1e3 * plan.entry_point_sd_after_m, ".-")
    ax.set(xlabel="measured poses", ylabel="standard deviation of entry points (mm)")
    return ax


def history(history: History, ax: Any = None) -> Any:
    """Plots how far each pulley has moved since the first session.

    Parameters
    ----------
    history : History
        The record of a robot.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    moved = history.entry_points_m - history.entry_points_m[0]
    distances = 1e3 * np.sqrt(np.nansum(moved**2, axis=2))
    dated = not np.isnat(history.times).any()
    for cable, distance in enumerate(distances.T):
        ax.plot(history.times if dated else np.arange(len(distance)), distance, ".-", label=f"cable {cable + 1}")
    ax.set(xlabel="" if dated else "session", ylabel="moved since the first session (mm)")
    ax.tick_params(axis="x", rotation=30)
    ax.legend()
    return ax
