//! A task array of HyperQueue.

use super::{Plan, shell_command};

/// The script is two things: a share, and what submits them and does the last step.
///
/// HyperQueue itself repeats tasks whose worker was lost, but none that failed.
pub(super) fn script(plan: &Plan<'_>) -> String {
    let (job, last) = (plan.job(), plan.parts - 1);
    let render = shell_command(&plan.render_env(), "HQ_TASK_ID");
    let [merge, develop] = plan.last_step();
    format!(
        r#"#!/bin/sh
# {title}. Written by `bidir farm hyperqueue`.
#
#   sh FILE   submits the parts, waits for them, and makes the image when all are done
#
# More flags of `hq submit`, such as --cpus=16 or --time-limit=1h, belong in the line below.
# HyperQueue restarts a part whose worker is lost, and the part continues from its film file. A part
# that was stopped early (exit code 75) continues when this file is started again; finished parts
# return at once.
set -eu

if [ -z "${{HQ_TASK_ID:-}}" ]; then
  job=$(hq --output-mode=quiet submit --name={job} --array=0-{last} -- sh "$0")
  hq job wait "$job"
  failed=$(hq job task-ids "$job" --filter=failed,canceled)
  if [ -n "$failed" ]; then
    echo "parts $failed of job $job are not done: see \`hq job cat $job stderr\`" >&2
    exit 1
  fi
  {merge}
  {develop}
  exit
fi

exec {render}
"#,
        title = plan.title(),
    )
}
