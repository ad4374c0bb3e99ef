"""The public interface agrees with its types and is documented."""

from __future__ import annotations

import ast
import importlib.util
import inspect
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import bidir
from bidir import _bidir

PACKAGE = Path(bidir.__file__).parent


def names_of(module: ModuleType) -> set[str]:
    """Return the public names of a module."""
    return {name for name in dir(module) if not name.startswith("_")}


def members(tree: ast.ClassDef) -> dict[str, list[str]]:
    """Return the methods of a class with the names of their parameters."""
    found = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            found[node.name] = [a.arg for a in arguments if a.arg not in ("self", "cls")]
    return found


def test_the_native_module_agrees_with_its_stub() -> None:
    tree = ast.parse((PACKAGE / "_bidir.pyi").read_text())
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    values = {
        node.target.id
        for node in tree.body
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    }
    assert functions.keys() | classes.keys() | values == names_of(_bidir)
    for name, node in functions.items():
        actual = list(inspect.signature(getattr(_bidir, name)).parameters)
        assert actual == [argument.arg for argument in node.args.args], name
    for name, node in classes.items():
        kind = getattr(_bidir, name)
        stated = members(node)
        here = {member for member in vars(kind) if not member.startswith("__")}
        assert here == {member for member in stated if not member.startswith("__")}, name
        for method in here:
            value = inspect.getattr_static(kind, method)
            if inspect.isgetsetdescriptor(value):
                continue
            actual = list(inspect.signature(getattr(kind, method)).parameters)
            assert [a for a in actual if a != "self"] == stated[method], f"{name}.{method}"


def test_stubtest_finds_no_difference() -> None:
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed")
    command = [sys.executable, "-m", "mypy.stubtest", "bidir._bidir", "--concise"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


def test_everything_public_is_listed_and_documented() -> None:
    modules = {name for name in dir(bidir) if inspect.ismodule(getattr(bidir, name))}
    assert names_of(bidir) - modules == set(bidir.__all__) - {"__version__"}
    for name in bidir.__all__:
        thing = getattr(bidir, name)
        if not (inspect.isclass(thing) or inspect.isfunction(thing)):
            continue
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                is_documented = inspect.isfunction(value) or isinstance(value, property)
                if is_documented and not member.startswith("_"):
                    assert inspect.getdoc(value), f"{name}.{member}"


def test_array_types_document_their_shape() -> None:
    for thing in (bidir.Image.pixels, bidir.Image.layers, bidir.read_image, bidir.error_map):
        assert "hape: (" in (inspect.getdoc(thing) or ""), thing


def test_the_package_is_typed() -> None:
    assert (PACKAGE / "py.typed").exists()
