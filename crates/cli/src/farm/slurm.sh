#!/bin/sh
# Written by `bidir farm slurm`.
#
#   sh FILE       submits the parts, and a last job that makes the image when all are done
#   sbatch FILE   submits the parts alone
#
# A stopped part continues when it is submitted again; finished parts return at once.
#SBATCH --job-name={{label}}
#SBATCH --array=0-{{last}}
#SBATCH --requeue
#SBATCH --open-mode=append
# The notice before the time is over, in seconds: longer than a pass takes.
#SBATCH --signal=B:USR1@120
# Add the settings of your cluster; remove one # to use a line.
##SBATCH --time=1:00:00
##SBATCH --cpus-per-task=16
##SBATCH --mem=8G
##SBATCH --partition=NAME

parts={{parts}}
name={{name}}

if [ "${1:-}" = merge ]; then
  bidir merge "$name".part-[0-9]*-of-"$parts".film -o "$name.film" &&
    bidir film develop "$name.film" -o "$name.exr"
  exit
fi
if [ -z "${SLURM_ARRAY_TASK_ID:-}" ]; then
  array=$(sbatch --parsable "$0") || exit
  sbatch --array=0 --dependency=afterok:"${array%%;*}" "$0" merge
  exit
fi

# Parts are counted from the array's first task, so a section of the array would be other parts.
if [ "${SLURM_ARRAY_TASK_COUNT:-$parts}" -ne "$parts" ]; then
  echo "submit the whole array: finished parts return at once" >&2
  exit 2
fi
part=$((SLURM_ARRAY_TASK_ID - ${SLURM_ARRAY_TASK_MIN:-0}))

bidir render {{scene}} --part "$part/$parts" --checkpoint "$name.part-$part-of-$parts.film" --resume{{flags}} &
render=$!

# Only this shell gets the notice; TERM goes to all processes, and the shell waits for their end.
noticed=
trap 'noticed=yes; again=yes; kill -s TERM "$render"' USR1
trap 'again=yes' TERM
again=yes
while [ -n "$again" ]; do
  again=
  code=0
  wait "$render" || code=$?
done

# 75: stopped early, with a film file to continue from. The part goes back to the queue.
if [ "$code" -eq 75 ] && [ -n "$noticed" ]; then
  scontrol requeue "$SLURM_JOB_ID"
fi
exit "$code"
