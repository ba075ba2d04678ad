#!/bin/bash
# All chunks of a study on the workers of a HyperQueue server, then the merged result:
#     docs/studies/hyperqueue.sh FOLDER CHUNKS
# Tasks whose worker died are done by another one. The server may die as well: start it with --journal and this again.
set -euo pipefail
folder=$(realpath "$1")
hq submit --name tautline --array "1-$2" --cpus 1 --crash-limit unlimited --stdout none --stderr "$folder/log/%{TASK_ID}" --wait -- \
    sh -c "exec tautline study run '$folder' --chunk \"\$HQ_TASK_ID/$2\" --threads 1"
tautline study merge "$folder"
