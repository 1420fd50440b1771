"""How much a person must hold in mind: what the source weighs may fall, and rises only where a commit says why."""

import ast
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCE = [path for top in ("components", "systems", "game", "assets") for path in (ROOT / top).rglob("*.py")]
CONTAINERS = ("list", "dict", "set", "deque", "defaultdict", "OrderedDict", "Counter", "WeakKeyDictionary")
FUNCTION = ast.FunctionDef | ast.AsyncFunctionDef

MOST = {
    "lines": 72_926,
    "files": 389,
    "names": 3_900,  # functions, classes and constants of modules
    "public names": 2_236,
    "numbers": 1_486,  # other than 0, 1 and 2, in constants and defaults
    "registers": 47,  # containers that fill while the program runs, and caches of functions
    "lines of tests": 61_287,
}


def numbers(value: ast.AST | None) -> int:
    """Literal numbers in a value, without those in functions that stand there."""
    if value is None or isinstance(value, FUNCTION | ast.Lambda):
        return 0
    own = isinstance(value, ast.Constant) and type(value.value) in (int, float) and value.value not in (0, 1, 2)
    return own + sum(map(numbers, ast.iter_child_nodes(value)))


def fills(value: ast.AST | None) -> bool:
    """Whether a value is a container that something is put into later."""
    if isinstance(value, ast.Call):
        called = ast.unparse(value.func).split(".")[-1]
        return called in CONTAINERS and (not value.args or called in ("defaultdict", "Counter", "deque"))
    return isinstance(value, ast.List | ast.Set | ast.Dict) and not list(ast.iter_child_nodes(value))[:-1]


def weight(files: Iterable[Path]) -> Counter[str]:
    total: Counter[str] = Counter()
    for path in files:
        text = path.read_text(encoding="utf-8")
        module = ast.parse(text)
        names: list[str] = []
        total.update(lines=text.count("\n"), files=1)
        for node in ast.walk(module):
            body = node.body if isinstance(node, ast.Module | ast.ClassDef) else []
            if isinstance(node, FUNCTION):
                total["numbers"] += sum(map(numbers, (*node.args.defaults, *node.args.kw_defaults)))
                decorators = map(ast.unparse, node.decorator_list)
                total["registers"] += any("cache" in d and "cached_property" not in d for d in decorators)
            for item in body:
                if isinstance(item, ast.Assign | ast.AnnAssign):
                    total.update(numbers=numbers(item.value), registers=fills(item.value))
                if node is module and isinstance(item, FUNCTION | ast.ClassDef):
                    names.append(item.name)
                elif node is module and isinstance(item, ast.Assign | ast.AnnAssign):
                    targets = item.targets if isinstance(item, ast.Assign) else [item.target]
                    names += [t.id for t in targets if isinstance(t, ast.Name) and t.id.strip("_").isupper()]
        total.update({"names": len(names), "public names": sum(not n.startswith("_") for n in names)})
    return total


@pytest.fixture(scope="module")
def found() -> Counter[str]:
    return weight(SOURCE) + Counter({"lines of tests": weight((ROOT / "tests").rglob("*.py"))["lines"]})


@pytest.mark.parametrize("what", MOST)
def test_the_source_does_not_grow(found: Counter[str], what: str) -> None:
    assert found[what] <= MOST[what], (
        f"{found[what]} {what}, {found[what] - MOST[what]} more than before. Find what the new part makes superfluous and"
        f" delete it; if it is worth its weight, raise MOST in {Path(__file__).name} and say in the commit why."
    )


def test_what_is_counted() -> None:
    """A check of the counting itself, on a file of which all is known."""
    ROOM = (3, 4.5, 1)
    assert numbers(ast.parse(f"ROOM = {ROOM}").body[0]) == 2
    filling = ("[]", "{}", "dict()", "defaultdict(list)", "deque(maxlen=3)")
    assert all(fills(ast.parse(text, mode="eval").body) for text in filling)
    assert not any(fills(ast.parse(text, mode="eval").body) for text in ("[1]", "{1: 2}", "dict(a)", "()"))
