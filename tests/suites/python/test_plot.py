"""Plots of results: what is drawn is what the results say."""

from collections.abc import Iterator
from pathlib import Path

import matplotlib
import numpy as np
import pytest

import tautline

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    pyplot.close("all")


def test_residuals_are_drawn_with_their_suspects(run: tautline.Run) -> None:
    fitted = tautline.identify(run.dataset)
    ax = tautline.plot.residuals(fitted)
    lines = {line.get_label(): line for line in ax.lines}
    drawn = sum(len(line.get_xdata()) for name, line in lines.items() if name in {"length", "tension", "laser distance", "laser"})
    assert drawn > 0.5 * len(fitted.residuals)
    assert "suspect" in lines
    assert len(lines["suspect"].get_xdata()) == np.count_nonzero(fitted.residuals["suspect"] == "yes")


def test_pulleys_are_drawn_off_the_drawing_in_millimetres(run: tautline.Run) -> None:
    fitted = tautline.identify(run.dataset, effects="winch_scale:cable-3")
    figure, given = pyplot.subplots()
    ax = tautline.plot.pulleys(fitted, given)
    assert ax is given
    off = 1e3 * (fitted.entry_points_m - fitted.drawing.entry_points_m)
    for axis in range(3):
        np.testing.assert_allclose(ax.containers[axis].lines[0].get_ydata(), off[:, axis])
    assert [tick.get_text() for tick in ax.get_xticklabels()] == fitted.model.cables
    figure.canvas.draw()


def test_correlation_is_a_matrix_of_all_values(run: tautline.Run) -> None:
    fitted = tautline.identify(run.dataset)
    ax = tautline.plot.correlation(fitted)
    assert ax.images[0].get_array().shape == fitted.covariance.shape


def test_findings_are_bars_with_their_probability(run: tautline.Run) -> None:
    found = tautline.diagnose(run.dataset)
    ax = tautline.plot.findings(found)
    assert ax.get_yticklabels()[0].get_text() == "winch_scale (cable-3)"
    assert ax.patches[0].get_width() == found.findings[0].probability
    sound = tautline.diagnose(tautline.simulate(run.dataset.robot, 25, seed=2).dataset)
    assert sound.adequate and not sound.findings
    assert len(tautline.plot.findings(sound).patches) == len(sound.possible)


def test_the_plan_is_a_falling_curve(run: tautline.Run) -> None:
    planned = tautline.plan(run.dataset.robot, poses=8, candidates=100)
    line = tautline.plot.plan(planned).lines[0]
    np.testing.assert_allclose(line.get_ydata(), 1e3 * planned.entry_point_sd_after_m)


def test_the_history_is_one_line_for_each_pulley() -> None:
    record = tautline.history(Path(__file__).parents[3] / "sessions" / "year-of-mini")
    ax = tautline.plot.history(record)
    assert len(ax.lines) == 8
    moved = record.entry_points_m[-1, 2] - record.entry_points_m[0, 2]
    assert ax.lines[2].get_ydata()[-1] == pytest.approx(1e3 * np.linalg.norm(moved))


def test_without_matplotlib_the_extra_is_named(run: tautline.Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.pyplot", None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'tautline\[plot\]'"):
        tautline.plot.plan(tautline.plan(run.dataset.robot, poses=3, candidates=30))
