"""An experiment over the nodes of a cluster: each renders all methods of a scene, budget and seed."""

from __future__ import annotations

import json
import os
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ray
from ray.exceptions import RayError
from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

from bidir import _bidir
from bidir.experiment import Experiment, Results
from bidir.ray._crew import ClusterError, Crew, Limits, Worker, alive_nodes, connected, logger
from bidir.ray._render import versions
from bidir.scene import StrPath, load

__all__ = ["Bench", "experiment"]

#: A file by its names, with its bytes.
MemoryFile = tuple[list[str], bytes]


def machine(cpus: int) -> str:
    """Describe the hardware that the times of a node depend on; runs on the node."""
    return json.dumps({**json.loads(_bidir.machine()), "threads": cpus}, sort_keys=True)


class Bench:
    """The actor of a node: it renders blocks of an experiment."""

    def prepare(self, description: dict[str, Any], cpus: int) -> dict[str, Any]:
        """Read the description; return versions and hardware of the node."""
        self.experiment = _bidir.Experiment(**description)
        return {**versions(), "machine": machine(cpus)}

    def render(
        self, block: str, files: list[MemoryFile], reference: tuple[list[int], bytes]
    ) -> tuple[dict[str, Any], Any]:
        """Render a block; return its records with the kept images."""
        return {}, _bidir.render_block(self.experiment, block, files, reference)


class ExperimentWork:
    """The work of a :class:`bidir.ray._crew.Crew`: units are blocks, as JSON."""

    #: One block at a time, since times are compared.
    concurrency = 1

    def __init__(
        self,
        prepared: _bidir.Prepared,
        description: dict[str, Any],
        machine: str,
        report: Callable[[str, str], None],
        actor: type = Bench,
    ) -> None:
        self.actor = actor
        self._prepared, self._description, self._machine = prepared, description, machine
        self._report = report
        self._todo = list(reversed(prepared.blocks))
        self._running = 0
        self._losses = 0
        self._scenes: dict[str, tuple[Any, Any]] = {}
        for name, path, files, size, pixels in prepared.scenes:
            self._scenes[name] = (
                ray.put(_packed(os.fspath(path), files)),
                ray.put((size, pixels)),
            )

    def prepare(self, actor: Any, cpus: int) -> Any:
        return actor.prepare.remote(self._description, cpus)

    def check(self, report: dict[str, Any]) -> str | None:
        for name, here in versions().items():
            if report[name] != here:
                return f"its {name} of bidir is {report[name]}, here it is {here}"
        if report["machine"] != self._machine:
            return f"it is another machine, whose times cannot be compared: {report['machine']}"
        return None

    def next(self, worker: Worker, workers: int) -> str | None:
        if not self._todo:
            return None
        self._running += 1
        return self._todo.pop()

    def submit(self, worker: Worker, unit: str) -> tuple[Any, Any]:
        files, reference = self._scenes[json.loads(unit)["scene"]]
        report, done = worker.actor.render.options(num_returns=2).remote(unit, files, reference)
        return report, done

    def done(self, worker: Worker, unit: str, report: dict[str, Any], result: Any) -> None:
        try:
            records: Any = ray.get(result)
        except RayError as error:
            self._lose(unit, error)
            return
        self._running -= 1
        self._prepared.add(records)
        self._report(unit, self.name(unit))

    def _lose(self, unit: str, error: RayError) -> None:
        """Render a block again after the loss of its records."""
        logger.warning("%s: the records were lost: %s", self.name(unit), error)
        self._losses += 1
        if self._losses > Limits.losses:
            raise ClusterError("records are lost repeatedly before they reach the driver")
        self.again(unit)

    def again(self, unit: str) -> None:
        self._running -= 1
        self._todo.append(unit)

    def name(self, unit: str) -> str:
        block = json.loads(unit)
        return f"{block['scene']}, {block['budget']}, seed {block['seed']}"

    def pending(self) -> list[Any]:
        return []

    def turn(self) -> bool:
        return bool(self._todo) or self._running > 0


def _packed(path: str, files: list[Any]) -> list[MemoryFile]:
    """Return the files of a scene by their names."""
    # The experiment has already reported the warnings of `load`.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        _, source = load(path).packed()
    names = {name for known, _ in source["memory"] for name in known}
    missing = {os.fspath(file) for file in files} - names
    if missing:
        raise ClusterError(f"{path}: a file of the scene changed after it was read")
    memory: list[MemoryFile] = source["memory"]
    return memory


def _fleet() -> tuple[str, int]:
    """Return the most frequent machine of the nodes, and its number of processors.

    Errors: :class:`bidir.ray.ClusterError` if no node has processors.
    """
    machines = []
    for node, _, cpus in alive_nodes():
        affinity = NodeAffinitySchedulingStrategy(node, soft=False)
        task: Any = ray.remote(machine).options(num_cpus=0, scheduling_strategy=affinity)
        machines.append(task.remote(cpus))
    if not machines:
        raise ClusterError("no node of the cluster has a processor")
    most, _ = Counter(ray.get(machines)).most_common(1)[0]
    return most, json.loads(most)["threads"]


def experiment(
    experiment: Experiment | StrPath,
    folder: StrPath,
    *,
    address: str | None = None,
    quick: bool = False,
    restart: bool = False,
    progress: Callable[[str, int, int], object] | None = None,
    limits: Limits | None = None,
    _actor: type = Bench,
) -> Results:
    """Run an experiment on the nodes of a cluster; except for times, records equal those of one machine.

    All methods of a scene, a budget and a seed run on one node with all of its threads, and all nodes that
    take part are alike, so times are comparable. This process renders missing references and keeps all
    results; after an interruption the same call continues.

    Args:
        experiment: The experiment, or the file of its description.
        folder: The folder of the results.
        address: Address of the cluster, as for :func:`render`.
        quick: As for :class:`bidir.Experiment`, if a file is given.
        restart: Discard existing records; references stay.
        progress: A function of the finished render, the number done and the total.
        limits: Numbers of retries.

    Errors: :class:`bidir.ExperimentError`, those of :func:`bidir.load`; :class:`TaskFailedError` with the
    part that keeps failing; :class:`NodeRefusedError`, :class:`ClusterError`.
    """
    given = experiment
    if not isinstance(given, Experiment):
        given = Experiment.load(given, quick=quick)
    Path(folder).mkdir(parents=True, exist_ok=True)
    disconnect = connected(address)
    try:
        kind, cpus = _fleet()
        described = Experiment(given.text, file=given.file, quick=given.quick, threads=cpus)
        prepared = described._native.prepare(os.fspath(folder), restart, kind, _hearing(progress))
        if prepared is None:
            raise KeyboardInterrupt
        of = described.cells
        methods = {block: len(json.loads(block)["methods"]) for block in prepared.blocks}
        done = of - sum(methods.values())

        def report(block: str, name: str) -> None:
            nonlocal done
            done += methods[block]
            if progress is not None:
                progress(name, done, of)

        description = {
            "text": described.text,
            "file": described.file,
            "quick": described.quick,
            "threads": cpus,
        }
        work = ExperimentWork(prepared, description, kind, report, _actor)
        Crew(work, limits or Limits(in_flight=1)).run()
        # All records exist now; this writes the results.
        found, tables = described._native.run(os.fspath(folder), False, kind, None)
    finally:
        disconnect()
    if found is None:
        raise KeyboardInterrupt
    return Results(Path(folder), json.loads(found), tables)


def _hearing(
    progress: Callable[[str, int, int], object] | None,
) -> Callable[[str, str, int, int], object]:
    """Return a listener for the events before the first run."""

    def hear(kind: str, text: str, done: int, of: int) -> None:
        if kind == "warning":
            warnings.warn(_bidir.printable(text), stacklevel=4)
        elif progress is not None and kind != "render":
            progress(f"{kind} {text}".strip(), done, of)

    return hear
