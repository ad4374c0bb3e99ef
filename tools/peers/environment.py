"""The environment of the peers: a Python virtual environment next to the build.

Every package is installed separately, so that one that cannot be installed does not affect the others.
"""

import glob
import os
import re
import subprocess
import sys
from typing import NamedTuple

# Import names and requirements. Versions are pinned, as figures depend on them.
TOOLS = {"numpy": "numpy==2.4.6", "OpenEXR": "OpenEXR==3.5.3"}
PEERS = {"mitsuba": "mitsuba==3.9.1", "pyluxcore": "pyluxcore==2.11.2"}
CYCLES = {"bpy": "bpy==5.0.1"}
# Mitsuba's vectorised variant loads LLVM when it runs; older ones crash on AVX-512.
LLVM = 19


class Environment(NamedTuple):
    """The folder of all files that this tool writes."""

    folder: str

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    @property
    def python(self):
        return self.path("venv", "bin", "python")

    def has(self, package):
        """Returns True if a package can be imported; does not import it, as some take seconds."""
        test = "import importlib.util, sys; sys.exit(not importlib.util.find_spec(%r))" % package
        return os.path.exists(self.python) and subprocess.call([self.python, "-c", test]) == 0

    def versions(self):
        """Returns the installed packages: {package: version}."""
        command = [self.python, "-m", "pip", "list", "--format=freeze"]
        lines = subprocess.check_output(command, text=True).splitlines()
        return dict(line.split("==", 1) for line in lines if "==" in line)

    def llvm(self):
        """Returns the LLVM library for Mitsuba. None: there is no usable one."""
        if os.environ.get("DRJIT_LIBLLVM_PATH"):
            return os.environ["DRJIT_LIBLLVM_PATH"]
        found = []
        for root in ("/usr/lib64", "/usr/lib/*", self.path("llvm", "usr", "lib", "*")):
            for path in glob.glob(root + "/libLLVM*.so*"):
                version = re.search(r"libLLVM(?:-|\.so\.)(\d+)", os.path.basename(path))
                if version and int(version[1]) >= LLVM:
                    found.append((int(version[1]), path))
        return min(found)[1] if found else None

    def variables(self, package=""):
        """Returns the environment variables of the script of a peer."""
        variables = dict(os.environ, PYTHONDONTWRITEBYTECODE="1")
        if self.llvm():
            variables["DRJIT_LIBLLVM_PATH"] = self.llvm()
        if package == "pyluxcore":
            # Its allocator must be loaded first, or its sessions never end.
            libraries = "".join(glob.glob(self.path("venv/lib/python3*/site-packages/pyluxcore.libs")))
            variables["LD_PRELOAD"] = "".join(glob.glob(libraries + "/libtbbmalloc_proxy*")[:1])
            variables["LD_LIBRARY_PATH"] = libraries
        return variables


def set_up(environment, packages):
    """Installs missing packages, and reports those that cannot be installed."""
    os.makedirs(environment.folder, exist_ok=True)
    if not os.path.exists(environment.python):
        subprocess.check_call([sys.executable, "-m", "venv", environment.path("venv")])
    for name, requirement in {**TOOLS, **packages}.items():
        if environment.has(name):
            continue
        print("installing", requirement, flush=True)
        command = [environment.python, "-m", "pip", "install", "-q", requirement]
        if subprocess.call(command) != 0:
            print("peers: %s cannot be installed here" % requirement, file=sys.stderr)
    if environment.llvm() is None:
        _unpack_llvm(environment)


def _unpack_llvm(environment):
    """Unpacks Debian's package into the folder; this installs nothing and needs no root."""
    package = "libllvm%d" % LLVM
    print("unpacking", package, flush=True)
    try:
        subprocess.check_call(["apt-get", "download", "-qq", package], cwd=environment.folder)
        [archive] = glob.glob(environment.path(package + "_*.deb"))
        subprocess.check_call(["dpkg", "-x", archive, environment.path("llvm")])
        os.remove(archive)
    except (OSError, ValueError, subprocess.CalledProcessError) as error:
        print("peers: no LLVM %d: %s; DRJIT_LIBLLVM_PATH can name one" % (LLVM, error),
              file=sys.stderr)
