"""Datasets and results as users of NumPy and pandas expect them."""

import pickle
from pathlib import Path

import numpy as np
import pandas
import pytest

import tautline


def test_a_table_of_pandas_is_a_dataset(run: tautline.Run) -> None:
    table = run.dataset.to_pandas()
    for data in [
        tautline.Dataset(run.dataset.robot, table),
        tautline.Dataset(run.dataset.robot, dict(run.dataset.columns)),
        tautline.Dataset(run.dataset.robot, run.dataset),
        tautline.Dataset.from_pandas(run.dataset.robot, table),
        tautline.Dataset.from_pandas(run.dataset.robot, table.set_index("pose")),
    ]:
        assert data.texts() == run.dataset.texts()


def test_missing_cells_of_pandas_are_missing_readings(run: tautline.Run) -> None:
    table = run.dataset.to_pandas()
    table["laser_m"] = table["laser_m"].astype("Float64")
    table.loc[3, "laser_m"] = pandas.NA
    data = tautline.Dataset(run.dataset.robot, table)
    assert np.flatnonzero(np.isnan(data["laser_m"])).tolist() == [3]
    assert tautline.identify(data).dof == tautline.identify(run.dataset).dof - 1


def test_columns_by_name(run: tautline.Run) -> None:
    data = run.dataset
    assert data["rev_1"] is data.columns["rev_1"]
    assert "rev_1" in data and "rev_9" not in data
    assert list(data) == list(data.columns)
    with pytest.raises(KeyError, match='no column "rev_9", expected one of pose'):
        data["rev_9"]
    with pytest.raises(KeyError, match="torque_1_nm"):
        data.per_cable("torque_nm")


def test_parts_of_a_dataset_are_datasets(run: tautline.Run) -> None:
    data = run.dataset
    assert data[:10]["pose"].tolist() == list(range(10))
    assert data[data["pose"] != 4]["pose"].tolist() == [0, 1, 2, 3, *range(5, 26)]
    assert data[[0, 7, 9]].per_cable("rev").shape == (3, 8)
    assert len(data[[]]) == 0
    assert tautline.identify(data[:15]).dof < tautline.identify(data).dof
    # A part is a copy.
    part = data[:10]
    part["laser_m"] = 1.0
    assert part["laser_m"].tolist() == [1.0] * 10 and data["laser_m"][0] != 1.0
    for key in [3, (1.0, 2.0)]:
        with pytest.raises(TypeError, match="expected the name of a column, a slice, a mask or a list of rows"):
            data[key]  # type: ignore[call-overload]
    with pytest.raises(IndexError, match="mask of 2 values, expected 26"):
        data[[True, False]]


def test_a_column_can_be_replaced(run: tautline.Run) -> None:
    data = run.dataset.copy()
    data["laser_m"] = data["laser_m"] + 0.001
    assert data["laser_m"][1] == run.dataset["laser_m"][1] + 0.001
    with pytest.raises(tautline.TautlineError, match="laser_m: found 2 values, expected 26"):
        data["laser_m"] = [1.0, 2.0]


def test_what_is_no_dataset_is_refused(run: tautline.Run) -> None:
    robot, columns = run.dataset.robot, run.dataset.columns
    with pytest.raises(TypeError, match="robot: found a value of type str, expected a Robot"):
        tautline.Dataset("mini", columns)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="columns: found a value of type int"):
        tautline.Dataset(robot, 5)
    with pytest.raises(TypeError, match="laser_m: found values of type object, expected numbers or texts"):
        tautline.Dataset(robot, {**columns, "laser_m": [{}] * 26})
    with pytest.raises(tautline.TautlineError, match="pose: found 0.5, expected whole numbers"):
        tautline.Dataset(robot, {**columns, "pose": columns["pose"] + 0.5})
    with pytest.raises(tautline.TautlineError, match=r"rev_1: found shape \(26, 2\)"):
        tautline.Dataset(robot, {**columns, "rev_1": np.zeros((26, 2))})
    with pytest.warns(UserWarning, match="laser_distance"):
        tautline.Dataset(robot, {**columns, "laser_distance": columns["laser_m"]})


def test_residuals_are_prediction_minus_reading(run: tautline.Run) -> None:
    fitted = tautline.identify(run.dataset)
    table = fitted.residuals
    lengths = table["reading"] == "length of cable-3"
    assert np.array_equal(table["pose"][lengths], run.dataset["pose"][1:])
    # Squares of the standardised residuals of readings, and of the home pose with its prior, sum to chi-square.
    squares = np.sum((table["residual"] / table["sd"]) ** 2)
    assert 0.5 * fitted.chi2 < squares <= fitted.chi2 * (1 + 1e-9)
    assert set(table["unit"]) <= {"m", "N", "rad"}
    assert set(table["pose"]) == set(run.dataset["pose"])
    assert table["pose"].dtype == np.int64
    frame = table.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == len(table)


def test_the_covariance_belongs_to_the_values(run: tautline.Run) -> None:
    fitted = tautline.identify(run.dataset, effects="winch_scale:cable-3")
    assert fitted.covariance.shape == (len(fitted.parameters),) * 2
    assert fitted.parameters == fitted.values["parameter"].tolist()
    np.testing.assert_allclose(np.sqrt(np.diag(fitted.covariance)), fitted.values["sd"], rtol=1e-12)
    assert np.all(np.linalg.eigvalsh(fitted.correlation) > 0.0)
    own = fitted.entry_points_covariance_m2
    np.testing.assert_allclose(np.sqrt(np.diagonal(own, axis1=1, axis2=2)), fitted.entry_points_sd_m, rtol=1e-12)
    place = fitted.parameters.index("cable-3 entry point x")
    np.testing.assert_allclose(fitted.covariance[place : place + 3, place : place + 3], own[2], rtol=1e-12)
    assert fitted.effects["effect"].tolist() == ["winch_scale"]
    assert fitted.effects["targets"].tolist() == ["cable-3"]


def test_results_are_tables(run: tautline.Run, tmp_path: Path) -> None:
    data = run.dataset
    results = [
        run,
        data,
        tautline.identify(data),
        tautline.identify(data).residuals,
        tautline.diagnose(data),
        tautline.plan(data.robot, poses=5, candidates=50),
        tautline.predict(data.robot, [[0, 0, 0, 1, 0, 0, 0]]),
        tautline.check(data),
        tautline.check(data, data),
        tautline.compare(data, data),
        tautline.effects(),
    ]
    for result in results:
        frame = result.to_pandas()
        assert len(frame.columns) >= 4, result
        html = result._repr_html_()
        assert html.startswith("<p>") and html.count("<tr>") >= min(len(frame), 10), result
        # As worker processes send them.
        assert pickle.loads(pickle.dumps(result))._repr_html_() == html
    assert tautline.predict(data.robot, [[0, 0, 0, 1, 0, 0, 0]]).to_pandas()["cable"].tolist() == data.robot.cables


def test_without_pandas_the_extra_is_named(run: tautline.Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'tautline\[pandas\]'"):
        run.dataset.to_pandas()


def test_texts_in_tables_are_escaped(run: tautline.Run) -> None:
    data = run.dataset.copy()
    data.robot.description["name"] = "<script>"
    assert "<script>" not in data._repr_html_()


def test_places_of_pulleys_are_a_robot(tmp_path: Path) -> None:
    robot = tautline.Robot.preset("hall")
    cables = robot.description["cables"]
    pulleys = robot.entry_points_m
    platform = np.array([cable["platform_anchor_m"] for cable in cables])
    drums = np.full(len(cables), 0.16)
    made = tautline.Robot.from_arrays(pulleys, platform, name="places", drum_diameters_m=drums)
    sheet = pandas.DataFrame({f"Pulley {axis} [mm]": 1e3 * pulleys[:, k] for k, axis in enumerate("xyz")})
    for k, axis in enumerate("xyz"):
        sheet[f"Platform {axis} [m]"] = platform[:, k]
    sheet["Drum radius [cm]"] = 8.0
    sheet.to_csv(tmp_path / "places.csv", index=False)
    np.savez(tmp_path / "places.npz", pulleys=pulleys, platform=platform, drum_diameter_m=drums)
    np.savez(tmp_path / "transposed.npz", A=pulleys.T, B=platform.T)
    for file in ("places.csv", "places.npz", "transposed.npz"):
        read = tautline.import_robot(tmp_path / file)
        assert np.allclose(read.entry_points_m, pulleys, atol=1e-12), file
        anchors = [cable["platform_anchor_m"] for cable in read.description["cables"]]
        assert np.allclose(anchors, platform, atol=1e-12), file
        if file.startswith("places"):
            assert np.allclose([cable["winch"]["drum_diameter_m"] for cable in read.description["cables"]], 0.16), file
            assert read.cables == made.cables and read.description["home"] == made.description["home"]
    planar = tautline.Robot.from_arrays(pulleys[:4, :2])
    assert planar.description["platform"]["free"] == ["x", "y"]
    with pytest.raises(ValueError, match="found 2 rows for 8 cables"):
        tautline.Robot.from_arrays(pulleys, platform[:2])
    with pytest.raises(ValueError, match=r"found an array of shape \(8,\), expected"):
        tautline.Robot.from_arrays(drums)
