"""Figures: tables, the file that stores them, and comparisons with it.

Figures are what the file has: the versions that made them, and numbers per sample of each scene and method,
of stages and of functions.
"""

import json
from pathlib import Path

import harness

KEPT = Path(__file__).with_name("figures.json")
# Relative changes above this are shown; compilers and libraries cause smaller ones.
TOLERANCE = 0.03
# Changes of smaller parts of a sample are ignored. Unit: instructions.
LEAST = 200.0


def load():
    return json.loads(KEPT.read_text(encoding="utf-8"))


def save(figures):
    KEPT.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")


def changes(new, kept):
    """Returns the figures that differ from the stored ones by more than the tolerance: (name, before, now)."""
    before, now = _compared(kept), _compared(new)
    return [(name, before[name], now[name]) for name in now
            if name in before and _is_change(name, before[name], now[name])]


def _compared(figures):
    """Returns the numbers that are compared, by name."""
    found = {"%s: %s" % (name, key): row[key] for name, row in figures["samples"].items()
             for key in ("instructions", "rays")}
    return found | {"stage " + name: count for name, count in figures["stages"].items()}


def _is_change(name, before, now):
    # `other` contains the waking of threads, which depends on the machine.
    if name == "stage other" or (name.startswith("stage ") and max(before, now) < LEAST):
        return False
    return abs(now - before) > TOLERANCE * before


def report(new, kept):
    """Formats the tables and the changes."""
    parts = [_samples(new["samples"])]
    if new["stages"]:
        parts += [_stages(new["stages"]), _functions(new)]
    lines = ["- %s: %g, was %g (%+.1f %%)" % (name, now, before, 100 * (now / before - 1))
             for name, before, now in changes(new, kept) if before > 0]
    lines += ["- %s: new" % name for name in _compared(new) if name not in _compared(kept)]
    title = "Changed by more than %g %%:" % (100 * TOLERANCE)
    parts.append("\n".join([title, "", *lines]) if lines else title + " nothing.")
    parts.append("Compared with figures of %s." % kept["made_with"])
    return "\n\n".join(parts)


def _samples(samples):
    """Formats a table with scenes in rows and methods in columns."""
    pairs = [name.split(", ", 1) for name in samples]
    scenes, methods = [list(dict.fromkeys(pair[i] for pair in pairs)) for i in (0, 1)]
    title = "thousands of instructions per sample (rays per sample, instructions per ray)"
    rows = [["`%s`" % scene, *(_cell(samples.get("%s, %s" % (scene, method))) for method in methods)]
            for scene in scenes]
    return harness.table([title, *("`%s`" % method for method in methods)], rows)


def _cell(row):
    if row is None:
        return "-"
    return "%.1f (%.2f, %d)" % (row["instructions"] / 1e3, row["rays"], row["instructions_per_ray"])


def _stages(stages):
    total = sum(stages.values())
    head = ["stage of `bdpt`, `room-indirect`", "thousands of instructions per sample", "share"]
    return harness.table(head, [[name, "%.2f" % (count / 1e3), "%.1f %%" % (100 * count / total)]
                                for name, count in stages.items()])


def _functions(figures):
    total = sum(figures["stages"].values())
    return harness.table(["function, of the same", "its own share", "with what it calls"],
                         [["`%s`" % name, *("%.1f %%" % (100 * count / total) for count in counts)]
                          for name, *counts in figures["functions"]])
