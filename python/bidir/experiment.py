"""Experiments: scenes by methods by budgets by seeds, each render compared with a reference."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bidir import _bidir, check
from bidir.errors import SettingsError
from bidir.scene import StrPath
from bidir.settings import Integrator, integrator_of

__all__ = ["Experiment", "Results"]


@dataclass(frozen=True)
class Results:
    """The results of an experiment; ``results.json`` and ``report.html`` in its folder contain them too."""

    #: The folder of the results.
    folder: Path
    #: All of ``results.json``.
    data: dict[str, Any]
    #: Means over seeds and ratios to the first method, with 95 % intervals, as text.
    tables: str

    @property
    def records(self) -> list[dict[str, Any]]:
        """One record per render: scene, method, budget, seed, spp, seconds, rays, metrics."""
        records: list[dict[str, Any]] = self.data["records"]
        return records

    def values(self, metric: str, *, scene: str, method: str, budget: str) -> list[float]:
        """Return a metric for all seeds, in ascending order of the seed."""
        wanted = {"scene": scene, "method": method, "budget": budget}
        found = [r for r in self.records if all(r[key] == wanted[key] for key in wanted)]
        return [record["metrics"][metric] for record in sorted(found, key=lambda r: int(r["seed"]))]

    def __str__(self) -> str:
        """Return the tables."""
        return self.tables


class Experiment:
    """The description of an experiment; docs/reference/experiments.md lists its keys."""

    def __init__(
        self,
        text: str,
        *,
        file: StrPath = "experiment.toml",
        quick: bool = False,
        threads: int | None = None,
    ) -> None:
        """Read a description.

        Args:
            text: The description, TOML.
            file: Its name in messages; scenes and references are relative to its folder.
            quick: Few seeds, small images, an eighth of the budgets.
            threads: Threads of each render, instead of the description's; 0 is one per processor.

        Errors: :class:`bidir.ExperimentError` with line and column.
        """
        self.text, self.file = text, os.fspath(file)
        self.quick, self.threads = quick, threads
        self._native = _bidir.Experiment(text, self.file, quick=quick, threads=threads)

    @classmethod
    def load(cls, path: StrPath, *, quick: bool = False, threads: int | None = None) -> Experiment:
        """Read a description from a file.

        Errors: :class:`OSError`, :class:`bidir.ExperimentError`.
        """
        text = Path(path).read_text(encoding="utf-8")
        return cls(text, file=path, quick=quick, threads=threads)

    @classmethod
    def of(
        cls,
        *,
        scenes: Mapping[str, StrPath],
        methods: Mapping[str, Integrator | type[Integrator] | str],
        budgets: Sequence[Mapping[str, float]],
        title: str = "An experiment",
        seeds: int = 3,
        size: tuple[int, int] | str | None = None,
        reference_spp: int | None = None,
        references: Mapping[str, StrPath] | None = None,
        metrics: Sequence[str] = ("relmse",),
        threads: int | None = None,
    ) -> Experiment:
        """Describe an experiment with Python values.

        Args:
            scenes: Files by name.
            methods: Integrators by name; ratios are relative to the first.
            budgets: Each ``{"samples": 64}``, ``{"rays": 500}`` (per pixel) or ``{"seconds": 10}``.
            title: Title of the report.
            seeds: Number of seeds.
            size: Width and height of all images, instead of the scenes'. Unit: pixels.
            reference_spp: Samples per pixel of references that are rendered first.
            references: Existing references, images or folders, by the names of scenes.
            metrics: Names of :data:`bidir.METRICS`, in addition to ``rmse``.
            threads: Threads of each render; 0 is one per processor.

        Errors: :class:`bidir.SettingsError` if a scene has no reference,
        :class:`bidir.ExperimentError`.
        """
        seeds = check.count("seeds", seeds, 1)
        lines = [f"title = {_toml(title)}", f"seeds = {seeds}", f"metrics = {_toml(list(metrics))}"]
        if size is not None:
            width, height = check.size("size", size)
            lines.append(f'size = "{width}x{height}"')
        for name, file in scenes.items():
            path = os.fspath(Path(file).absolute())
            lines += ["[[scene]]", f"name = {_toml(name)}", f"file = {_toml(path)}"]
            given = (references or {}).get(name)
            if given is not None:
                lines.append(f"reference = {_toml(os.fspath(Path(given).absolute()))}")
            elif reference_spp is not None:
                lines.append(f"reference-spp = {check.count('reference_spp', reference_spp, 1)}")
            else:
                raise SettingsError(f"the scene {name} has no reference: give reference_spp")
        for name, given_integrator in methods.items():
            integrator = integrator_of(given_integrator)
            if integrator is None:
                check.refuse(f"methods[{name!r}]", "an integrator", None)
            flags = integrator.flags()
            lines += ["[[method]]", f"name = {_toml(name)}"]
            lines += [f"{flag} = {_setting(flag, value)}" for flag, value in flags.items()]
        for budget in budgets:
            lines.append("[[budget]]")
            lines += [f"{kind} = {amount}" for kind, amount in budget.items()]
        return cls("\n".join(lines) + "\n", threads=threads)

    @property
    def title(self) -> str:
        """The title."""
        return self._native.title

    @property
    def cells(self) -> int:
        """The number of renders, without references."""
        return self._native.cells

    def run(
        self,
        folder: StrPath,
        *,
        restart: bool = False,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Results:
        """Render and compare everything that has no record in ``folder`` yet.

        Args:
            folder: The folder of the results; an interrupted run continues there.
            restart: Discard existing records; references stay.
            progress: A function of the current render, the number done and the total.

        Errors: :class:`bidir.ExperimentError`, those of :func:`bidir.load`, and
        :class:`KeyboardInterrupt`, after which the same call continues.
        """

        def hear(kind: str, text: str, done: int, of: int) -> None:
            if kind == "warning":
                warnings.warn(_bidir.printable(text), stacklevel=3)
            elif progress is not None:
                progress(f"{kind} {text}".strip(), done, of)

        Path(folder).mkdir(parents=True, exist_ok=True)
        found, tables = self._native.run(os.fspath(folder), restart, None, hear)
        if found is None:
            raise KeyboardInterrupt
        return Results(Path(folder), json.loads(found), tables)


def _toml(value: object) -> str:
    """Return a text or a list of texts as TOML, whose strings are those of JSON."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _setting(flag: str, value: str) -> str:
    """Return a setting in the notation of descriptions, with numbers unquoted."""
    numbers = {"max-depth", "candidates", "next-events", "samples-per-subpath"}
    return value if flag in numbers and value.isdigit() else _toml(value)
