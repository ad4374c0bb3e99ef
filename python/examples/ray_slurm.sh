#!/bin/bash
# Starts a Ray cluster inside a Slurm job and renders on it: sbatch python/examples/ray_slurm.sh
# When the time is up, submit the same job again; it resumes from the checkpoint of render.py.
#SBATCH --job-name=bidir
#SBATCH --nodes=8
#SBATCH --ntasks-per-node=1
#SBATCH --exclusive
#SBATCH --time=08:00:00
set -euo pipefail

# Without a token; alternatively put one into ~/.ray/auth_token, on a file system that all nodes mount.
export RAY_AUTH_MODE=disabled
head=$(hostname)

srun --nodes=1 --ntasks=1 -w "$head" \
  ray start --head --port=6379 --num-cpus="$SLURM_CPUS_ON_NODE" --block &
sleep 15
if [ "$SLURM_NNODES" -gt 1 ]; then
  srun --nodes=$((SLURM_NNODES - 1)) --ntasks=$((SLURM_NNODES - 1)) --exclude="$head" \
    ray start --address="$head:6379" --num-cpus="$SLURM_CPUS_ON_NODE" --block &
  sleep 15
fi

# Like cluster.py, but with bidir.ray.render(..., address="auto", checkpoint="apartment.film").
python3 render.py
