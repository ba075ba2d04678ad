"""Simulates a run with a hidden fault, lets the diagnosis find it, and shows what knowing it gains."""

import numpy as np
import tautline

robot = tautline.Robot.preset("mini")
fault = tautline.Effect("winch_scale", ["cable-3"], {"scale": 0.02})
run = tautline.simulate(robot, poses=25, seed=5, effects=[fault])

found = tautline.diagnose(run.dataset)
print(found)


def error_mm(model: tautline.Robot) -> float:
    """Root mean square error of the entry points."""
    return 1e3 * float(np.sqrt(np.mean((model.entry_points_m - run.truth.entry_points_m) ** 2)))


print(f"entry points without the fault in the model: {error_mm(tautline.identify(run.dataset).model):.2f} mm")
print(f"entry points with it: {error_mm(found.model):.2f} mm")
