"""Time of an identification by the command and through Python, MINI at 25 and at 1000 poses:

    TAUTLINE_PROGRAM=target/release/tautline python tests/suites/python/speed.py
"""

import json
import os
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import tautline

program = os.environ["TAUTLINE_PROGRAM"]
print("| poses | solver, by the command ms | solver, through Python ms | whole call of Python ms |\n|---|---|---|---|")
for poses, rounds in [(25, 40), (1000, 10)]:
    data = tautline.simulate(tautline.Robot.preset("mini"), poses=poses, seed=1).dataset
    by_command, by_python, calls = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        data.write(Path(folder) / "data")
        result = Path(folder) / "result.json"
        # In turns, so that whatever else the machine does concerns both.
        for _ in range(rounds):
            command = [program, "identify", Path(folder) / "data", "--json", result]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            by_command.append(json.loads(result.read_text())["seconds"])
            began = time.perf_counter()
            by_python.append(tautline.identify(data).seconds)
            calls.append(time.perf_counter() - began)
    ms = [1e3 * statistics.median(times) for times in (by_command, by_python, calls)]
    print(f"| {poses} | {ms[0]:.2f} | {ms[1]:.2f} | {ms[2]:.1f} |")
