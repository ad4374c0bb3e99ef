"""A small cluster on this machine, made for machines that are slow and shared."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

# Before Ray is imported: the clusters here are reached from this machine alone, and need no token.
os.environ.setdefault("RAY_AUTH_MODE", "disabled")
os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")

import ray
from ray.cluster_utils import Cluster

from bidir.ray._render import Renderer

#: A node that is killed refuses connections, and is found dead within seconds. One that is only slow
#: has minutes: a check may take half a minute, and six of them have to fail.
HEALTH = {
    "health_check_initial_delay_ms": 5_000,
    "health_check_period_ms": 1_000,
    "health_check_timeout_ms": 30_000,
    "health_check_failure_threshold": 6,
    "enable_worker_prestart": False,
    "prestart_worker_first_driver": False,
}
OBJECTS = 80 * 1024 * 1024


class Nodes:
    """Three nodes of one processor each, to be killed and added."""

    def __init__(self) -> None:
        """Begin without nodes; :meth:`start` starts them."""
        self.cluster: Any = None
        self.others: list[Any] = []
        self._killed = 0

    def start(self) -> None:
        """Start three nodes and connect with them."""
        self.cluster = Cluster(
            initialize_head=True,
            head_node_args={
                "num_cpus": 1,
                "object_store_memory": OBJECTS,
                "include_dashboard": False,
                "_system_config": HEALTH,
            },
        )
        self.others, self._killed = [], 0
        ray.init(address=self.cluster.address, log_to_driver=False)
        self.complete()

    def stop(self) -> None:
        """Stop all nodes."""
        ray.shutdown()
        if self.cluster is not None:
            self.cluster.shutdown()
        self.cluster = None

    def complete(self) -> None:
        """Add nodes until there are three."""
        while len(self.others) < 2:
            self.add()
        self.cluster.wait_for_nodes(timeout=120)

    def add(self) -> str:
        """Add a node; return its name."""
        node = self.cluster.add_node(num_cpus=1, object_store_memory=OBJECTS)
        self.others.append(node)
        return str(node.node_id)

    def kill(self) -> str:
        """Kill a node that is not the head, as a power cut would; return its name."""
        node = self.others.pop(0)
        self._killed += 1
        self.cluster.remove_node(node, allow_graceful=False)
        return str(node.node_id)

    def has_lost_any(self) -> bool:
        """Return True if a node has died that no test killed."""
        return sum(not node["Alive"] for node in ray.nodes()) > self._killed

    @property
    def address(self) -> str:
        """The address for other drivers."""
        return str(self.cluster.address)


def wait_for(what: Callable[[], bool], seconds: float = 120) -> None:
    """Wait until a condition is true; fail after a long time."""
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.05)


class Journal:
    """A record of the actors' work, one file per started range, and a gate that holds them."""

    def __init__(self) -> None:
        """Begin an empty journal."""
        self.folder = Path(tempfile.mkdtemp(prefix="bidir-test-"))
        atexit.register(shutil.rmtree, self.folder, ignore_errors=True)

    def open_gate(self) -> None:
        """Let actors start ranges of the second half."""
        (self.folder / "open").touch()

    def entries(self) -> list[tuple[int, int, int, str]]:
        """Return begin, end, process and node of all ranges, in the order of their start."""
        found = sorted(self.folder.glob("*.range"), key=lambda path: path.stat().st_mtime_ns)
        parts = [path.stem.split("_") for path in found]
        return [(int(a), int(b), int(pid), node) for a, b, pid, node, _ in parts]


def slow(journal: Journal, seconds: float = 0.1, gate: int = 24) -> type[Renderer]:
    """Return an actor that records its passes, which have a least duration.

    From pass ``gate`` on it waits until the journal's gate is open, so that what happens in the middle
    of a render does so on machines of any speed.
    """
    folder = str(journal.folder)

    class Slow(Renderer):
        def render(self, begin: int, end: int) -> tuple[dict[str, Any], bytes]:
            node = ray.get_runtime_context().get_node_id()
            name = f"{begin}_{end}_{os.getpid()}_{node}_{time.monotonic_ns()}.range"
            (Path(folder) / name).touch()
            while begin >= gate and not (Path(folder) / "open").exists():
                time.sleep(0.05)
            time.sleep(seconds * (end - begin))
            told, film = super().render(begin, end)
            return {**told, "seconds": told["seconds"] + seconds * (end - begin)}, film

    return Slow
