"""The commands from Python: effects, checks, comparisons, imports, reports and exports, beside the program."""

import json
import pickle
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest

import tautline

MINI = tautline.Robot.preset("mini")


def documents_of(program: Path, *arguments: str | Path) -> dict[str, Any]:
    run = subprocess.run([program, *arguments, "--json", "-"], check=True, capture_output=True)
    document: dict[str, Any] = json.loads(run.stdout)
    return document


def test_simulate_and_identify_take_the_same_effects() -> None:
    effect = tautline.Effect("winch_scale", "cable-3", {"scale": 0.02})
    text = "winch_scale:cable-3:scale=0.02"
    assert tautline.Effect.parse(text) == effect
    assert str(effect) == text
    runs = [tautline.simulate(MINI, 12, effects=one).dataset.texts() for one in (effect, text, [effect], (text,))]
    assert runs.count(runs[0]) == 4
    data = tautline.simulate(MINI, 25, effects=text).dataset
    for one in ["winch_scale:cable-3", tautline.Effect("winch_scale", ["cable-3"]), [effect]]:
        found = tautline.identify(data, effects=one).effects
        assert found["effect"].tolist() == ["winch_scale"]
        # 5 standard deviations are exceeded with a probability below 1e-6.
        assert abs(found["value"][0] - 0.02) < 5 * found["sd"][0]
    assert len(tautline.identify(data, effects="winch_scale").effects) == 8


def test_arguments_of_the_wrong_kind_are_type_errors(run: tautline.Run) -> None:
    cases: list[tuple[Any, str]] = [
        (lambda: tautline.simulate("mini"), "robot: found 'mini', expected a Robot, such as Robot.preset"),  # type: ignore[arg-type]
        (lambda: tautline.simulate(MINI, 2.5), "poses: found 2.5, expected a whole number"),  # type: ignore[arg-type]
        (lambda: tautline.simulate(MINI, "12"), "poses: found '12', expected a whole number"),  # type: ignore[arg-type]
        (lambda: tautline.simulate(MINI, True), "poses: found True, expected a whole number"),
        (lambda: tautline.simulate(MINI, effects=3), "effects: found 3, expected an Effect"),  # type: ignore[arg-type]
        (lambda: tautline.identify(run.dataset, effects=[3]), "effects: found 3, expected an Effect"),  # type: ignore[list-item]
        (lambda: tautline.identify("run-7"), "dataset: found 'run-7', expected a Dataset"),  # type: ignore[arg-type]
        (lambda: tautline.compare(run.dataset, MINI), "second: found a value of type Robot"),  # type: ignore[arg-type]
        (lambda: tautline.plan(MINI, poses=3.0), "poses: found 3.0"),  # type: ignore[arg-type]
    ]
    for call, sentence in cases:
        with pytest.raises(TypeError, match=sentence):
            call()


def test_values_that_are_wrong_are_value_errors(run: tautline.Run) -> None:
    data = run.dataset
    cases: list[tuple[Any, str]] = [
        (lambda: tautline.simulate(MINI, -1), "poses: found -1, expected a whole number from 1 on"),
        (lambda: tautline.simulate(MINI, np.int64(0)), "poses: found 0"),  # type: ignore[arg-type]
        (lambda: tautline.simulate(MINI, seed=-1), "seed: found -1, expected a whole number from 0 on"),
        (lambda: tautline.simulate(MINI, effects="winch_skale"), 'unknown effect "winch_skale"'),
        (lambda: tautline.simulate(MINI, effects="winch_scale:cable-3:scale=much"), 'found "scale=much", expected NAME=NUMBER'),
        (lambda: tautline.identify(data, method="published", effects="winch_scale"), "effects: found with method"),
        (lambda: tautline.identify(data, tolerances="usual"), 'tolerances: found "usual"'),  # type: ignore[arg-type]
        (lambda: tautline.compare(data, data, level=2.0), "level: found 2"),
        (lambda: tautline.evaluate(data, tautline.Robot.preset("planar")), "model: found 4 cables, expected the 8"),
        (lambda: tautline.export(data, "data.xls"), "found data.xls, expected a file that ends in .csv, .parquet or .mat"),
        (lambda: tautline.export(data, "data.csv", ["poses", "values"]), "tables: found 2 for data.csv"),
        (lambda: tautline.export(data, "data.csv", ["pulleys"]), 'tables: found "pulleys"'),  # type: ignore[list-item]
        (lambda: tautline.report(data, "report.txt"), "expected a name that ends with .html or .pdf"),
        (lambda: tautline.report(data, "a.html", sections=["all"]), 'sections: found "all"'),
        (lambda: tautline.report(data, "a.html", tolerance_m=-1.0), "tolerance_m: found -1"),
        (lambda: tautline.import_readings("nowhere.csv", MINI), "nowhere.csv: not found"),
    ]
    for call, sentence in cases:
        with pytest.raises(ValueError, match=sentence) as raised:
            call()
        assert raised.type is tautline.TautlineError


def test_errors_reach_other_processes() -> None:
    error = pickle.loads(pickle.dumps(tautline.TautlineError("found nothing")))
    assert type(error) is tautline.TautlineError and str(error) == "found nothing"


def test_the_effects_are_those_of_the_command(program: Path) -> None:
    listed = tautline.effects()
    document = documents_of(program, "effects")
    assert listed["effect"].tolist() == [one["effect"] for one in document["effects"]]
    row = listed["effect"].tolist().index("cable_slip")
    assert (listed["parameters"][row], listed["units"][row]) == ("step, pose", "m, 1")
    assert not listed["can_be_estimated"][listed["effect"].tolist().index("cable_swap")]


def test_the_published_method_is_that_of_the_command(run: tautline.Run, tmp_path: Path, program: Path) -> None:
    run.dataset.write(tmp_path / "data")
    document = documents_of(program, "identify", tmp_path / "data", "--method", "published")
    fitted = tautline.identify(run.dataset, method="published")
    np.testing.assert_array_equal(fitted.entry_points_m, np.array(document["entry_points_m"]))
    assert np.isnan(fitted.entry_points_sd_m).all()
    assert "entry points" not in repr(fitted)
    with pytest.raises(tautline.TautlineError, match="no standard deviations"):
        fitted.covariance  # noqa: B018


def test_readiness_is_that_of_the_command(tmp_path: Path, program: Path) -> None:
    data = tautline.simulate(MINI, 25, seed=1).dataset
    data.write(tmp_path / "data")
    found = tautline.check(data)
    # Random poses determine the geometry, and do not show all faults.
    assert found.table()["outcome"].tolist() == ["pass", "pass", "pass", "notice"]
    assert found.ready and "kinds of fault" in repr(found)
    answer = subprocess.run([program, "check", tmp_path / "data", "--explain", "--json", "-"], capture_output=True)
    assert answer.returncode == 0
    assert json.loads(answer.stdout)["checks"] == found.document["checks"]
    spoilt = data.copy()
    spoilt["rev_3"] = np.nan
    refused = tautline.check(spoilt)
    assert not refused.ready and "cable-3" in repr(refused)


def test_a_model_is_evaluated_on_other_readings(run: tautline.Run, tmp_path: Path, program: Path) -> None:
    fitted = tautline.identify(run.dataset, effects="winch_scale:cable-3")
    later = tautline.simulate(run.truth, 15, seed=9, nominal=True).dataset
    good, bad = tautline.evaluate(later, fitted.model), tautline.evaluate(later, MINI)
    assert good.chi2 < 0.1 * bad.chi2
    np.testing.assert_array_equal(good.entry_points_m, fitted.entry_points_m)
    later.write(tmp_path / "later")
    fitted.model.write(tmp_path / "model.json")
    document = documents_of(program, "evaluate", tmp_path / "later", "--model", tmp_path / "model.json")
    assert document["chi2"] == good.chi2


def test_a_moved_pulley_is_found_by_comparison(tmp_path: Path, program: Path) -> None:
    first = tautline.simulate(MINI, 25, seed=3, nominal=True).dataset
    moved = tautline.Robot.preset("mini")
    moved.description["cables"][4]["pulley"]["entry_point_m"][0] += 0.03
    second = tautline.simulate(moved, 25, seed=4, nominal=True).dataset
    # The drawing of the second is that of the first: the move is what the readings say.
    second = tautline.Dataset(MINI, second)
    compared = tautline.compare(first, second)
    assert compared.different and compared.moved == ["cable-5"]
    row = compared.table()
    assert abs(row["moved_x_m"][4] - 0.03) < 5 * row["moved_sd_x_m"][4]
    for name, data in [("first", first), ("second", second)]:
        data.write(tmp_path / name)
    document = documents_of(program, "compare", tmp_path / "first", tmp_path / "second")
    assert document == compared.document
    assert not tautline.compare(first, first).different


def test_a_log_is_imported_and_its_recipe_used_again(run: tautline.Run, tmp_path: Path) -> None:
    log = run.dataset.to_pandas().rename(columns={f"rev_{cable}": f"Enc{cable} [rev]" for cable in range(1, 9)})
    log.to_csv(tmp_path / "log.csv", index=False)
    listed = tautline.channels(tmp_path / "log.csv", MINI)
    assert "Enc3" in listed.to_pandas()["name"].str.cat()
    imported = tautline.import_readings(tmp_path / "log.csv", MINI)
    assert imported.document["proposed"]
    np.testing.assert_allclose(imported.dataset.per_cable("rev"), run.dataset.per_cable("rev"), atol=1e-9)
    again = tautline.import_readings([tmp_path / "log.csv"], MINI, recipe=imported.recipe)
    assert not again.document["proposed"]
    assert again.dataset.texts() == imported.dataset.texts()
    set_by_hand = tautline.import_readings(tmp_path / "log.csv", MINI, assign={"rev_{i}": "Enc{i} [rev]"})
    assert set_by_hand.dataset.texts() == imported.dataset.texts()
    with pytest.raises(tautline.TautlineError, match="assign: "):
        tautline.import_readings(tmp_path / "log.csv", MINI, assign={"rev_{i}": "Encoder{i} [rev]"})


def test_swapped_units_are_suggested_and_corrected(run: tautline.Run, tmp_path: Path) -> None:
    log = run.dataset.to_pandas()
    log["laser_m"] *= 1000.0
    log.to_csv(tmp_path / "log.csv", index=False)
    corrected = tautline.import_readings(tmp_path / "log.csv", MINI, apply_suggestions=True)
    assert corrected.applied
    np.testing.assert_allclose(corrected.dataset["laser_m"], run.dataset["laser_m"], atol=1e-6)


def test_calibration_tables_give_a_robot(tmp_path: Path, program: Path) -> None:
    subprocess.run([program, "simulate", "--robot", "mini", "--phases", "-o", tmp_path / "phases", "--quiet"], check=True)
    fits = tautline.precalibrate(tmp_path / "phases")
    assert len(fits.winches) == 8
    assert fits.document == documents_of(program, "precalibrate", tmp_path / "phases")
    own = fits.model.description["cables"][0]["winch"]
    assert own != MINI.description["cables"][0]["winch"]
    tautline.simulate(MINI, 3).dataset.write(tmp_path / "none")
    with pytest.raises(tautline.TautlineError, match="none: found none of winch.csv"):
        tautline.precalibrate(tmp_path / "none")


def test_exports_are_those_of_the_command(run: tautline.Run, tmp_path: Path, program: Path) -> None:
    run.dataset.write(tmp_path / "data")
    for table in ("poses", "values", "readings"):
        tautline.export(run.dataset, tmp_path / "python.csv", table)
        command = [program, "export", tmp_path / "data", "--table", table, "-o", tmp_path / f"{table}.csv", "--quiet"]
        subprocess.run(command, check=True)
        assert (tmp_path / "python.csv").read_bytes() == (tmp_path / f"{table}.csv").read_bytes()
    tautline.export(run.dataset, tmp_path / "all.mat", ["poses", "values", "readings"])
    assert (tmp_path / "all.mat").read_bytes().startswith(b"MATLAB 5.0")
    frame = pandas.read_csv(tmp_path / "readings.csv")
    np.testing.assert_array_equal(frame["residual"], tautline.identify(run.dataset).residuals["residual"])


def test_a_report_has_the_parts_that_were_asked_for(run: tautline.Run, tmp_path: Path) -> None:
    tautline.report(run.dataset, tmp_path / "all.html", title="Cell <3>", operator="B. Smith", tolerance_m=0.02)
    text = (tmp_path / "all.html").read_text(encoding="utf-8")
    assert "Cell &lt;3&gt;" in text and "B. Smith" in text and ">Uncertainty<" in text
    tautline.report(run.dataset, tmp_path / "short.html", sections=["result", "geometry"])
    assert "Budget of uncertainty" not in (tmp_path / "short.html").read_text(encoding="utf-8")
    tautline.report(run.dataset, tmp_path / "short.pdf", sections="result")
    assert (tmp_path / "short.pdf").read_bytes().startswith(b"%PDF")
