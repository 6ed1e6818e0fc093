#!/bin/bash
# A folder of scans as a SLURM array: each task does every eighth file, and all write to one directory they share.
#   sbatch examples/batch_slurm_array.sh 'scans/*.ply' out
# Submit it again after a time limit or a lost node: what is finished is not done again. When all tasks have ended,
#   wct batch repair-ftetwild 'scans/*.ply' -o out --resume
# does what is left, if anything, and writes the summary over all files.
#SBATCH --job-name=well-centered
#SBATCH --array=1-8
#SBATCH --cpus-per-task=4
#SBATCH --mem-per-cpu=4G
#SBATCH --time=12:00:00

inputs=$1 output=$2 pipeline=${3:-repair-ftetwild}

exec wct batch "$pipeline" "$inputs" -o "$output" --resume \
    --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" \
    --jobs "$SLURM_CPUS_PER_TASK" --memory-limit "$SLURM_MEM_PER_CPU" --timeout 3600
