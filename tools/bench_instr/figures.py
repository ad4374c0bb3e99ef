"""Figures: tables, the file that stores them, and comparisons with it."""

import json
import os

# Relative changes above this are shown; compilers and libraries cause smaller ones.
TOLERANCE = 0.03
# Changes of smaller parts of a sample are ignored. Unit: instructions.
LEAST = 200.0


def from_measured(measured, made_with):
    """Converts figures for the file: the versions that made them, and numbers per sample by name."""
    return {
        "made_with": made_with,
        "samples": {"%s, %s" % (row.scene, row.method): {
            "instructions": round(row.instructions),
            "rays": round(row.rays, 3),
            "instructions_per_ray": round(row.instructions / row.rays),
        } for row in measured.rows},
        "stages": {name: round(count) for name, count in measured.stages.items()},
        "functions": [[name, round(own), round(whole)] for name, own, whole in measured.functions],
    }


def load(path):
    """Reads the stored figures; empty if there is no file."""
    if not os.path.exists(path):
        return {"made_with": "", "samples": {}, "stages": {}, "functions": []}
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def save(path, figures):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(figures, file, indent=1)
        file.write("\n")


def changes(new, kept):
    """Returns the figures that differ from the stored ones by more than the tolerance: (name, before, now)."""
    found = []
    for name, row in new["samples"].items():
        if name in kept["samples"]:
            before = kept["samples"][name]
            found += [("%s: %s" % (name, key), before[key], row[key])
                      for key in ("instructions", "rays")]
    found += [("stage %s" % name, kept["stages"][name], count)
              for name, count in new["stages"].items() if name in kept["stages"]]
    return [one for one in found if _is_change(*one)]


def _is_change(name, before, now):
    # `other` contains the waking of threads, which depends on the machine.
    if name == "stage other" or (name.startswith("stage ") and max(before, now) < LEAST):
        return False
    return abs(now - before) > TOLERANCE * before


def missing(new, kept):
    """Returns the names without a stored figure."""
    return ([name for name in new["samples"] if name not in kept["samples"]]
            + ["stage %s" % name for name in new["stages"] if name not in kept["stages"]])


def report(new, kept):
    """Formats the tables and the changes."""
    parts = [_table(new["samples"])]
    if new["stages"]:
        parts += [_stages(new["stages"]), _functions(new)]
    lines = ["%s: %g, was %g (%+.1f %%)" % (name, now, before, 100 * (now / before - 1))
             for name, before, now in changes(new, kept) if before > 0]
    lines += ["%s: new" % name for name in missing(new, kept)]
    parts.append(_list("Changed by more than %g %%" % (100 * TOLERANCE), lines))
    parts.append("Compared with figures of %s." % (kept["made_with"] or "nobody"))
    return "\n\n".join(parts)


def _list(title, lines):
    if not lines:
        return title + ": nothing."
    return "\n".join([title + ":", ""] + ["- " + line for line in lines])


def _table(samples):
    """Formats a table with scenes in rows and methods in columns."""
    pairs = [name.split(", ", 1) for name in samples]
    scenes, methods = [list(dict.fromkeys(pair[i] for pair in pairs)) for i in (0, 1)]
    lines = ["| thousands of instructions per sample (rays per sample, instructions per ray) | "
             + " | ".join("`%s`" % method for method in methods) + " |",
             "|---|" + "---:|" * len(methods)]
    for scene in scenes:
        cells = [_cell(samples.get("%s, %s" % (scene, method))) for method in methods]
        lines.append("| `%s` | %s |" % (scene, " | ".join(cells)))
    return "\n".join(lines)


def _cell(row):
    if row is None:
        return "-"
    return "%.1f (%.2f, %d)" % (row["instructions"] / 1e3, row["rays"],
                                row["instructions_per_ray"])


def _stages(stages):
    total = sum(stages.values())
    lines = ["| stage of `bdpt`, `room-indirect` | thousands of instructions per sample | share |",
             "|---|---:|---:|"]
    lines += ["| %s | %.2f | %.1f %% |" % (name, count / 1e3, 100 * count / total)
              for name, count in stages.items()]
    return "\n".join(lines)


def _functions(figures):
    total = sum(figures["stages"].values())
    lines = ["| function, of the same | its own share | with what it calls |", "|---|---:|---:|"]
    lines += ["| `%s` | %.1f %% | %.1f %% |" % (name, 100 * own / total, 100 * whole / total)
              for name, own, whole in figures["functions"]]
    return "\n".join(lines)
