"""All chunks of a study on two HyperQueue workers of this machine, then the merged result:

    pip install hyperqueue
    python docs/studies/on_hyperqueue.py FOLDER CHUNKS [PROGRAM]

With a server that runs already (`hq server start` of HyperQueue's own program) the environment variable HQ_SERVER_DIR names
its folder, and the workers are those that are connected to it, on however many machines. Whatever was killed, the same line
does what is missing: chunks that are there take no time.
"""

import os
import subprocess
import sys

from hyperqueue import Client
from hyperqueue.cluster import LocalCluster, WorkerConfig
from hyperqueue.job import Job

folder, chunks = os.path.abspath(sys.argv[1]), int(sys.argv[2])
program = sys.argv[3] if len(sys.argv) > 3 else "tautline"


def run(client):
    # A chunk that fails does not end the others.
    job = Job(name="tautline", max_fails=None)
    for number in range(1, chunks + 1):
        command = [program, "study", "run", folder, "--chunk", f"{number}/{chunks}", "--threads", "1"]
        job.program(command, stdout=None, stderr=None)
    return client.wait_for_jobs([client.submit(job)], raise_on_error=False)


if "HQ_SERVER_DIR" in os.environ:
    complete = run(Client(os.environ["HQ_SERVER_DIR"]))
else:
    with LocalCluster() as cluster:
        for _ in range(2):
            cluster.start_worker(WorkerConfig(cores=1))
        complete = run(cluster.client())
if not complete:
    sys.exit("some chunks are missing: run this again")
subprocess.run([program, "study", "merge", folder], check=True)
