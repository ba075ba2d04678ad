#!/bin/bash
# One array task for each chunk:
#     tautline study plan STUDY.toml --out FOLDER
#     sbatch --array=1-200 docs/studies/slurm.sh FOLDER 200
# and, when all are done, tautline study merge FOLDER. Tasks that failed are done by submitting the same line again: chunks
# that are there are not done twice.
#SBATCH --job-name=tautline
#SBATCH --cpus-per-task=1
#SBATCH --mem=256M
#SBATCH --time=01:00:00
set -euo pipefail
exec tautline study run "$1" --chunk "$SLURM_ARRAY_TASK_ID/$2" --threads 1
