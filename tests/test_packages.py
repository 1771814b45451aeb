"""The house stands as ARCHITECTURE.md says: one import package, one direction, no name twice."""

import ast
import tomllib
from collections import Counter
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in (ROOT / "hp_gym").rglob("*.py")
}
MODULES = frozenset(name.removesuffix(".__init__") for name in FILES) | {"hp_gym._core"}

LAYERS = ("", "pictures", "envs", "agents", "studies", "cli")
"""Packages of `hp_gym`, the modules at its top first; each may import what stands before it."""


def imports(tree: ast.Module) -> Iterator[str]:
    """Names that a module imports, anywhere but for type checking."""
    nodes: list[ast.AST] = [tree]
    while nodes:
        node = nodes.pop()
        match node:
            case ast.If(test=ast.Name(id="TYPE_CHECKING")):
                nodes += node.orelse
            case ast.Import():
                yield from (alias.name for alias in node.names)
            case ast.ImportFrom(module=str(module)):
                for alias in node.names:
                    name = f"{module}.{alias.name}"
                    yield name if name in MODULES else module
            case _:
                nodes += ast.iter_child_nodes(node)


def needs(module: str, imported: str) -> set[str]:
    """Modules that an import loads: what it names, and packages around that which are not around both."""
    packages = {".".join(imported.split(".")[:length]) for length in range(1, imported.count(".") + 1)}
    return {imported} | {package for package in packages if not f"{module}.".startswith(f"{package}.")}


def graph() -> dict[str, set[str]]:
    """What every module of `hp_gym` imports of it."""
    edges: dict[str, set[str]] = {}
    for name, path in FILES.items():
        module = name.removesuffix(".__init__")
        tree = ast.parse(path.read_text(encoding="utf-8"))
        found = [imported for imported in imports(tree) if imported.split(".")[0] == "hp_gym"]
        edges[module] = {needed for imported in found for needed in needs(module, imported)}
    return edges


def layer(module: str) -> str:
    parts = module.split(".")
    return parts[1] if len(parts) > 1 and parts[1] in LAYERS else ""


def test_imports_have_no_circle() -> None:
    edges = graph()
    assert "hp_gym.trajectory" in edges["hp_gym.simulation"]
    assert "hp_gym.pictures.rendering" in edges["hp_gym.envs.env"]
    try:
        TopologicalSorter(edges).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


def test_imports_point_in_one_direction() -> None:
    wrong = [
        f"{module} imports {imported}"
        for module, found in graph().items()
        for imported in found
        if LAYERS.index(layer(imported)) > LAYERS.index(layer(module))
    ]
    assert wrong == []
    assert {layer(module) for module in MODULES} == set(LAYERS)


def test_no_two_modules_have_one_name() -> None:
    counts = Counter(module.rpartition(".")[2] for module in MODULES)
    assert [name for name, count in counts.items() if count > 1] == []


def test_the_wheel_has_one_top_level() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    maturin = project["tool"]["maturin"]
    assert maturin["python-packages"] == ["hp_gym"]
    assert maturin["module-name"].split(".")[0] == "hp_gym"
    assert "python-source" not in maturin
    assert {include["format"] for include in maturin["include"]} == {"sdist"}
    assert all(entry.startswith("hp_gym.") for entry in project["project"]["scripts"].values())
    assert [path.parent.name for path in ROOT.glob("*/__init__.py")] == ["hp_gym"]
