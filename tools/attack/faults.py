"""Failing system calls: the program reports the error or succeeds nevertheless, and loses no data.

A case lets one call of a command fail with an error that it may have, or do half of what it was asked to.
If the exit code is 0, the results are right. Afterwards all inputs are as before, and the same command
without a fault succeeds with the right results.
"""

import errno
import os
import shutil

import commands
import part
import runs
import tracer

ERRORS = {
    "openat": "EMFILE ENFILE EACCES EIO EINTR ENOSPC ENOMEM EROFS",
    "read": "EIO EINTR short", "pread64": "EIO EINTR short",
    "write": "ENOSPC EIO EINTR EDQUOT EFBIG short", "pwrite64": "ENOSPC EIO EINTR short",
    "lseek": "EINVAL ESPIPE", "copy_file_range": "EIO ENOSPC EXDEV ENOSYS",
    "fsync": "EIO ENOSPC EINTR EINVAL", "fdatasync": "EIO ENOSPC EINTR", "ftruncate": "ENOSPC EIO EINTR",
    "rename": "EIO ENOSPC EACCES EXDEV EROFS", "renameat": "EIO ENOSPC EACCES EXDEV EROFS",
    "renameat2": "EIO ENOSPC EACCES ENOSYS", "link": "EPERM EIO EEXIST", "linkat": "EPERM EIO EEXIST ENOSPC",
    "unlink": "EIO EACCES EBUSY", "unlinkat": "EIO EACCES EBUSY", "mkdir": "ENOSPC EACCES EIO EEXIST",
    "statx": "EACCES EIO ENOMEM ENOSYS", "newfstatat": "EACCES EIO ENOMEM", "getdents64": "EIO ENOMEM",
    "flock": "EINTR ENOLCK EWOULDBLOCK", "readlink": "EACCES EIO ENOMEM", "getcwd": "ENOENT EACCES",
    "chmod": "EPERM EIO", "fchmod": "EPERM EIO", "getrandom": "ENOSYS EINTR",
    "mmap": "ENOMEM", "clone": "EAGAIN", "clone3": "EAGAIN ENOMEM ENOSYS",
}


class Target:
    """A command, its calls by name, and its right results."""

    def __init__(self, work, name, prepared):
        self.name, self.prepared = name, prepared
        arguments, self.outputs = commands.COMMANDS[name]
        self.command = work.bidir(*arguments)
        self.inputs = part.digest(prepared, set(os.listdir(prepared)) - {".said"})
        with work.folder() as place:
            folder = self.copy(place)
            ended, self.counts = tracer.trace(self.command, folder, None, commands.LIMITS)
            self.right = commands.contents(folder, self.outputs)
            work.case("%s without a fault" % name, ended.wrong(0), folder, self.command)

    def copy(self, place):
        folder = os.path.join(place, "copy")
        shutil.copytree(self.prepared, folder)
        return folder

    def damage(self, folder, ended):
        """Returns the fault of a run. None: it behaved as specified."""
        # A render continues from its own film, which therefore changes.
        own = {"a.film"} if self.name == "render" else set()
        after = part.digest(folder, self.inputs)
        changed = [name for name in self.inputs if name not in own and after.get(name) != self.inputs[name]]
        if changed:
            return "changes %s" % ", ".join(changed)
        if ended.code == 0 and commands.contents(folder, self.outputs) != self.right:
            return "succeeds, but its results are wrong"
        return None

    def case(self, work, action):
        """Returns the fault, or None."""
        with work.folder() as place:
            folder = self.copy(place)
            ended, _ = tracer.trace(self.command, folder, action, commands.LIMITS)
            fault = ended.fault() or self.damage(folder, ended)
            if not fault:
                again = runs.run(self.command, folder, commands.LIMITS)
                fault = again.wrong(0) or self.damage(folder, again)
                fault = fault and "the same command again: %s" % fault
            work.case("%s: %s" % (self.name, action), fault, folder, self.command)


def drawn(work, counts):
    """A call of a command and an error of it."""
    name = work.random.choice([name for name in sorted(ERRORS) if counts.get(name)])
    kind = work.random.choice(ERRORS[name].split())
    nth = work.random.randint(1, counts[name])
    if kind == "short":
        return tracer.Action(name, nth, "short")
    return tracer.Action(name, nth, "errno", getattr(errno, kind))


def run(work):
    work.skipped = tracer.absent()
    if work.skipped:
        return
    with work.folder() as prepared:
        commands.prepare(work, prepared)
        targets = [Target(work, name, prepared) for name in commands.COMMANDS]
        targets = [target for target in targets if target.counts]
        for number in range(work.count()):
            target = targets[number % len(targets)]
            target.case(work, drawn(work, target.counts))
