#!/bin/sh
# {{title}}. Written by `bidir farm hyperqueue`.
#
#   sh FILE   submits the parts, waits for them, and makes the image when all are done
#
# More flags of `hq submit`, such as --cpus=16 or --time-limit=1h, belong in the line below.
# HyperQueue restarts a part whose worker is lost, and the part continues from its film file. A part
# that was stopped early (exit code 75) continues when this file is started again; finished parts
# return at once.
set -eu

if [ -z "${HQ_TASK_ID:-}" ]; then
  job=$(hq --output-mode=quiet submit --name={{job}} --array=0-{{last}} -- sh "$0")
  hq job wait "$job"
  failed=$(hq job task-ids "$job" --filter=failed,canceled)
  if [ -n "$failed" ]; then
    echo "parts $failed of job $job are not done: see \`hq job cat $job stderr\`" >&2
    exit 1
  fi
  {{merge}}
  {{develop}}
  exit
fi

exec bidir render {{scene}} --part env/{{parts}}{{spp}} --checkpoint {{share}}"$HQ_TASK_ID"-of-{{parts}}.film --resume{{flags}}
