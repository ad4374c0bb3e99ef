"""Tests of this tool: python3 -m pytest tools/bench_auto/tests.py"""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[1]))

import figures

SPP = 4


def noisy(variance, seeds, seed, common=0.0):
    """Return images of mean 1 with a given variance of samples, and a common part of blocks."""
    rng = np.random.default_rng(seed)
    own = rng.normal(1.0, np.sqrt(variance / SPP), (seeds, 48, 64, 3))
    shared = np.sqrt(common / SPP) * rng.normal(size=(seeds, 3, 4, 3))
    return own + shared.repeat(figures.BLOCK, axis=1).repeat(figures.BLOCK, axis=2)


def test_known_variances_are_found():
    images = {"path": noisy(2.0, 64, 1), "bdpt": noisy(0.5, 64, 2, common=0.1)}
    seconds = {"path": np.full(64, 3e-6), "bdpt": np.full(64, 8e-6)}
    found = figures.products(images, seconds, SPP)
    for name, variance, common, time in (("path", 2.0, 0.0, 3.0), ("bdpt", 0.5, 0.1, 8.0)):
        pixels, blocks = found[name].pixels(), found[name].of_blocks
        # The thousandth that is left out has little more than the others.
        assert pixels == pytest.approx((variance + common) * time / 1.01, rel=0.02)
        assert blocks == pytest.approx((variance / figures.BLOCK**2 + common) * time / 1.01, rel=0.15)


def test_a_seed_that_takes_longer_counts_for_its_time():
    calm, wild = noisy(0.1, 64, 3), noisy(0.9, 64, 4)
    images = {"auto": np.concatenate([calm, wild])}
    seconds = np.repeat([1e-6, 3e-6], 64)
    found = figures.products(images, {"auto": seconds}, SPP)["auto"].pixels()
    assert found == pytest.approx((0.1 * 1.0 + 0.9 * 3.0) / 2 / 1.01, rel=0.02)


def test_the_noisiest_thousandth_is_left_out():
    values = np.ones((2, 50, 40))
    values[:, 3, 4] = values[:, 5, 6] = 1e9
    assert figures.trimmed(values).mean() == pytest.approx(1.0)
    assert figures.by_block(figures.trimmed(values)).mean() == pytest.approx(1.0)
    values[:, 7, 8] = 1e9
    assert figures.trimmed(values).mean() > 1e5


def test_auto_is_measured_by_the_best_of_the_others():
    parts = {"path": 2.0, "bdpt": 1.0, "lvc": 0.5, "auto": 0.625}
    products = {name: figures.Product(np.full((3, 4), part)) for name, part in parts.items()}
    products["auto"].of_blocks = 0.25
    row = figures.Row("room", products, ["lvc", "bdpt", "lvc"])
    table = figures.table([row])
    assert row.behind() == 1.25
    assert row.interval() == pytest.approx((1.25, 1.25))
    assert "| room | 2 | 1 | 0.5 | 0.625 (64) | 1.25 | 1.25 to 1.25 | 1.60 | lvc (2 of 3) |" in table
    assert "1 scenes: 1.250 (geometric mean), 1.25 to 1.25." in table


def test_nine_of_ten_intervals_hold_the_ratio():
    held, widths = 0, []
    for seed in range(60):
        images = {"auto": noisy(0.6, 6, 2 * seed), "bdpt": noisy(0.5, 6, 2 * seed + 1)}
        products = figures.products(images, dict.fromkeys(images, np.ones(6)), SPP)
        low, high = figures.Row("room", products, ["lvc"] * 6).interval()
        held += low <= 1.2 <= high
        widths.append(high - low)
    # 60 draws of 0.9: 47 or more with a probability of 0.998. Seeds and blocks drawn apart make it wider.
    assert held >= 47
    # 2 x 1.645 standard deviations of a ratio of variances, of 5 x 9216 differences each, are 0.037.
    assert 0.9 < np.mean(widths) / 0.037 < 2.0
