#!/bin/sh
# A data set on a Slurm cluster: sbatch --array=0-39 slurm.sh SET
#SBATCH --job-name=panwright
#SBATCH --cpus-per-task=4
exec panwright dataset run "$1" --threads "${SLURM_CPUS_PER_TASK:-1}" \
  --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
