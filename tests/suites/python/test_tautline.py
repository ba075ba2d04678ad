"""The Python package, against its own arithmetic where it has any and against formulas written here."""

import _thread
import json
import subprocess
import threading
from pathlib import Path

import numpy as np
import pytest
from arro3.core import Table

import tautline


def test_presets_are_robots() -> None:
    for name in tautline.presets():
        robot = tautline.Robot.preset(name)
        # A robot of a template has the title of the template.
        assert robot.name == name or name in {"spatial", "hangprinter", "facade"}
        assert robot.entry_points_m.shape == (len(robot.cables), 3)
        assert robot.checked().description == robot.description


def test_a_wrong_robot_is_refused_in_the_sentence_of_the_command() -> None:
    robot = tautline.Robot.preset("mini")
    robot.description["cables"][2]["winch"]["drum_diameter_m"] = -0.04
    with pytest.raises(tautline.TautlineError, match="/cables/2/winch/drum_diameter_m: found -0.04"):
        robot.checked()
    with pytest.raises(tautline.TautlineError, match='"maxi", expected one of mini'):
        tautline.Robot.preset("maxi")


def test_a_dataset_survives_writing_and_reading(run: tautline.Run, tmp_path: Path) -> None:
    run.dataset.write(tmp_path / "data")
    again = tautline.read_dataset(tmp_path / "data")
    assert again.robot.description == run.dataset.robot.description
    assert list(again.columns) == list(run.dataset.columns)
    for name, values in run.dataset.columns.items():
        np.testing.assert_array_equal(again.columns[name], values)


def test_lengths_are_those_of_circle_and_tangent() -> None:
    """The pulley's geometry from its definition: a circle of radius r through the entry point, tangent to the swivel axis."""
    robot = tautline.Robot.preset("mini")
    rng = np.random.default_rng(3)
    poses = np.hstack([rng.uniform(-0.1, 0.1, (20, 3)), np.tile([1.0, 0, 0, 0], (20, 1))])
    predicted = tautline.predict(robot, poses)
    for index, cable in enumerate(robot.description["cables"]):
        pulley = cable["pulley"]
        entry, axis = np.array(pulley["entry_point_m"]), np.array(pulley["swivel_axis"])
        axis = axis / np.linalg.norm(axis)
        radius = pulley["radius_m"]
        for row, pose in enumerate(poses):
            to_anchor = pose[:3] + np.array(cable["platform_anchor_m"]) - entry
            along = to_anchor @ axis
            across = np.linalg.norm(to_anchor - along * axis)
            # In the pulley's plane: centre at (radius, 0), anchor at (across, along).
            distance = np.hypot(across - radius, along)
            free = np.sqrt(distance**2 - radius**2)
            # From the entry point at angle pi around the centre, along the axis, to the tangent point.
            anchor_angle = np.arctan2(along, across - radius)
            tangent_angle = anchor_angle + np.arccos(radius / distance)
            wrap = (np.pi - tangent_angle) % (2 * np.pi)
            assert predicted.wrap_rad[row, index] == pytest.approx(wrap, abs=1e-9)
            assert predicted.length_m[row, index] == pytest.approx(free + radius * wrap, abs=1e-9)


def test_identification_explains_the_data_once_the_effect_is_free(run: tautline.Run) -> None:
    without = tautline.identify(run.dataset)
    fitted = tautline.identify(run.dataset, effects=["winch_scale:cable-3"])
    assert without.converged and fitted.converged
    assert fitted.chi2 < without.chi2 - 50
    error = fitted.entry_points_m - run.truth.entry_points_m
    # 24 errors: beyond 5 standard deviations with a probability below 2e-5.
    assert np.all(np.abs(error) < 5 * fitted.entry_points_sd_m)
    assert fitted.model.entry_points_m == pytest.approx(fitted.entry_points_m, abs=0)
    assert len(fitted.positions_m) == len(run.dataset)


def test_the_command_identifies_the_same(run: tautline.Run, tmp_path: Path, program: Path) -> None:
    run.dataset.write(tmp_path / "data")
    result = tmp_path / "result.json"
    subprocess.run([program, "identify", tmp_path / "data", "--json", result], check=True, stdout=subprocess.DEVNULL)
    document = json.loads(result.read_text())
    fitted = tautline.identify(run.dataset)
    np.testing.assert_array_equal(fitted.entry_points_m, np.array(document["entry_points_m"]))
    assert fitted.chi2 == document["chi2"]


def test_the_diagnosis_names_the_hidden_effect(run: tautline.Run) -> None:
    found = tautline.diagnose(run.dataset)
    assert not found.adequate
    assert [(f.verdict, f.effect, f.targets) for f in found.findings] == [("named", "winch_scale", ["cable-3"])]
    value, sd = found.findings[0].parameters["scale"]
    assert sd is not None and abs(value - 0.02) < 5 * sd
    assert 0.95 <= found.findings[0].probability <= 1.0
    assert "cable-3" in str(found.model.description["effects"])


def test_a_hypothesis_is_simulated_identified_and_named() -> None:
    page = (Path(__file__).parents[3] / "docs/HYPOTHESES.md").read_text(encoding="utf-8")
    text = page.split("```toml\n")[1].split("```")[0]
    robot = tautline.Robot.preset("mini").with_hypothesis(text)
    hidden = tautline.Effect("encoder_crosstalk", ["cable-3"], {"share": 0.01})
    run = tautline.simulate(robot, 40, seed=4, effects=[hidden])
    fitted = tautline.identify(run.dataset, effects=["encoder_crosstalk:cable-3"])
    share = fitted.model.description["effects"][0]["parameters"]["share"]
    assert abs(share - 0.01) < 1e-3
    found = tautline.diagnose(run.dataset)
    assert (found.findings[0].effect, found.findings[0].targets) == ("encoder_crosstalk", ["cable-3"])
    with pytest.raises(tautline.TautlineError, match="line 13, column 16: found N, expected"):
        robot.with_hypothesis(text.replace("paid_of(next)", "tension"))


def test_a_dataset_knows_the_hypotheses_of_the_settings_folder(settings: Path, tmp_path: Path, run: tautline.Run) -> None:
    page = (Path(__file__).parents[3] / "docs/HYPOTHESES.md").read_text(encoding="utf-8")
    text = page.split("```toml\n")[1].split("```")[0]
    (settings / "effects").mkdir(parents=True)
    (settings / "effects/crosstalk.toml").write_text(text, encoding="utf-8")
    run.dataset.write(tmp_path / "data")
    assert tautline.read_dataset(tmp_path / "data").robot.description["hypotheses"] == [text]


def test_a_plan_is_measured_in_its_own_coordinates() -> None:
    robot = tautline.Robot.preset("planar")
    planned = tautline.plan(robot, poses=6, candidates=300)
    assert planned.poses.shape == (6, 7)
    assert np.all(np.diff(planned.entry_point_sd_after_m[~np.isnan(planned.entry_point_sd_after_m)]) <= 1e-12)
    tautline.predict(robot, planned.poses)


def test_wrong_arguments_are_one_sentence(run: tautline.Run) -> None:
    for call, sentence in [
        (lambda: tautline.identify(run.dataset, method="best"), 'method: found "best"'),
        (lambda: tautline.identify(run.dataset, effects=["winch_scale:cable-9"]), "cable-9"),
        (lambda: tautline.identify(run.dataset, huber=-1.0), "huber: found -1"),
        (lambda: tautline.diagnose(run.dataset, alpha=2.0), "alpha: found 2"),
        (lambda: tautline.diagnose(run.dataset, time_limit_s=0.0), "time_limit_s: found 0"),
        (lambda: tautline.predict(run.dataset.robot, [[0.0, 0.0]]), r"shape \(1, 2\)"),
    ]:
        with pytest.raises(tautline.TautlineError, match=sentence):
            call()


def test_columns_of_different_lengths_are_refused(run: tautline.Run) -> None:
    columns = {**run.dataset.columns, "laser_m": run.dataset.columns["laser_m"][:-1]}
    with pytest.raises(tautline.TautlineError, match="expected one length"):
        tautline.identify(tautline.Dataset(run.dataset.robot, columns))


def test_readings_per_cable(run: tautline.Run) -> None:
    revolutions = run.dataset.per_cable("rev")
    assert revolutions.shape == (26, 8)
    np.testing.assert_array_equal(revolutions[:, 2], run.dataset.columns["rev_3"])
    assert run.dataset.per_cable("force_n").shape == (26, 8)


def test_results_say_what_they_are(run: tautline.Run) -> None:
    assert repr(run.dataset) == "Dataset(Robot('mini', 8 cables), 26 poses)"
    assert "degrees of freedom" in repr(tautline.identify(run.dataset))


def test_arrow_takes_a_dataset(run: tautline.Run) -> None:
    table = Table.from_arrow(run.dataset)
    assert table.column_names == list(run.dataset.columns)
    np.testing.assert_array_equal(table["laser_m"].to_numpy(), run.dataset.columns["laser_m"])


def test_ctrl_c_ends_a_long_call() -> None:
    """Without it this takes some seconds: 64 poses among 20,000 candidates."""
    robot = tautline.Robot.preset("mini")
    threading.Timer(0.2, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        tautline.plan(robot, poses=64, candidates=20_000)


def test_the_record_of_a_robot_is_arrays_with_dated_changes() -> None:
    year = Path(__file__).parents[3] / "sessions" / "year-of-mini"
    record = tautline.history(year)
    assert record.entry_points_m.shape == (7, 8, 3)
    assert record.times[3] == np.datetime64("2026-06-18T10:00:00")
    certain = [change for change in record.changes if change.probability > 0.95]
    assert [(change.targets, change.effect, change.between) for change in certain] == [
        (["cable-3"], None, (2, 3)),
        (["cable-6"], "winch_scale", (4, 5)),
    ]
    # The states before and after it differ by the jump.
    moved = record.entry_points_m[3, 2] - record.entry_points_m[2, 2]
    np.testing.assert_allclose(moved, certain[0].displacement_m, atol=1e-9)
    with pytest.raises(tautline.TautlineError, match="tolerance_m: found 0, expected a positive number"):
        tautline.history(Path(), tolerance_m=0.0)
    box = [[-0.1, -0.1, -0.1], [0.1, 0.1, 0.1]]
    of_position = tautline.history(year, position_tolerance_m=0.01, volume_m=box).document["next_calibration"]
    assert (of_position["tolerance_of"], of_position["volume_m"]) == ("position", box)
    with pytest.raises(tautline.TautlineError, match="volume_m: expected only with position_tolerance_m"):
        tautline.history(year, volume_m=box)


def test_a_health_check_sees_a_drum_that_winds_differently() -> None:
    robot = tautline.Robot.preset("mini")
    baseline = tautline.simulate(robot, poses=40, seed=1, nominal=True).dataset
    same = tautline.simulate(robot, poses=10, seed=2, nominal=True).dataset
    checked = tautline.check(same, baseline)
    assert checked.verdict == "unchanged", checked
    assert set(checked.detectable_m) == {f"cable-{k}" for k in range(1, 9)}
    fault = tautline.Effect("winch_scale", ["cable-3"], {"scale": 0.01})
    wound = tautline.simulate(robot, poses=10, seed=3, effects=[fault], nominal=True).dataset
    checked = tautline.check(wound, baseline)
    assert checked.verdict == "changed"
    assert (checked.changes[0].effect, checked.changes[0].targets) == ("winch_scale", ["cable-3"])
    assert "winch scale (cable-3)" in repr(checked)
