//! An Indexed Job of Kubernetes.

use super::quote::yaml;
use super::{Plan, Word};

/// No shell is between the pod and the program: Kubernetes puts the index into the words, and its
/// TERM reaches the render itself.
pub(super) fn manifest(plan: &Plan<'_>) -> String {
    let (parts, name) = (plan.parts, label(&plan.job()));
    let words = plan.render_env();
    let words = words
        .iter()
        .map(|word| format!("            - {}", argument(word)));
    let command = words.collect::<Vec<_>>().join("\n");
    let last_step = commented(&plan.last_step().join("\n"));
    format!(
        r"# {title}. Written by `bidir farm k8s`.
#
# Set the image, the claim of a volume that all pods can write, and what a pod may use. Then:
#   kubectl create -f FILE
#   kubectl wait --for=condition=complete --timeout=-1s job/{name}
# and where the volume is:
{last_step}
#
# A stopped job continues when it is created again; finished parts return at once.
apiVersion: batch/v1
kind: Job
metadata:
  name: {name}
spec:
  completionMode: Indexed
  completions: {parts}
  # The number of parts that run at a time.
  parallelism: {parts}
  # The number of times each part may fail; needs Kubernetes 1.29. Before, use backoffLimit.
  backoffLimitPerIndex: 3
  podFailurePolicy:
    rules:
      # The pod was evicted, which is no failure of the part.
      - action: Ignore
        onPodConditions:
          - type: DisruptionTarget
      # 75: stopped early, with a film file to continue from.
      - action: Ignore
        onExitCodes:
          containerName: render
          operator: In
          values: [75]
      # Wrong flags, a wrong scene, a film file of another render, a failed check: all parts would fail.
      - action: FailJob
        onExitCodes:
          containerName: render
          operator: In
          values: [2, 3, 5, 6]
  template:
    spec:
      restartPolicy: Never
      # The time between TERM and KILL, in seconds: longer than a pass takes.
      terminationGracePeriodSeconds: 120
      containers:
        - name: render
          image: bidir
          workingDir: /scenes
          command:
{command}
          resources:
            requests:
              cpu: 1
              memory: 1Gi
          volumeMounts:
            - name: work
              mountPath: /scenes
      volumes:
        - name: work
          persistentVolumeClaim:
            claimName: bidir
",
        title = plan.title(),
    )
}

/// A word in the list of a command. `$$` is a dollar, so that `$(…)` in a name stays what it is.
fn argument(word: &Word) -> String {
    let plain = |text: &str| text.replace('$', "$$");
    yaml(&match word {
        Word::Fixed(text) => plain(text),
        Word::Share(before, after) => {
            format!("{}$(JOB_COMPLETION_INDEX){}", plain(before), plain(after))
        }
    })
}

/// A name of an object: small letters, digits and dashes, with room for what is added for pods.
fn label(job: &str) -> String {
    let small = job.to_ascii_lowercase().replace(['.', '_'], "-");
    let name = small.get(..40).unwrap_or(&small).trim_matches('-');
    if name.is_empty() {
        "bidir".into()
    } else {
        name.into()
    }
}

fn commented(text: &str) -> String {
    let lines = text
        .split(char::is_control)
        .map(|line| format!("#   {line}"));
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_objects_are_labels() {
        assert_eq!(label("Room_1.final"), "room-1-final");
        assert_eq!(label("-.-"), "bidir");
        assert!(label(&"a-".repeat(50)).len() <= 40);
        assert!(!label(&"a-".repeat(50)).ends_with('-'));
    }

    #[test]
    fn the_index_is_put_in_by_kubernetes_and_nothing_else_is() {
        let word = Word::Share("$(HOME) \"x\"-".into(), ".film".into());
        assert_eq!(
            argument(&word),
            r#""$$(HOME) \"x\"-$(JOB_COMPLETION_INDEX).film""#
        );
    }

    #[test]
    fn comments_end_where_lines_do() {
        assert_eq!(commented("a\nb"), "#   a\n#   b");
    }
}
