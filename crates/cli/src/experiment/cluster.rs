//! `bidir experiment --ray`: the Python package runs the experiment on a cluster.

use crate::args::ExperimentArgs;
use crate::exit::{Exit, Failure};
use crate::signals::Signals;
use lab::experiment::Builtin;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Interval between checks whether the other program has ended.
const POLL: Duration = Duration::from_millis(100);

/// Runs the experiment on the cluster at `address`, and returns the exit of the program that does it.
pub(super) fn run(
    args: &ExperimentArgs,
    address: &str,
    signals: &Signals,
) -> Result<Exit, Failure> {
    if let Some(Builtin { name, .. }) = Builtin::named(&args.description) {
        let message = format!("`{name}` runs on one machine: --ray takes a description");
        return Err(Failure::usage(message));
    }
    let python = std::env::var("BIDIR_PYTHON").unwrap_or_else(|_| "python3".into());
    check(&python)?;
    let mut command = Command::new(&python);
    command.args(["-m", "bidir.ray", "experiment"]);
    command.arg(&args.description);
    command.arg("--output").arg(args.folder());
    command.args(["--address", address]);
    let flags = [
        (args.quick, "--quick"),
        (args.restart, "--restart"),
        (args.quiet, "--quiet"),
    ];
    command.args(
        flags
            .iter()
            .filter(|(is_set, _)| *is_set)
            .map(|(_, name)| name),
    );
    let child = command
        .spawn()
        .map_err(|error| missing(&python, &error.to_string()))?;
    wait(child, signals)
}

/// Waits until the other program has ended. Ctrl-C reaches both programs; SIGTERM only this one.
fn wait(mut child: Child, signals: &Signals) -> Result<Exit, Failure> {
    loop {
        let polled = child.try_wait();
        let status = polled.map_err(|error| missing("python3", &error.to_string()))?;
        if let Some(status) = status {
            return Ok(Exit::of_code(status.code()));
        }
        if signals.exit() == Some(Exit::Terminated) {
            // Records are replaced as a whole, so that only the running renders are lost.
            let _ = child.kill();
            let _ = child.wait();
            return Ok(Exit::Checkpoint);
        }
        std::thread::sleep(POLL);
    }
}

/// Checks that the interpreter and the package exist.
fn check(python: &str) -> Result<(), Failure> {
    let mut command = Command::new(python);
    command
        .args(["-c", "import bidir.ray"])
        .stdin(Stdio::null());
    let output = command
        .output()
        .map_err(|error| missing(python, &error.to_string()))?;
    if output.status.success() {
        return Ok(());
    }
    let text = String::from_utf8_lossy(&output.stderr);
    let last = text.trim().lines().next_back().unwrap_or("it failed");
    Err(missing(python, last))
}

fn missing(python: &str, why: &str) -> Failure {
    let message = format!("--ray needs the Python package bidir with Ray: {python}: {why}");
    let hint = "`pip install '.[ray]'` in the repository installs it; BIDIR_PYTHON names the \
                interpreter that has it";
    Failure::new(Exit::InputOutput, message).with_hint(hint)
}
