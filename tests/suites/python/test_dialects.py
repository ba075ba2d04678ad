"""What is exported for other programs, judged by these programs: MuJoCo itself, and the kinematics of RepRapFirmware's Hangprinter
rewritten from its documentation."""

import json
import re
import subprocess
from pathlib import Path

import mujoco
import numpy as np
import numpy.typing as npt
import pytest

SAMPLES = Path(__file__).parents[1] / "fuzz/seeds/foreign_file"
Array = npt.NDArray[np.float64]


def tautline(program: Path, *arguments: str | Path) -> str:
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def path_length(anchor: Array, entry: Array, axis: Array, radius: float) -> float:
    """Length of a cable from its entry point over a swivel pulley to the anchor."""
    way = anchor - entry
    along = way @ axis
    beside = np.linalg.norm(way - along * axis) - radius
    distance = np.hypot(beside, along)
    free = np.sqrt(distance**2 - radius**2)
    wrap = np.arccos(free / distance) + np.arccos(along / distance)
    return float(free + radius * wrap)


class Hangprinter:
    """Lines of RepRapFirmware by the meaning of M666 and M669 in its dictionary of G-codes; lengths in mm."""

    def __init__(self, config: str) -> None:
        values: dict[str, list[float]] = {}
        for line in config.splitlines():
            command, *words = line.split(";")[0].split() or [""]
            for word in words:
                if command in ("M666", "M669"):
                    values[f"{command}{word[0]}"] = [float(part) for part in word[1:].split(":")]
        self.anchors = np.array([values[f"M669{letter}"] for letter in "ABCD"])
        self.radius = np.array(values["M666R"])
        strands, lines, motor, spool = (np.array(values[f"M666{letter}"]) for letter in "UOLH")
        # Squared radius of a spool that holds one mm more of the line between mover and anchor.
        self.build_up = strands * lines * values["M666Q"][0]
        self.gear = strands * spool / motor

    def line(self, position: Array) -> Array:
        return np.linalg.norm(self.anchors - position, axis=1) - np.linalg.norm(self.anchors, axis=1)

    def revolutions(self, position: Array) -> Array:
        """A motor turns by the integral of gear / (2 pi r(l)) over the line l that it lets go, r(l)^2 = R^2 - build_up l."""
        line = self.line(position)
        parts, weights = np.polynomial.legendre.leggauss(24)
        at = (parts[:, None] + 1) / 2 * line
        radius = np.sqrt(self.radius**2 - self.build_up * at)
        return np.asarray(line / 2 * (weights @ (self.gear / (2 * np.pi * radius))))

    def position(self, revolutions: Array) -> Array:
        """Where the firmware takes the mover to be."""
        position = np.zeros(3)
        for _ in range(30):
            error = self.revolutions(position) - revolutions
            step = 1e-3
            moved = [self.revolutions(position + step * axis) - self.revolutions(position - step * axis) for axis in np.eye(3)]
            change, *_ = np.linalg.lstsq(np.array(moved).T / (2 * step), error, rcond=None)
            position = position - change
        return position


def model_of_hangprinter(program: Path, folder: Path, radius: float) -> dict:
    """The sample as it really is: pulleys, displaced entry points, one drum that is larger, more build-up."""
    file = folder / "robot.json"
    tautline(program, "import", SAMPLES / "config.g", "-o", file)
    robot = json.loads(file.read_text())
    del robot["platform"]["mass_kg"]
    for number, cable in enumerate(robot["cables"]):
        cable["cable"] = {}
        cable["pulley"]["radius_m"] = radius
        # The line to the ceiling arrives from the side, so that the mover is not on the axis about which its pulley swivels.
        cable["pulley"]["swivel_axis"] = [1, 0, 0] if number == 3 else [0, 0, 1]
        cable["pulley"]["entry_point_m"][number % 3] += 0.012
        cable["pulley"]["entry_point_sd_m"] = 0.001
    robot["effects"].append({"effect": "winch_scale", "targets": ["B"], "parameters": {"scale": 0.004}})
    centre = {"position_m": [0, 0, 0.6], "orientation_wxyz": [1, 0, 0, 0]}
    robot["limits"] = {"workspace": {"center": centre, "half_extent_m": [0.5, 0.5, 0.5], "half_rotation_rad": 0}}
    file.write_text(json.dumps(robot))
    return robot


def true_revolutions(robot: dict, position: Array) -> Array:
    """Revolutions of the motors of the model, from its closed form; position in m."""
    growth = {one["targets"][0]: one["parameters"]["growth"] for one in robot["effects"] if one["effect"] == "drum_growth"}
    revolutions = []
    for cable in robot["cables"]:
        pulley, winch = cable["pulley"], cable["winch"]
        entry, axis = np.array(pulley["entry_point_m"]), np.array(pulley["swivel_axis"])
        ends = [path_length(at, entry, axis, pulley["radius_m"]) for at in (position, np.zeros(3))]
        scale = 1.004 if cable["name"] == "B" else 1.0
        paid = (ends[0] - ends[1]) / (np.pi * winch["drum_diameter_m"] / winch["gear_ratio"] * scale)
        g = growth[cable["name"]]
        revolutions.append(2 * paid / (1 + np.sqrt(1 + 4 * g * paid)))
    return np.array(revolutions)


@pytest.mark.parametrize("radius", [0.0, 0.015])
def test_a_hangprinter_with_these_lines_errs_as_stated(program: Path, tmp_path: Path, radius: float) -> None:
    robot = model_of_hangprinter(program, tmp_path, radius)
    out = tmp_path / "new.g"
    said = tautline(program, "export", tmp_path / "robot.json", "--for", "reprap", "--onto", SAMPLES / "config.g", "-o", out)
    stated = re.search(r"as it is: ([\d.]+) mm expected. These lines: ([\d.]+) mm expected", said)
    assert stated, said
    rng = np.random.default_rng(3)
    for text, expected in zip([(SAMPLES / "config.g").read_text(), out.read_text()], map(float, stated.groups())):
        firmware = Hangprinter(text)
        missed = []
        for _ in range(200):
            position = np.array([0, 0, 0.6]) + rng.uniform(-0.5, 0.5, 3)
            revolutions = true_revolutions(robot, position)
            missed.append(1e-3 * firmware.position(revolutions) - position)
        rms = 1e3 * np.sqrt(np.mean(np.sum(np.square(missed), axis=1)))
        assert abs(rms - expected) < 0.02 + 0.15 * expected, (rms, expected)
    if radius == 0.0:
        # The model's own values, but for the build-up, which is common to all spools: the larger one of B would have more.
        for number, (anchor, cable) in enumerate(zip(Hangprinter(out.read_text()).anchors, robot["cables"])):
            assert np.abs(anchor - 1e3 * np.array(cable["pulley"]["entry_point_m"])).max() < 0.1, number
        assert "Not expressible" not in said


def test_the_text_of_the_user_keeps_everything_else(program: Path, tmp_path: Path) -> None:
    model_of_hangprinter(program, tmp_path, 0.0)
    own = tmp_path / "config.g"
    text = "; my machine\n" + (SAMPLES / "config.g").read_text() + "M208 Z2000 ; mine\n"
    own.write_text(text)
    out = tmp_path / "new.g"
    tautline(program, "export", tmp_path / "robot.json", "--for", "reprap", "--onto", own, "-o", out)
    assert own.read_text() == text
    changed = [old for old, new in zip(text.splitlines(), out.read_text().splitlines(), strict=True) if old != new]
    assert [line.split()[0] for line in changed] == ["M669", "M666"]


def lengths_of_tendons(file: Path, poses: list[tuple[Array, Array]]) -> Array:
    """Lengths of all tendons with the platform at each pose (position, quaternion), each pulley towards its cable."""
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    platform = model.body("platform")
    address = model.jnt_qposadr[platform.jntadr[0]]
    lengths = []
    for position, quaternion in poses:
        data.qpos[address : address + 7] = [*position, *quaternion]
        for number in range(1, model.ntendon + 1):
            try:
                joint = model.joint(f"swivel_{number}")
            except KeyError:
                continue
            data.qpos[joint.qposadr[0]] = 0
            mujoco.mj_kinematics(model, data)
            entry, axis = data.xanchor[joint.id], data.xaxis[joint.id]
            way = data.site(f"platform_{number}").xpos - entry
            wheel = data.geom(f"wheel_{number}").xpos - entry
            data.qpos[joint.qposadr[0]] = np.arctan2(np.cross(wheel, way) @ axis, wheel @ (way - (way @ axis) * axis))
        mujoco.mj_kinematics(model, data)
        mujoco.mj_tendon(model, data)
        lengths.append(data.ten_length.copy())
    return np.array(lengths)


def random_poses(centre: Array, count: int) -> list[tuple[Array, Array]]:
    rng = np.random.default_rng(5)
    poses = []
    for _ in range(count):
        quaternion = np.array([1, *rng.uniform(-0.1, 0.1, 3)])
        poses.append((centre + rng.uniform(-0.12, 0.12, 3), quaternion / np.linalg.norm(quaternion)))
    return poses


def turned(quaternion: Array, vector: Array) -> Array:
    w, v = quaternion[0], quaternion[1:]
    return np.asarray(vector + 2 * np.cross(v, np.cross(v, vector) + w * vector))


def test_tendons_are_as_long_as_our_cables(program: Path, tmp_path: Path) -> None:
    file, model = tmp_path / "robot.json", tmp_path / "mini.xml"
    tautline(program, "new", "mini", "-o", file)
    tautline(program, "export", file, "--for", "mjcf", "-o", model)
    robot = json.loads(file.read_text())
    poses = random_poses(np.array(robot["home"]["position_m"]), 100)
    found = lengths_of_tendons(model, poses)
    for row, (position, quaternion) in zip(found, poses, strict=True):
        for length, cable in zip(row, robot["cables"], strict=True):
            pulley = cable["pulley"]
            anchor = position + turned(quaternion, np.array(cable["platform_anchor_m"]))
            ours = path_length(anchor, np.array(pulley["entry_point_m"]), np.array(pulley["swivel_axis"]), pulley["radius_m"])
            assert abs(length - ours - cable["winch"]["length_to_pulley_m"]) < 1e-5


def test_a_model_of_mujoco_is_read_and_corrected(program: Path, tmp_path: Path) -> None:
    """A robot whose eyelets are elsewhere than in the user's model: the model is corrected in place, and MuJoCo agrees."""
    file, out = tmp_path / "robot.json", tmp_path / "out.xml"
    tautline(program, "import", SAMPLES / "cables.mjcf.xml", "-o", file)
    robot = json.loads(file.read_text())
    del robot["platform"]["mass_kg"]
    rng = np.random.default_rng(9)
    for cable in robot["cables"]:
        moved = np.array(cable["pulley"]["entry_point_m"]) + rng.normal(0, 0.01, 3)
        cable["pulley"]["entry_point_m"] = moved.tolist()
    file.write_text(json.dumps(robot))
    tautline(program, "export", file, "--for", "mjcf", "--onto", SAMPLES / "cables.mjcf.xml", "-o", out)
    poses = random_poses(np.array([0, 0, 1.0]), 100)
    found = lengths_of_tendons(out, poses)
    for row, (position, quaternion) in zip(found, poses, strict=True):
        for length, cable in zip(row, robot["cables"], strict=True):
            anchor = position + turned(quaternion, np.array(cable["platform_anchor_m"]))
            assert abs(length - np.linalg.norm(anchor - cable["pulley"]["entry_point_m"])) < 1e-5
