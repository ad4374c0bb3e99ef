"""One actor on every node, which processes units of work with all threads of the node.

There are two kinds of failures. An error that a unit raises belongs to the *work*: the unit is retried, and
reported by name after several failures. The death of a process or node, or the loss of an object, belongs to
the *cluster*: another worker gets the unit, the node gets a new actor, and only repeated losses are reported,
with their cause.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any, Protocol

import ray
from ray.exceptions import RayError, RayTaskError
from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

from bidir.errors import BidirError

__all__ = [
    "ClusterError",
    "Crew",
    "Limits",
    "NodeRefusedError",
    "TaskFailedError",
    "Work",
    "Worker",
]

logger = logging.getLogger("bidir.ray")


class ClusterError(BidirError, RuntimeError):
    """The cluster has no usable node, or keeps losing work."""


class NodeRefusedError(ClusterError):
    """No node can take part, for example because of another version of bidir."""


class TaskFailedError(BidirError, RuntimeError):
    """A part of the work keeps failing; the message names it and the cause."""


@dataclass(frozen=True)
class Limits:
    """Numbers of retries."""

    #: Errors that a unit of work may raise.
    errors: int = 3
    #: Losses of a unit with its worker.
    losses: int = 9
    #: Deaths of a node's actor before it finishes a unit.
    deaths: int = 4
    #: Longest wait for a usable node. Unit: seconds.
    patience: float = 300.0
    #: Units waiting or running on a worker.
    in_flight: int = 2


@dataclass(eq=False)
class Worker:
    """The actor of a node."""

    node: str
    host: str
    cpus: int
    actor: Any
    #: The reference of the result of `prepare` while that runs; None afterwards.
    preparing: Any
    #: Running and waiting units, by the references of their reports.
    units: dict[Any, Any] = field(default_factory=dict)
    #: Notes of the work about this worker.
    notes: dict[str, Any] = field(default_factory=dict)

    @property
    def is_ready(self) -> bool:
        """True if it can take units."""
        return self.preparing is None


class Work(Protocol):
    """The work of a crew."""

    #: The class of the actors.
    actor: type
    #: The number of units that an actor processes at a time.
    concurrency: int

    def prepare(self, actor: Any, cpus: int) -> Any:
        """Make an actor ready; return the reference of its description."""
        ...

    def check(self, report: dict[str, Any]) -> str | None:
        """Return the reason to exclude an actor with this description. None: it can take part."""
        ...

    def next(self, worker: Worker, workers: int) -> Hashable | None:
        """Return the next unit for a worker. None: there is none at the moment."""
        ...

    def submit(self, worker: Worker, unit: Any) -> tuple[Any, Any]:
        """Start a unit; return the references of its report and of its result."""
        ...

    def done(self, worker: Worker, unit: Any, report: dict[str, Any], result: Any) -> None:
        """Accept the result of a unit."""
        ...

    def again(self, unit: Any) -> None:
        """Take back an unfinished unit."""
        ...

    def name(self, unit: Any) -> str:
        """Return a readable name of a unit."""
        ...

    def pending(self) -> list[Any]:
        """Return the references of other running tasks of the work."""
        ...

    def turn(self) -> bool:
        """Process results between units. False: the work is finished."""
        ...


class Crew:
    """Gives the units of a :class:`Work` to workers until the work is finished."""

    #: The interval between searches for nodes. Unit: seconds.
    LOOK_EVERY = 2.0

    def __init__(self, work: Work, limits: Limits) -> None:
        """Begin without workers."""
        self._work, self._limits = work, limits
        self._workers: dict[str, Worker] = {}
        self._results: dict[Any, Any] = {}
        self._refused: dict[str, str] = {}
        self._deaths: dict[str, int] = {}
        self._errors: dict[Any, int] = {}
        self._losses: dict[Any, int] = {}
        self._looked = self._worked = 0.0
        self._cause = ""

    def run(self) -> None:
        """Process all units.

        Errors: :class:`TaskFailedError`, :class:`NodeRefusedError`, :class:`ClusterError`.
        """
        self._worked = time.monotonic()
        try:
            while self._work.turn():
                self._look()
                self._wait()
                # Before the turn fetches results, so that workers need not wait for that.
                self._assign()
        finally:
            for worker in self._workers.values():
                ray.kill(worker.actor)

    def _look(self) -> None:
        """Start an actor on every live node without one."""
        now = time.monotonic()
        if now - self._looked < self.LOOK_EVERY:
            return
        self._looked = now
        alive = {node: (host, cpus) for node, host, cpus in alive_nodes()}
        for identity in [known for known in self._workers if known not in alive]:
            self._lose(self._workers[identity], "the node died")
        for identity, (host, cpus) in alive.items():
            if identity not in self._workers and identity not in self._refused:
                self._hire(identity, host, cpus)
        self._check_hope(now)

    def _check_hope(self, now: float) -> None:
        """Fail if no node can work."""
        if self._workers:
            self._worked = now
        elif self._refused:
            reasons = "; ".join(self._refused.values())
            raise NodeRefusedError(f"no node of the cluster can take part: {reasons}")
        elif now - self._worked > self._limits.patience:
            cause = f"; the last one: {self._cause}" if self._cause else ""
            message = f"no node was available for {self._limits.patience:.0f} s{cause}"
            raise ClusterError(message)

    def _hire(self, node: str, host: str, cpus: int) -> None:
        affinity = NodeAffinitySchedulingStrategy(node, soft=False)
        options = {
            "num_cpus": cpus,
            "max_restarts": 0,
            "max_task_retries": 0,
            "max_concurrency": self._work.concurrency,
            "scheduling_strategy": affinity,
        }
        actor: Any = ray.remote(self._work.actor).options(**options).remote()
        preparing = self._work.prepare(actor, cpus)
        self._workers[node] = Worker(node, host, cpus, actor, preparing)

    def _assign(self) -> None:
        ready = [worker for worker in self._workers.values() if worker.is_ready]
        # Every worker gets its first unit before any gets a second one.
        for round_ in range(self._limits.in_flight):
            for worker in ready:
                if len(worker.units) > round_:
                    continue
                unit = self._work.next(worker, len(ready))
                if unit is None:
                    continue
                report, result = self._work.submit(worker, unit)
                worker.units[report] = unit
                self._results[report] = result

    def _wait(self) -> None:
        owners = {}
        for worker in self._workers.values():
            references = worker.units if worker.is_ready else [worker.preparing]
            owners.update(dict.fromkeys(references, worker))
        references = [*owners, *self._work.pending()]
        if not references:
            time.sleep(0.2)
            return
        ready, _ = ray.wait(references, num_returns=1, timeout=1.0)
        for reference in ready:
            # The worker may have been lost with an earlier reference.
            owner = owners.get(reference)
            if owner is not None and self._workers.get(owner.node) is owner:
                self._hear(owner, reference)

    def _hear(self, worker: Worker, reference: Any) -> None:
        try:
            report: Any = ray.get(reference)
        except RayError as error:
            # The loss of an actor's input is a failure of the cluster, not of the work.
            if isinstance(error, RayTaskError) and not isinstance(error.cause, RayError):
                self._fail(worker, reference, error)
            else:
                self._lose(worker, first_line(error))
        else:
            self._answer(worker, reference, report)

    def _answer(self, worker: Worker, reference: Any, report: dict[str, Any]) -> None:
        if reference != worker.preparing:
            self._deaths[worker.node] = 0
            unit = worker.units.pop(reference)
            self._work.done(worker, unit, report, self._results.pop(reference))
            return
        worker.preparing = None
        reason = self._work.check(report)
        if reason is not None:
            self._refuse(worker, reason)

    def _fail(self, worker: Worker, reference: Any, error: RayTaskError) -> None:
        """Handle an error raised by the work."""
        cause = error.cause if isinstance(error.cause, Exception) else error
        text = f"{type(cause).__name__.removeprefix('RayTaskError')}: {first_line(cause)}"
        if reference == worker.preparing:
            self._refuse(worker, text)
            return
        unit = worker.units.pop(reference)
        self._results.pop(reference)
        times = self._errors[unit] = self._errors.get(unit, 0) + 1
        name = self._work.name(unit)
        if times >= self._limits.errors:
            message = f"{name} failed {times} times, the last time on {worker.host}: {text}"
            raise TaskFailedError(message) from cause
        logger.warning("%s failed on %s, and is tried again: %s", name, worker.host, text)
        self._work.again(unit)

    def _refuse(self, worker: Worker, reason: str) -> None:
        """Exclude a node."""
        logger.warning("the node %s is left out: %s", worker.host, reason)
        self._refused[worker.node] = f"{worker.host}: {reason}"
        self._dismiss(worker)

    def _dismiss(self, worker: Worker) -> list[Any]:
        """Remove a worker; return its units."""
        del self._workers[worker.node]
        ray.kill(worker.actor)
        for reference in worker.units:
            self._results.pop(reference, None)
        return list(worker.units.values())

    def _lose(self, worker: Worker, cause: str) -> None:
        """Handle the loss of a worker: its units go to others."""
        logger.warning("the worker on %s is lost: %s", worker.host, cause)
        self._cause = f"{worker.host}: {cause}"
        units = self._dismiss(worker)
        for unit in units:
            times = self._losses[unit] = self._losses.get(unit, 0) + 1
            if times >= self._limits.losses:
                name = self._work.name(unit)
                raise TaskFailedError(f"{name} lost its worker {times} times: {self._cause}")
            self._work.again(unit)
        deaths = self._deaths[worker.node] = self._deaths.get(worker.node, 0) + 1
        if deaths >= self._limits.deaths:
            self._refused[worker.node] = f"{self._cause} ({deaths} times)"
        # The next search starts a new actor immediately.
        self._looked = 0.0


def alive_nodes() -> list[tuple[str, str, int]]:
    """Return name, host and number of processors of all live nodes with processors."""
    nodes: list[dict[str, Any]] = ray.nodes()  # type: ignore[no-untyped-call]
    alive = [node for node in nodes if node["Alive"]]
    found = [(n["NodeID"], n["NodeManagerHostname"], int(n["Resources"].get("CPU", 0))) for n in alive]
    return [(node, host, cpus) for node, host, cpus in found if cpus > 0]


def first_line(error: BaseException) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return lines[0] if lines else type(error).__name__


def connected(address: str | None) -> Callable[[], None]:
    """Connect to a cluster unless this process is connected; return a function that disconnects."""
    if ray.is_initialized():
        return lambda: None
    if address == "local":
        ray.init(address="local", include_dashboard=False, log_to_driver=False)
    else:
        ray.init(address=address, log_to_driver=False)
    return ray.shutdown
