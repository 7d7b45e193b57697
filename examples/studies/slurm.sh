#!/bin/sh
# Runs a study as an array of Slurm jobs:
#   sbatch examples/studies/slurm.sh
#SBATCH --job-name=speeds
#SBATCH --array=1-8
#SBATCH --cpus-per-task=4
#SBATCH --requeue
# A requeued job resumes.
set -e
study=${STUDY:-examples/studies/speeds.yaml}
throng study "$study" --out "part_$SLURM_ARRAY_TASK_ID.csv" --threads "${SLURM_CPUS_PER_TASK:-1}" \
  --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
# Afterwards, join the tables:
#   throng study --merge part_*.csv --out speeds.csv
