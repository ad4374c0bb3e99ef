"""Films of parts, merged on the cluster before they come to the driver.

Every ``fan_in`` films of a level become one of the next by a task on some node, so that the driver
fetches one film where many were rendered, and holds two at a time: the sum, and what it adds.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import Any

import ray
from ray.exceptions import RayError

from bidir.film import Film
from bidir.ray._crew import first_line

__all__ = ["Part", "Tree"]

logger = logging.getLogger("bidir.ray")


@dataclass(frozen=True)
class Part:
    """A film on the cluster: its reference, and the ranges of passes that it has."""

    film: Any
    ranges: tuple[range, ...]


def merged(*films: bytes) -> tuple[dict[str, int], bytes]:
    """Merge films; runs on the cluster."""
    film = Film.merge(Film.from_bytes(film) for film in films)
    return {"spp": film.spp}, film.to_bytes()


class Tree:
    """Parts by level, and the tasks that merge them."""

    def __init__(self, fan_in: int) -> None:
        """Begin without parts."""
        self.fan_in = fan_in
        #: Films are fetched from this level on.
        self.top = 0
        self._levels: dict[int, list[Part]] = {}
        self._merging: dict[Any, tuple[int, list[Part], Any]] = {}

    def set_workers(self, workers: int) -> None:
        """Make the tree as high as so many workers need it."""
        self.top, reach = 0, 1
        while reach < workers:
            self.top, reach = self.top + 1, reach * self.fan_in

    def add(self, part: Part, level: int = 0) -> None:
        """Add a film, and begin to merge where there are enough of its level."""
        parts = self._levels.setdefault(level, [])
        parts.append(part)
        if level < self.top and len(parts) >= self.fan_in:
            self._levels[level] = []
            task = ray.remote(merged).options(
                num_cpus=0, num_returns=2, max_retries=0, scheduling_strategy="SPREAD"
            )
            answer: Any = task.remote(*[part.film for part in parts])
            report, film = answer
            self._merging[report] = (level + 1, parts, film)

    def pending(self) -> list[Any]:
        """Return the references of merges that run."""
        return list(self._merging)

    #: Why films were lost, the last time.
    cause = ""

    def settle(self) -> list[range]:
        """Take films that were merged; return the passes of those that were lost on the way."""
        lost: list[range] = []
        if not self._merging:
            return lost
        ready, _ = ray.wait(list(self._merging), num_returns=len(self._merging), timeout=0)
        for report in ready:
            level, parts, film = self._merging.pop(report)
            ranges = tuple(r for part in parts for r in part.ranges)
            try:
                ray.get(report)
            except RayError as error:
                self.cause = first_line(error)
                logger.warning("films were lost before they were merged: %s", self.cause)
                lost.extend(ranges)
            else:
                self.add(Part(film, ranges), level)
        return lost

    def fetchable(self, everything: bool) -> Part | None:
        """Take a film for the driver: one from the top, or of any level if ``everything`` is."""
        for level in sorted(self._levels, reverse=True):
            if (level >= self.top or everything) and self._levels[level]:
                return self._levels[level].pop(0)
        return None

    def is_empty(self) -> bool:
        """Tell whether no film is left."""
        return not self._merging and not any(self._levels.values())
