"""Experiments from Python."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import bidir


@pytest.fixture(scope="module")
def experiment(scenes: Path) -> bidir.Experiment:
    """Return a small experiment."""
    return bidir.Experiment.of(
        title='Rays for "pairs"',
        scenes={"cornell": scenes / "cornell.pbrt"},
        methods={"all": bidir.Bdpt(max_depth=4), "one": bidir.Bdpt(shadow_rays=bidir.PerPair(), max_depth=4)},
        budgets=[{"samples": 2}, {"rays": 40}],
        seeds=2,
        size=(8, 8),
        reference_spp=64,
        threads=2,
    )


@pytest.mark.filterwarnings("ignore:.*noise of the reference")
def test_an_experiment_has_results(experiment: bidir.Experiment, tmp_path: Path) -> None:
    assert (experiment.cells, experiment.title) == (8, 'Rays for "pairs"')
    told: list[tuple[str, int, int]] = []
    results = experiment.run(tmp_path, progress=lambda *told_: told.append(told_))
    assert len(results.records) == 8
    assert told[-1][1:] == (8, 8)
    errors = results.values("rmse", scene="cornell", method="one", budget="2 spp")
    assert len(errors) == 2
    assert all(error > 0 for error in errors)
    assert "ratios to all" in str(results)
    assert json.loads((tmp_path / "results.json").read_text()) == results.data
    assert (tmp_path / "report.html").stat().st_size > 10_000
    # Existing records are kept with their times.
    again = bidir.Experiment(experiment.text, threads=2).run(tmp_path)
    assert again.data == results.data


def test_errors_of_descriptions_have_their_place(tmp_path: Path) -> None:
    path = tmp_path / "e.toml"
    path.write_text(
        'seeds = 2\n[[scene]]\nfile = "a"\nreference-spp = 4\n'
        "[[method]]\nname = 'm'\nmis = 'balence'\n[[budget]]\nsamples = 2\n"
    )
    with pytest.raises(bidir.ExperimentError, match="did you mean `balance`") as raised:
        bidir.Experiment.load(path)
    assert (raised.value.file, raised.value.line, raised.value.column) == (str(path), 7, 7)
    with pytest.raises(bidir.SettingsError, match="no reference"):
        bidir.Experiment.of(scenes={"a": "a.pbrt"}, methods={"a": bidir.Path()}, budgets=[{"samples": 1}])


def test_methods_and_sizes_are_given_by_name(scenes: Path) -> None:
    def described(**given: object) -> bidir.Experiment:
        settings: dict[str, Any] = {
            "methods": {"a": "path", "b": bidir.Bdpt},
            "seeds": 1,
            "reference_spp": 16,
            **given,
        }
        return bidir.Experiment.of(
            scenes={"box": scenes / "cornell.pbrt"},
            budgets=[{"samples": 1}],
            **settings,
        )

    assert described(size="8x6").cells == 2
    wrong: list[tuple[dict[str, object], str]] = [
        ({"size": 8}, "size: expected width and height"),
        ({"seeds": 1.5}, "seeds: expected a whole number from 1"),
        ({"reference_spp": "16"}, "reference_spp: expected a whole number from 1"),
        ({"methods": {"a": "pth"}}, "integrator: unknown name `pth`: did you mean `path`"),
        ({"methods": {"a": None}}, r"methods\['a'\]: expected an integrator, not None"),
    ]
    for given, words in wrong:
        with pytest.raises(bidir.SettingsError, match=words):
            described(**given)
