"""Runs programs within a limit of address space and of time, and measures them by what the system counts.

    limited_runs.py BYTES SECONDS

takes commands from standard input, each a list of words in a line of JSON, and answers each with a line: its exit code (or the
negative number of the signal that ended it, or null after the time limit), what it wrote, the largest memory
that it had (bytes) and its time (s).
"""

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time


def run(words, limit_bytes, limit_s):
    with tempfile.TemporaryFile() as told:
        begun = time.monotonic()
        child = subprocess.Popen(
            words,
            stdin=subprocess.DEVNULL,
            stdout=told,
            stderr=subprocess.STDOUT,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit_bytes, limit_bytes)),
        )
        is_late = False

        def late(*_):
            nonlocal is_late
            is_late = True
            child.send_signal(signal.SIGKILL)

        signal.signal(signal.SIGALRM, late)
        signal.setitimer(signal.ITIMER_REAL, limit_s)
        _, status, usage = os.wait4(child.pid, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        code = child.returncode = os.waitstatus_to_exitcode(status)
        told.seek(0)
        return {
            "code": None if is_late else code,
            "told": told.read().decode("utf-8", "replace"),
            "peak_bytes": 1024 * usage.ru_maxrss,
            "seconds": time.monotonic() - begun,
        }


limit_bytes, limit_s = int(sys.argv[1]), float(sys.argv[2])
for line in sys.stdin:
    print(json.dumps(run(json.loads(line), limit_bytes, limit_s)), flush=True)
