"""A study in a few lines: how exact MINI becomes with three lasers, from the covariance and from simulated calibrations."""

import tempfile

import tautline

study = {
    "name": "which laser",
    "design": {"robots": ["mini"], "lasers": ["class-0.1mm", "class-1mm", "none"], "poses": [25], "choice": ["random"]},
    "simulation": {"calibrations": 100, "share": 1.0},
}
with tempfile.TemporaryDirectory() as folder:
    planned = tautline.Study.plan(study, folder)
    planned.run()
    result = planned.merge()
    calibrations = planned.calibrations()

print(result)
columns = result.columns
for cell, laser in enumerate(columns["laser"]):
    expected, simulated = 1e3 * columns["expected_position_m"][cell], 1e3 * columns["simulated_position_m"][cell]
    print(f"{laser}: {expected:.2f} mm expected, {simulated:.2f} mm in {columns['calibrations'][cell]} calibrations")
# One row for each calibration, for questions of one's own.
print(f"largest error of all: {1e3 * calibrations['position_m'].max():.2f} mm")
