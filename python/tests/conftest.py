"""Shared fixtures."""

from __future__ import annotations

from pathlib import Path

import pytest

import bidir

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.fixture(scope="session")
def scenes() -> Path:
    """Return the folder of the project's scenes."""
    return SCENES


@pytest.fixture(scope="session")
def cornell() -> bidir.Scene:
    """Return a small scene whose pictures are wider than high."""
    return bidir.load(SCENES / "cornell.pbrt", size=(24, 24), crop=(0, 0, 24, 16))


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Try a test again, on a fresh cluster, where its cluster lost a node that it did not kill.

    A machine without time to spare may let a node miss its checks: that is no fault of what is tested.
    """
    if pyfuncitem.get_closest_marker("ray") is None:
        return None
    nodes = pyfuncitem.funcargs["nodes"]
    arguments = {name: pyfuncitem.funcargs[name] for name in pyfuncitem._fixtureinfo.argnames}
    attempts = 3
    for attempt in range(1, attempts + 1):
        try:
            pyfuncitem.obj(**arguments)
            break
        except Exception:
            if attempt == attempts or not nodes.has_lost_any():
                raise
            print(f"the cluster lost a node: attempt {attempt + 1} of {attempts}")
            nodes.stop()
            nodes.start()
    return True
