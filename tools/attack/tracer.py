"""System calls of a process by ptrace: counted, made to fail, cut short, or the moment of a kill.

x86-64 Linux only. One traced process at a time, and no other children meanwhile, since every child is
waited for.
"""

import ctypes
import errno
import os
import platform
import signal

import harness
import runs

# Numbers of system calls of x86-64.
NUMBERS = {
    "read": 0, "write": 1, "lseek": 8, "mmap": 9, "mprotect": 10, "munmap": 11, "pread64": 17,
    "pwrite64": 18, "flock": 73, "fsync": 74, "fdatasync": 75, "ftruncate": 77, "getcwd": 79,
    "rename": 82, "mkdir": 83, "link": 86, "unlink": 87, "readlink": 89, "chmod": 90, "fchmod": 91,
    "clone": 56, "getdents64": 217, "openat": 257, "newfstatat": 262, "unlinkat": 263,
    "renameat": 264, "linkat": 265, "renameat2": 316, "getrandom": 318, "copy_file_range": 326,
    "statx": 332, "clone3": 435,
}
NAMES = {number: name for name, number in NUMBERS.items()}
# The run time of Rust is ready when it sets the stack of signals up: what fails before is the loader's.
READY = 131
# Maps smaller than this are those of the allocator: a program cannot go on without. Unit: bytes.
LARGE = 1 << 20

TRACEME, PEEKUSER, POKEUSER, KILL, SETOPTIONS, SYSCALL = 0, 3, 6, 8, 0x4200, 24
TRACESYSGOOD, TRACECLONE, EXITKILL = 1, 8, 0x100000
WALL = 0x40000000
# Places in the registers of x86-64. Unit: bytes.
RAX, RDX, RSI, ORIG_RAX, RDI = 80, 96, 104, 120, 112

LIBC = ctypes.CDLL(None, use_errno=True)
LIBC.ptrace.restype = ctypes.c_long
LIBC.ptrace.argtypes = [ctypes.c_long] * 4


def ptrace(request, pid, address=0, data=0):
    ctypes.set_errno(0)
    result = LIBC.ptrace(request, pid, address, data)
    if result == -1 and ctypes.get_errno():
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return result


def absent():
    """Returns the reason why tracing is impossible here. None: it works."""
    if platform.system() != "Linux" or platform.machine() != "x86_64":
        return "system calls are traced on x86-64 Linux only"
    try:
        trace(["/bin/true"], "/", None, runs.Limits())
    except OSError as error:
        return "ptrace: %s" % error
    return None


class Action:
    """Happens at the `nth` call of this name, counted from 1: `errno`, `short` or `kill`."""

    def __init__(self, name, nth, kind, value=0):
        self.name, self.nth, self.kind, self.value = name, nth, kind, value

    def __str__(self):
        kind = errno.errorcode[self.value] if self.kind == "errno" else self.kind
        return "%s %d of %s" % (kind, self.nth, self.name)


class Trace:
    """The state of a traced process."""

    def __init__(self, action):
        self.action = action
        self.counts = {}
        self.inside = {}
        self.ready = False
        self.done = False

    def enter(self, thread, pid):
        number = ptrace(PEEKUSER, thread, ORIG_RAX)
        self.ready |= number == READY
        name = NAMES.get(number)
        if not self.ready or name is None or (name == "mmap" and ptrace(PEEKUSER, thread, RSI) < LARGE):
            return None
        self.counts[name] = self.counts.get(name, 0) + 1
        action = self.action
        if self.done or not action or action.name != name or action.nth != self.counts[name]:
            return None
        self.done = True
        return self.act(thread, pid)

    def act(self, thread, pid):
        """Returns what the call has to return, or None for its own result."""
        if self.action.kind == "kill":
            os.kill(pid, signal.SIGKILL)
            return None
        if self.action.kind == "short":
            asked = ptrace(PEEKUSER, thread, RDX)
            ptrace(POKEUSER, thread, RDX, max(1, asked // 2) if asked > 0 else asked)
            return None
        ptrace(POKEUSER, thread, ORIG_RAX, -1)
        return -self.action.value

    def stop(self, thread, pid):
        """At one end of a system call."""
        if thread in self.inside:
            result = self.inside.pop(thread)
            if result is not None:
                ptrace(POKEUSER, thread, RAX, result)
        else:
            self.inside[thread] = self.enter(thread, pid)


def child(command, folder, limits):
    """In the new process: never returns."""
    try:
        os.chdir(folder)
        limits.impose()
        null = os.open(os.devnull, os.O_RDONLY)
        said = 1 if folder == "/" else os.open(".said", os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        for old, new in ((null, 0), (said, 1), (said, 2)):
            os.dup2(old, new)
        ptrace(TRACEME, 0)
        os.execve(command[0], command, harness.environment())
    except BaseException:
        os._exit(127)


def trace(command, folder, action, limits):
    """Runs a command. Returns how it ended, and the number of calls of each name."""
    pid = os.fork()
    if pid == 0:
        child(command, folder, limits)
    late = []
    previous = signal.signal(signal.SIGALRM, lambda *_: (late.append(True), os.kill(pid, signal.SIGKILL)))
    signal.setitimer(signal.ITIMER_REAL, limits.wall)
    try:
        return follow(pid, command, folder, Trace(action), limits, late)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, previous)


def follow(pid, command, folder, state, limits, late):
    _, status, usage = os.wait4(pid, 0)
    if not os.WIFSTOPPED(status):
        raise OSError(errno.EPERM, "the process does not stop")
    ptrace(SETOPTIONS, pid, 0, TRACESYSGOOD | TRACECLONE | EXITKILL)
    ptrace(SYSCALL, pid)
    while True:
        thread, status, usage = os.wait4(-1, WALL)
        if os.WIFEXITED(status) or os.WIFSIGNALED(status):
            if thread == pid:
                break
            continue
        try:
            resume(thread, status, state, pid)
        except ProcessLookupError:
            continue
    text = "" if folder == "/" else runs.said(folder)
    seconds = limits.wall + 1 if late else 0.0
    return runs.Ended(command, status, usage, seconds, limits, text), state.counts


def resume(thread, status, state, pid):
    number = os.WSTOPSIG(status)
    if number == signal.SIGTRAP | 0x80:
        state.stop(thread, pid)
        number = 0
    elif number == signal.SIGTRAP or (number == signal.SIGSTOP and thread != pid):
        # An event of the tracer itself, or the first stop of a new thread.
        number = 0
    ptrace(SYSCALL, thread, 0, number)
