//! One machine after the other, or several with a folder in common: a shell script.

use super::{Plan, Word, shell_command};

pub(super) fn script(plan: &Plan<'_>) -> String {
    let Plan { parts, .. } = plan;
    let part = Word::Share(String::new(), format!("/{parts}"));
    let render = shell_command(&plan.render(part), "part");
    let [merge, develop] = plan.last_step();
    format!(
        r#"#!/bin/sh
# {title}. Written by `bidir farm shell`.
#
#   sh FILE         renders all parts here, one after the other, and makes the image
#   sh FILE 0 3     renders parts 0 and 3, such as on one of several machines
#   sh FILE merge   makes the image of the parts that exist
#
# A stopped part continues when it is started again; finished parts return at once.
set -eu

render() {{
  part=$1
  {render}
}}

merge() {{
  {merge}
  {develop}
}}

if [ $# -eq 0 ]; then
  share=0
  while [ "$share" -lt {parts} ]; do
    render "$share"
    share=$((share + 1))
  done
  merge
fi
for share; do
  if [ "$share" = merge ]; then merge; else render "$share"; fi
done
"#,
        title = plan.title(),
    )
}
