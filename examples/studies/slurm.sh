#!/bin/sh
# A study as an array of Slurm jobs, and one more that joins their tables:
#   sbatch examples/studies/slurm.sh
#SBATCH --job-name=speeds
#SBATCH --array=1-8
#SBATCH --cpus-per-task=4
#SBATCH --requeue
# A job that is requeued goes on where it was killed.
set -e
study=${STUDY:-examples/studies/speeds.yaml}
throng study "$study" --out "part_$SLURM_ARRAY_TASK_ID.csv" --threads "${SLURM_CPUS_PER_TASK:-1}" \
  --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
# When all are done:
#   throng study --merge part_*.csv --out speeds.csv
