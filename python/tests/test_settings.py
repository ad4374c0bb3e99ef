"""Estimators and rules as values."""

from __future__ import annotations

import dataclasses
import typing

import pytest

import bidir
from bidir import _bidir


def test_settings_are_those_of_the_flags() -> None:
    lvc = bidir.Lvc(
        shadow_rays=bidir.Budget(3),
        candidates=(8, 2),
        next_events=(3, 1),
        proposal="uniform",
        light_start="power",
        samples_per_subpath=8,
        mis="power",
        strategies="all,-s0",
        light_point="shared",
        light_choice="power",
        path_roulette="throughput:3",
        max_depth=0,
        sampler="independent",
    )
    assert lvc.flags() == {
        "integrator": "lvc",
        "shadow-rays": "budget:3",
        "candidates": "8,2",
        "next-events": "3,1",
        "proposal": "uniform",
        "light-start": "power",
        "samples-per-subpath": "8",
        "mis": "power",
        "strategies": "all,-s0",
        "light-point": "shared",
        "light-choice": "power",
        "path-roulette": "throughput:3",
        "max-depth": "0",
        "sampler": "independent",
    }


@pytest.mark.parametrize("kind", [bidir.Path, bidir.Light, bidir.Bdpt, bidir.Lvc, bidir.Auto])
def test_classes_have_the_settings_of_the_command(kind: type[bidir.Integrator]) -> None:
    own = {field.name.replace("_", "-") for field in dataclasses.fields(kind)}
    if kind is bidir.Auto:
        # It is a subclass of Lvc, but ignores this setting.
        own.remove("samples-per-subpath")
    assert {"integrator", *own} == set(_bidir.settings_of(kind.__name__.lower()))


@pytest.mark.parametrize("name", ["mis", "light_choice", "light_point", "proposal", "light_start"])
def test_the_names_of_values_are_those_of_the_command(name: str) -> None:
    values = typing.get_args(typing.get_args(typing.get_type_hints(bidir.Lvc)[name])[0])
    with pytest.raises(bidir.SettingsError) as refused:
        bidir.Lvc(**{name: "zzzzzz"})  # type: ignore[arg-type]
    assert set(values) == set(str(refused.value).split("expected ")[1].split(", "))


def test_candidates_may_be_left_to_the_estimator() -> None:
    assert bidir.Auto(candidates="auto").flags() == {"integrator": "auto", "candidates": "auto"}


def test_older_names_are_taken_with_a_warning() -> None:
    with pytest.warns(DeprecationWarning, match="`emission` is now `light_start`"):
        lvc = bidir.Lvc(emission="power")
    assert lvc == bidir.Lvc(light_start="power")
    assert dataclasses.replace(lvc, mis="power").light_start == "power"
    with pytest.warns(DeprecationWarning, match="`suited` is now `auto`"):
        bidir.Bdpt(shadow_rays="suited")


@pytest.mark.parametrize(
    "rule",
    [
        bidir.All(),
        bidir.PerLightVertex(),
        bidir.PerCameraVertex(),
        bidir.PerPair(),
        bidir.RayRoulette(0.25),
        bidir.Budget(2),
    ],
    ids=str,
)
def test_rules_reach_the_render(cornell: bidir.Scene, rule: bidir.Selector) -> None:
    session = bidir.Session(cornell, bidir.Bdpt(shadow_rays=rule))
    assert session.settings["shadow-rays"] == str(rule)
    session.step()
    assert session.film() == bidir.render(cornell, bidir.Bdpt(shadow_rays=str(rule)), spp=1).film


def test_auto_chooses_an_integrator(cornell: bidir.Scene) -> None:
    assert bidir.Session(cornell, bidir.Auto()).settings["integrator"] in {"path", "lvc"}


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"mis": "balence"}, "mis: unknown name `balence`: did you mean `balance`"),
        ({"shadow_rays": "budget:0"}, "shadow_rays: there is no rule `budget:0`"),
        ({"strategies": "s"}, "strategies"),
        ({"max_depth": -1}, "max_depth: expected a whole number"),
    ],
)
def test_wrong_values_are_refused(settings: dict[str, object], words: str) -> None:
    with pytest.raises(bidir.SettingsError, match=words):
        bidir.Bdpt(**settings)  # type: ignore[arg-type]


def test_estimators_are_values() -> None:
    bdpt = bidir.Bdpt(shadow_rays=bidir.PerPair())
    assert bdpt == bidir.Bdpt(shadow_rays=bidir.PerPair())
    assert bdpt != dataclasses.replace(bdpt, max_depth=3)
    assert len({bdpt, bidir.Bdpt(), bidir.Lvc()}) == 3
    with pytest.raises(dataclasses.FrozenInstanceError):
        bdpt.max_depth = 4  # type: ignore[misc]


def test_unknown_layers_are_refused(cornell: bidir.Scene) -> None:
    with pytest.raises(bidir.SettingsError, match="layers: unknown name `albeda`: did you mean `albedo`"):
        bidir.render(cornell, spp=1, layers=["albeda"])
