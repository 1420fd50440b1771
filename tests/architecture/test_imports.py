"""Who may import whom: components ← systems ← game ← tests, no circles, heavy libraries only where they are used."""

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping
from fnmatch import fnmatch
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path

import pytest

from pinjoint.systems import is_ours

ROOT = Path(__file__).parents[2]
LAYERS = ("components", "systems", "game", "tests")  # each may import itself and those before it
RESOURCES = "assets"
# of folders
NAMES = {top: f"pinjoint.{top}" for top in ("components", "systems", RESOURCES)} | {"game": "pinjoint"}
WINDOW = ("systems/render/*pygame_*.py", "systems/input/pygame_*.py", "game/app.py")
# The folders of systems/render, each with those that it must not import: what it is made for.
ROOMS = {
    "labels": ("model", "ui", "backends"),
    "model": ("ui", "backends"),
    "ui": ("backends",),
    "backends": ("labels", "model", "ui"),
}
COMPOSING = ("picture", "pygame_render")  # beside them, of all that they hold
COMPILER = "systems/program/machine_code.py"  # numba is imported as soon as it is
COMPILED = (COMPILER, "systems/program/*.py")
SHARED = ("is_ours", "base", "broad_phase", "islands", "program")  # by all systems
COMPOSED = ("program", "run", "catalogue.py")  # of what other folders of systems hold
MODULES_OF = {"pygame-ce": "pygame", "pillow": "PIL"}  # distributions whose module has another name

PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT, SETUPTOOLS = PYPROJECT["project"], PYPROJECT["tool"]["setuptools"]


def distributions(requirements: list[str]) -> set[str]:
    """The modules that come with requirements such as "numpy>=2"."""
    names = {re.split(r"[^\w.-]", requirement, maxsplit=1)[0] for requirement in requirements}
    return {MODULES_OF.get(name, name) for name in names}


REQUIREMENTS = [PROJECT["dependencies"], *PROJECT["optional-dependencies"].values()]
DECLARED = set[str]().union(*map(distributions, REQUIREMENTS))


def imported(source: str, path: str) -> Iterator[tuple[int, str]]:
    """Line and full name of every module or name that a file imports, at whatever depth it does."""
    package = module_name(path).split(".")
    package = package if path.endswith("__init__.py") else package[:-1]
    for node in ast.walk(ast.parse(source, path)):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield node.lineno, alias.name
        elif isinstance(node, ast.ImportFrom):
            parents = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*parents, *filter(None, [node.module])])
            for alias in node.names:
                yield node.lineno, f"{module}.{alias.name}"


def within(path: str, patterns: tuple[str, ...]) -> bool:
    return any(fnmatch(path, pattern) for pattern in patterns)


def broken_rule(path: str, name: str) -> str | None:
    """The rule that a file breaks by importing a full name, or None."""
    layer, top = path.split("/")[0], folder_of(name)
    if top in LAYERS and name.split(".")[0] not in NAMES:
        return broken_order(path, layer, top, name)
    if name.split(".")[0] in NAMES:
        return "it is imported as a part of pinjoint, for a second copy of a module has registers of its own"
    if top == RESOURCES:
        return None if layer in ("game", "tests") else "only game imports assets; read them as resources"
    if top in sys.stdlib_module_names or layer == "tests":
        return None
    if layer == "components" and top not in ("numpy", "esper"):
        return "components import only the standard library, numpy and esper"
    if top not in DECLARED:
        return "pyproject.toml does not declare it"
    if top == "pygame" and not within(path, WINDOW):
        return "pygame is imported only by the window's backends"
    if top == "numba" and not within(path, COMPILED):
        return "numba is imported only by machine_code.py and the step program"
    return None


def broken_order(path: str, layer: str, top: str, name: str) -> str | None:
    if LAYERS.index(top) > LAYERS.index(layer):
        return f"{layer} must not import {top}"
    if layer == top == "systems":
        own, (other, *rest) = path.split("/")[1], name.split(".")[2:]
        shared = other in SHARED or rest[:1] == ["kernels"] or own in COMPOSED
        if own.removesuffix(".py") != other and not shared:
            return f"systems meet in columns and events; they import only {', '.join(SHARED)} and kernels of each other"
        inside = own == other == "render" and path.split("/")[2].removesuffix(".py")
        if inside and inside not in COMPOSING and {*ROOMS.get(inside, ROOMS), *COMPOSING} & {*rest[:1]}:
            return "no arrow runs up inside systems/render: what a picture needs is handed down"
    return None


def files() -> list[str]:
    return sorted(p.relative_to(ROOT).as_posix() for layer in LAYERS for p in (ROOT / layer).rglob("*.py"))


def imports_of(sources: Mapping[str, str]) -> dict[str, set[str]]:
    """For every module of some files, source by path, the others among them that it imports, anywhere in the file.

    Importing a module of another package runs the __init__.py of that package, too.
    """
    paths = {module_name(path): path for path in sources}
    graph: dict[str, set[str]] = {}
    for name, path in paths.items():
        graph[name] = set()
        for _, wanted in imported(sources[path], path):
            while wanted and wanted not in paths:
                wanted = wanted.rpartition(".")[0]
            graph[name].add(wanted)
            while (wanted := wanted.rpartition(".")[0]) and not f"{name}.".startswith(f"{wanted}."):
                graph[name] |= {wanted} & paths.keys()
        graph[name] -= {name, ""}
    return graph


def module_name(path: str) -> str:
    """The name that the module in a file is imported by."""
    top, *rest = path.removesuffix(".py").removesuffix("/__init__").split("/")
    return ".".join([NAMES.get(top, top), *rest])


def folder_of(name: str) -> str:
    """The folder at the top in which a module lies, or the package that it belongs to if that is not ours."""
    package, _, rest = name.partition(".")
    part = rest.partition(".")[0]
    return package if package != "pinjoint" else part if part in NAMES else "game"


def circle(graph: Mapping[str, set[str]]) -> list[str]:
    """Modules that import each other in turn, the first again at the end; none if there is no circle."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(reversed(error.args[1]))
    return []


# --- the program -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("layer", LAYERS)
def test_imports_point_one_way(layer: str) -> None:
    paths = [path for path in files() if path.split("/")[0] == layer]
    assert len(paths) > 3
    broken = [
        f"{path}:{line} imports {name}: {rule}"
        for path in paths
        for line, name in imported((ROOT / path).read_text(encoding="utf-8"), path)
        if (rule := broken_rule(path, name))
    ]
    assert not broken, "\n".join(broken)


def test_no_modules_import_each_other() -> None:
    """Neither at the top of files nor in functions nor behind TYPE_CHECKING."""
    paths = [path for path in files() if not path.startswith("tests/")]
    found = circle(imports_of({path: (ROOT / path).read_text(encoding="utf-8") for path in paths}))
    assert not found, " → ".join(found)


def modules(layer: str) -> list[str]:
    """The modules of a layer that are there without a window and before anything is compiled."""
    backends = (*WINDOW, COMPILER, "*/__main__.py")
    paths = [path for path in files() if path.split("/")[0] == layer and not within(path, backends)]
    return [module_name(path) for path in paths]


@pytest.mark.parametrize(
    ("names", "unwanted"),
    [
        (["pinjoint"], ["pygame", "numba", "scipy", "matplotlib", "numpy", "pinjoint.components"]),
        (modules("components"), ["pygame", "numba", "scipy", "msgspec"]),
        (modules("systems"), ["pygame", "numba"]),
        (modules("game"), ["pygame", "numba"]),
    ],
    ids=["import pinjoint", "components", "systems", "game"],
)
def test_importing_loads_neither_a_window_nor_a_compiler(names: list[str], unwanted: list[str]) -> None:
    code = f"import sys, importlib\nfor name in {names}: importlib.import_module(name)\n"
    code += f"print(*sorted(set({unwanted}) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == []


SECOND_COPY = re.compile(
    r"""(?:\bimport|\bfrom|-m"?,?|files\("?)[ "]?(?:game|systems|components|assets)(?:\.[a-z_]|[ "'\\`);,]|$)""",
    re.M,
)


def test_nothing_is_imported_by_the_name_of_its_folder() -> None:
    """In a checkout that works, and gives a second copy of every register; elsewhere it is somebody else's package."""
    tracked = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    texts = [
        path
        for path in tracked
        if path.endswith((".py", ".md", ".toml", ".po", ".jsonl")) and path != "CHANGELOG.md"
    ]
    here = Path(__file__).relative_to(ROOT).as_posix()
    found = {
        path: SECOND_COPY.findall((ROOT / path).read_text(encoding="utf-8")) for path in texts if path != here
    }
    assert not {path: lines for path, lines in found.items() if lines}
    assert not set(NAMES) & set(sys.modules)


def test_the_packages_that_are_installed_are_the_folders() -> None:
    there = {
        module_name(path) for path in files() if path.endswith("__init__.py") and not path.startswith("tests/")
    }
    assert set(SETUPTOOLS["packages"]) == there | {"pinjoint.assets"}
    assert SETUPTOOLS["package-dir"] == {name: top for top, name in NAMES.items()}


@pytest.mark.parametrize(
    ("module", "ours"),
    [
        ("pinjoint.systems.physics.kernels", True),
        ("pinjoint.included.walls", True),
        ("wind", False),
        ("pinjoint_wind", False),
    ],
)
def test_ours_are_told_from_others_by_name(module: str, ours: bool) -> None:
    assert is_ours(module) is ours


# --- the rules themselves ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("components/rod.py", "import pinjoint.systems"),
        ("components/rod.py", "from pinjoint.session import Session"),
        ("components/rod.py", "def f():\n    import scipy"),
        ("components/rod.py", "if TYPE_CHECKING:\n    from pinjoint.systems.base import System"),
        ("systems/physics/system.py", "from pinjoint.systems.plasticity.system import Yielding"),
        ("systems/physics/system.py", "from pinjoint.systems import plasticity"),
        ("systems/physics/system.py", "from ..plasticity import system"),
        ("systems/physics/system.py", "import pygame.gfxdraw"),
        ("systems/render/scene.py", "import pygame"),
        ("systems/render/marks.py", "from pinjoint.systems.render.ui.layout import Row"),
        ("systems/render/model/sheet.py", "from pinjoint.systems.render.ui.overlays import BAR"),
        ("systems/render/ui/form.py", "from pinjoint.systems.render import picture"),
        ("systems/base.py", "from pinjoint.systems.physics.system import Elasticity"),
        ("game/session.py", "import systems.base"),
        ("tests/unit/test_rod.py", "from game import Session"),
        ("game/session.py", "from tests.reference import models"),
        ("systems/physics/kernels.py", "from numba import njit"),
        ("game/session.py", "import requests"),
    ],
)
def test_a_forbidden_import_is_found(path: str, line: str) -> None:
    assert any(broken_rule(path, name) for _, name in imported(line, path))


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("components/rod.py", "import math, numpy as np\nfrom .field import Field\nimport esper"),
        ("systems/physics/system.py", "from pinjoint.systems.base import Law"),
        ("systems/physics/system.py", "from pinjoint.systems.plasticity.kernels import limited"),
        ("systems/physics/system.py", "from pinjoint.systems.plasticity import kernels\nfrom . import kernels"),
        ("systems/render/backends/pygame_canvas.py", "import pygame.gfxdraw"),
        ("game/app.py", "import pygame\nfrom pinjoint.systems.physics.system import Elasticity"),
        ("systems/program/compiler.py", "import numba"),
        ("systems/render/ui/overlays.py", "from pinjoint.systems.render.model.sheet import Sheet"),
        ("game/documents/models.py", "import msgspec, pinjoint.assets"),
        ("tests/unit/test_rod.py", "import pinjoint.systems.base, hypothesis"),
    ],
)
def test_an_allowed_import_is_allowed(path: str, line: str) -> None:
    assert not [name for _, name in imported(line, path) if broken_rule(path, name)]


@pytest.mark.parametrize(
    ("sources", "expected"),
    [
        (
            {"game/a.py": "import pinjoint.b", "game/b.py": "from pinjoint import a"},
            ["pinjoint.a", "pinjoint.b"],
        ),
        (
            {"game/a.py": "from pinjoint.b import x", "game/b.py": "def f():\n    from pinjoint.a import y"},
            ["pinjoint.a", "pinjoint.b"],
        ),
        (
            {"game/a.py": "import pinjoint.b", "game/b.py": "if TYPE_CHECKING:\n    from pinjoint.a import A"},
            ["pinjoint.a", "pinjoint.b"],
        ),
        (
            {"game/a.py": "from .b import x", "game/b.py": "from .c import y", "game/c.py": "from .a import z"},
            ["pinjoint.a", "pinjoint.b", "pinjoint.c"],
        ),
        (  # a package is run before its modules
            {"game/a.py": "import pinjoint.b.c", "game/b/__init__.py": "import pinjoint.a", "game/b/c.py": ""},
            ["pinjoint.a", "pinjoint.b"],
        ),
    ],
    ids=["at the top", "in a function", "for types", "three", "a package"],
)
def test_a_circle_is_found(sources: dict[str, str], expected: list[str]) -> None:
    found = circle(imports_of(sources))
    assert found[0] == found[-1]
    assert sorted(found[1:]) == expected
    graph = imports_of(sources)
    assert all(later in graph[earlier] for earlier, later in pairwise(found))


def test_a_package_may_import_its_modules() -> None:
    sources = {
        "game/b/__init__.py": "from pinjoint.b.c import x",
        "game/b/c.py": "from pinjoint.b import d",
        "game/b/d.py": "",
    }
    assert circle(imports_of(sources)) == []
