#!/bin/sh
# Written by `bidir farm hyperqueue`.
#
#   sh FILE   submits the parts, waits for them, and makes the image when all are done
#
# More flags of `hq submit`, such as --cpus=16 or --time-limit=1h, belong in the line with it.
# HyperQueue restarts a part whose worker is lost, and the part continues from its film file. A part
# that was stopped early (exit code 75) continues when this file is started again; finished parts
# return at once.
set -eu
parts={{parts}}
name={{name}}

if [ -z "${HQ_TASK_ID:-}" ]; then
  job=$(hq --output-mode=quiet submit --name={{label}} --array=0-{{last}} -- sh "$0")
  hq job wait "$job"
  failed=$(hq job task-ids "$job" --filter=failed,canceled)
  if [ -n "$failed" ]; then
    echo "parts $failed of job $job are not done: see \`hq job cat $job stderr\`" >&2
    exit 1
  fi
  bidir merge "$name".part-[0-9]*-of-"$parts".film -o "$name.film"
  bidir film develop "$name.film" -o "$name.exr"
  exit
fi

part=$HQ_TASK_ID
exec bidir render {{scene}} --part "$part/$parts" --checkpoint "$name.part-$part-of-$parts.film" --resume{{flags}}
