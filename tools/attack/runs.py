"""Programs that are run within limits, and the verdict on how they ended."""

import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import harness

# The exit codes of docs/reference/cli.md that a program may choose itself.
DOCUMENTED = {0, 1, 2, 3, 4, 5, 6, 7, 75, 130, 143}
GIB = 1 << 30
# The address space of a process: a backstop, since threads reserve much that they never use. Unit: bytes.
ADDRESS_SPACE = 8 * GIB


def limit_memory(size):
    """In a new process. macOS has no such limit."""
    try:
        resource.setrlimit(resource.RLIMIT_AS, (size, size))
    except (OSError, ValueError):
        pass


class Limits(NamedTuple):
    """Means of a run. Unit: seconds of all processors and of the clock, bytes."""

    cpu: float = 10
    wall: float = 300
    memory: int = GIB

    def impose(self):
        """Called in the new process, before the program. The verdict comes from what was used: the
        limits of the system only keep the machine from harm."""
        resource.setrlimit(resource.RLIMIT_CPU, (int(2 * self.cpu) + 2,) * 2)
        limit_memory(ADDRESS_SPACE)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class Ended:
    """The end of a run."""

    def __init__(self, command, status, usage, seconds, limits, said):
        self.command, self.seconds, self.limits, self.said = command, seconds, limits, said
        self.code = os.waitstatus_to_exitcode(status)
        self.cpu = usage.ru_utime + usage.ru_stime
        # In bytes on macOS, elsewhere in KiB.
        self.memory = usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)

    def fault(self):
        """Returns the reason why this is a failure. None: it is none."""
        if "panicked at" in self.said:
            return "panics"
        if self.seconds > self.limits.wall:
            return "still runs after %.0f s" % self.limits.wall
        if self.cpu > self.limits.cpu:
            return "takes %.1f s of processors, more than %.1f" % (self.cpu, self.limits.cpu)
        if self.code < 0:
            return "is ended by %s" % signal.Signals(-self.code).name
        if self.code not in DOCUMENTED:
            return "ends with the exit code %d" % self.code
        if self.memory > self.limits.memory:
            return "takes %d MiB, more than %d" % (self.memory >> 20, self.limits.memory >> 20)
        if self.code != 0 and not self.said.strip():
            return "ends with the exit code %d without a message" % self.code
        return None

    def wrong(self, code):
        """Returns the reason why this is a failure, if another exit code is one."""
        fault = self.fault()
        if fault or self.code == code:
            return fault
        return "ends with the exit code %d, not %d" % (self.code, code)


def start(command, folder, limits):
    """A process of its own; its messages go into the file `.said` of the folder."""
    with open(os.path.join(folder, ".said"), "wb") as said:
        return subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=said,
                                stderr=subprocess.STDOUT, preexec_fn=limits.impose,
                                env=harness.environment())


def wait(process, limits, kill_after=None):
    """Waits for the end, or kills the process after a number of seconds."""
    begin, pause = time.monotonic(), 0.001
    patience = min(limits.wall, kill_after or limits.wall)
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        seconds = time.monotonic() - begin
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return status, usage, seconds
        if seconds > patience:
            # `Popen.kill` waits for a process that has just ended, and `wait4` would find none.
            os.kill(process.pid, signal.SIGKILL)
            pid, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            return status, usage, seconds
        time.sleep(min(pause, max(patience - seconds, 0.0005)))
        pause = min(pause * 1.3, 0.02)


def said(folder):
    return Path(folder, ".said").read_text(errors="replace")


def run(command, folder, limits=None, kill_after=None):
    """Runs a command in a folder to its end, or kills it after a number of seconds."""
    limits = limits or Limits()
    process = start(command, folder, limits)
    status, usage, seconds = wait(process, limits, kill_after)
    return Ended(command, status, usage, seconds, limits, said(folder))
