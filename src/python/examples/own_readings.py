"""Identifies a robot from arrays, as a script that reads its own log would: one array for each column of poses.csv."""

import numpy as np
import tautline

robot = tautline.Robot.preset("planar")
simulated = tautline.simulate(robot, poses=20, seed=2).dataset

# What a log gives: revolutions and forces as poses by cables, and the distances of the laser.
revolutions, forces = simulated.per_cable("rev"), simulated.per_cable("force_n")
laser = simulated.columns["laser_m"]

columns = {"pose": np.arange(len(laser))}
for cable in range(len(robot.cables)):
    columns[f"rev_{cable + 1}"] = revolutions[:, cable]
    columns[f"force_{cable + 1}_n"] = forces[:, cable]
columns["laser_m"] = laser

fitted = tautline.identify(tautline.Dataset(robot, columns))
print(fitted)
for name, point, sd in zip(robot.cables, fitted.entry_points_m, fitted.entry_points_sd_m):
    print(name, np.round(1e3 * point, 2), "mm, standard deviations", np.round(1e3 * sd, 2), "mm")
