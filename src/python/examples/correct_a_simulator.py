"""Corrects a MuJoCo model of a cable robot with readings of the machine: the model as drawn beside the machine, the cause, the corrected
model beside the machine. Needs mujoco, and the program `tautline` on the path."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import mujoco
import numpy as np
import tautline


def drive(file: Path, dataset: tautline.Dataset) -> tautline.Dataset:
    """What the model predicts at the commanded poses: how much longer each tendon is than at the first one."""
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    place = model.jnt_qposadr[model.body("platform").jntadr[0]]
    pose = {name: dataset[name] for name in ["pose", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"]}
    lengths = []
    for values in np.column_stack(list(pose.values())[1:]):
        data.qpos[place : place + 7] = values
        for number in range(1, model.ntendon + 1):  # each pulley turns towards its cable
            hinge = model.joint(f"swivel_{number}")
            data.qpos[hinge.qposadr[0]] = 0
            mujoco.mj_kinematics(model, data)
            axis, entry = data.xaxis[hinge.id], data.xanchor[hinge.id]
            way, wheel = (point - entry for point in (data.site(f"platform_{number}").xpos, data.geom(f"wheel_{number}").xpos))
            data.qpos[hinge.qposadr[0]] = np.arctan2(np.cross(wheel, way) @ axis, wheel @ (way - (way @ axis) * axis))
        mujoco.mj_kinematics(model, data)
        mujoco.mj_tendon(model, data)
        lengths.append(data.ten_length.copy())
    change = np.array(lengths) - lengths[0]
    return tautline.Dataset(dataset.robot, pose | {f"change_{number + 1}_m": change[:, number] for number in range(model.ntendon)})


program = os.environ.get("TAUTLINE_PROGRAM", "tautline")
folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())
robot = tautline.Robot.preset("mini")
fault = tautline.Effect("platform_anchor", ["cable-4"], {"x": 0.006})
machine = tautline.simulate(robot, poses=60, seed=1, effects=[fault]).dataset  # yours: tautline.read_dataset(...)
machine.write(folder / "machine")
found = tautline.diagnose(machine)
print(found)
robot.write(folder / "drawn.json")
found.model.write(folder / "found.json")
for name in ["drawn", "found"]:
    file = folder / f"{name}.xml"
    subprocess.run([program, "export", folder / f"{name}.json", "--for", "mjcf", "-o", file], check=True, capture_output=True)
    simulated = drive(file, machine)
    simulated.write(folder / f"simulated-{name}")
    lengths = tautline.replay(machine, found.model, simulated).document["readings"][0]
    error, noise = (1e3 * lengths[key] for key in ["simulator_rms", "noise_rms"])
    print(f"{name}.xml: lengths {error:.3f} mm from those of the machine, noise alone {noise:.3f} mm")
