"""Estimators and rules as values."""

from __future__ import annotations

import dataclasses
import typing

import numpy as np
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
    assert bidir.Session(cornell, bidir.Auto()).settings["integrator"] in {"path", "bdpt", "lvc"}


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


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ("bdpt", "bdpt"),
        ("path", "path"),
        (bidir.Bdpt, "bdpt"),
        (bidir.Lvc, "lvc"),
        (bidir.Light(), "light"),
        (bidir.Auto, "auto"),
    ],
)
def test_integrators_are_given_as_values_classes_or_names(
    cornell: bidir.Scene, given: str | type[bidir.Integrator] | bidir.Integrator, name: str
) -> None:
    image = bidir.render(cornell, given, spp=1)
    assert image.film.settings["integrator"] == name
    expected = bidir.render(cornell, bidir.settings.INTEGRATORS[name](), spp=1)
    assert (image.pixels == expected.pixels).all()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("bpdt", "integrator: unknown name `bpdt`: did you mean `bdpt`?"),
        ("photons", "integrator: unknown name `photons`: expected path, light"),
        (3, "integrator: expected an integrator such as .*, or one of path, light, bdpt, lvc, auto, not 3"),
        (bidir.Integrator, "integrator: expected an integrator"),
        (bidir.PerPair, "integrator: expected an integrator"),
        (["bdpt"], r"integrator: expected .*, not \['bdpt'\]"),
        (np.zeros(3), "integrator: expected an integrator"),
        (int, "integrator: expected .*, not <class 'int'>"),
    ],
)
def test_other_integrators_are_refused(cornell: bidir.Scene, given: object, words: str) -> None:
    for use in (bidir.render, bidir.Session):
        with pytest.raises(bidir.SettingsError, match=words):
            use(cornell, given)  # type: ignore[arg-type]


def test_rules_are_given_as_values_classes_or_texts() -> None:
    for rule in (bidir.PerPair(), bidir.PerPair, "per-pair"):
        assert bidir.Bdpt(shadow_rays=rule).flags()["shadow-rays"] == "per-pair"  # type: ignore[arg-type]
    with pytest.raises(bidir.SettingsError, match=r"Budget needs arguments, such as bidir.Budget\(…\)"):
        bidir.Bdpt(shadow_rays=bidir.Budget)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("argument", "given", "words"),
    [
        ("spp", 4.0, "spp: expected a whole number from 1 to .*, not 4.0"),
        ("spp", "4", "spp: expected a whole number from 1 to .*, not '4'"),
        ("spp", 0, "spp: expected .*, not 0"),
        ("spp", True, "spp: expected .*, not True"),
        ("spp", 2**64, "spp: expected .*, not 18446744073709551616"),
        ("time", "10s", "time: expected a number, 0 or more, not '10s'"),
        ("time", -1, "time: expected .*, not -1"),
        ("noise", float("nan"), "noise: expected .*, not nan"),
        ("noise", None.__class__, "noise: expected a number"),
        ("seed", 1.5, "seed: expected a whole number from 0 to .*, not 1.5"),
        ("seed", -1, "seed: expected .*, not -1"),
        ("threads", "two", "threads: expected .*, not 'two'"),
        ("threads", -1, "threads: expected .*, not -1"),
        ("strategy_layers", 3.5, "strategy_layers: expected .*, not 3.5"),
        ("layers", 3, "layers: expected names among albedo, .*, not 3"),
        ("layers", [3], r"layers: expected names among albedo, .*, not \[3\]"),
        ("checkpoint", 3, "checkpoint: expected the name of a file, not 3"),
        ("checkpoint_every", "1m", "checkpoint_every: expected a number, 0 or more, not '1m'"),
    ],
)
def test_arguments_of_another_kind_are_named(
    cornell: bidir.Scene, argument: str, given: object, words: str
) -> None:
    with pytest.raises(bidir.SettingsError, match=words):
        bidir.render(cornell, bidir.Path(max_depth=1), **{"spp": 1, argument: given})  # type: ignore[arg-type]


def test_whole_numbers_of_numpy_are_whole_numbers(cornell: bidir.Scene) -> None:
    image = bidir.render(cornell, "path", spp=np.int32(2), seed=np.uint64(3))  # type: ignore[arg-type]
    assert image.film.spp == 2
    assert image.film.settings["seed"] == "3"


def test_a_scene_of_another_kind_is_refused() -> None:
    with pytest.raises(bidir.SettingsError, match=r"scene: expected a bidir\.Scene or .*, not 3"):
        bidir.render(3)  # type: ignore[arg-type]
