"""Partial films, merged on the cluster before the driver fetches them.

A task on some node merges every ``fan_in`` films of a level into one of the next, so that the driver fetches
few films, and holds only two at a time: the sum and the film to add.
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
    """A film on the cluster: its reference, and its ranges of passes."""

    film: Any
    ranges: tuple[range, ...]


def merged(*films: bytes) -> tuple[dict[str, int], bytes]:
    """Merge films; runs on the cluster."""
    film = Film.merge(Film.from_bytes(film) for film in films)
    return {"spp": film.spp}, film.to_bytes()


class Tree:
    """Parts by level, and the running merges."""

    def __init__(self, fan_in: int) -> None:
        """Begin without parts."""
        self.fan_in = fan_in
        #: The driver fetches films from this level on.
        self.top = 0
        self._levels: dict[int, list[Part]] = {}
        self._merging: dict[Any, tuple[int, list[Part], Any]] = {}

    def set_workers(self, workers: int) -> None:
        """Set the height of the tree for a number of workers."""
        self.top, reach = 0, 1
        while reach < workers:
            self.top, reach = self.top + 1, reach * self.fan_in

    def add(self, part: Part, level: int = 0) -> None:
        """Add a film, and merge the films of its level if there are enough."""
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
        """Return the references of running merges."""
        return list(self._merging)

    #: The cause of the last loss of films.
    cause = ""

    def settle(self) -> list[range]:
        """Collect merged films; return the passes of lost ones."""
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
        """Take a film for the driver: from the top, or from any level if ``everything`` is true."""
        for level in sorted(self._levels, reverse=True):
            if (level >= self.top or everything) and self._levels[level]:
                return self._levels[level].pop(0)
        return None

    def is_empty(self) -> bool:
        """Return True if no film is left."""
        return not self._merging and not any(self._levels.values())
