"""Finding mods in folders and among installed packages, and the order in which they can be loaded."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from pinjoint.components.language import tr
from pinjoint.documents.library import data_folder
from pinjoint.mods.mod import MANIFEST, Mod, read_manifest

GROUP = "pinjoint.mods"  # entry points of installed packages
PROGRAM = "pinjoint"  # what a mod calls the program that it requires


def mods_folder() -> Path:
    """The folder with a person's mods, a folder each; it need not exist yet."""
    return data_folder() / "mods"


def in_folder(folder: Path) -> list[Mod]:
    """The mod that a folder is, or the mods in it, by name of their folders."""
    if (folder / MANIFEST).is_file():
        return [read_manifest(folder, str(folder))]
    try:
        inside = sorted(entry for entry in folder.iterdir() if entry.is_dir() and entry.name[0] not in "._")
    except OSError:
        return []
    files = (MANIFEST, "__init__.py")
    return [read_manifest(made, str(made)) for made in inside if any((made / file).is_file() for file in files)]


def in_packages() -> list[Mod]:
    """The mods of installed packages, by name."""
    files = (file for path in sys.path for file in Path(path).glob("*-info/entry_points.txt"))
    if not any(GROUP.encode() in file.read_bytes() for file in files):
        return []  # in 1 ms: importlib.metadata takes 50 ms to import
    from importlib.metadata import entry_points

    return [_of_package(point.name, point.value) for point in sorted(entry_points(group=GROUP))]


def _of_package(name: str, module: str) -> Mod:
    module = module.partition(":")[0].strip()
    source = f"package {module}"
    try:
        spec = importlib.util.find_spec(module)
    except (ImportError, ValueError):
        spec = None
    if spec is None or spec.origin is None:
        problem = tr("There is no module '{module}'; install it again.", module=module)
        return Mod(name, module, source=source, problem=problem)
    made = read_manifest(Path(spec.origin).parent, source, name)
    made.module = module
    return made


def origin_of_module(name: str) -> str | None:
    """Where the Python module of a name is from, such as its file or "built-in"; None if there is none."""
    if name in sys.modules:
        return str(getattr(sys.modules[name], "__file__", None) or "built-in")
    spec = importlib.util.find_spec(name)
    return spec.origin if spec is not None else None  # a folder without __init__.py has no origin


# --- order ---------------------------------------------------------------------------------------------


def in_order(found: Iterable[Mod], version: str, loaded: Sequence[Mod] = ()) -> list[Mod]:
    """The mods that can be loaded, each after those that it requires, otherwise by name.

    The others get a problem: a name that is taken (the first found has it), a requirement that is missing
    or of a wrong version, or one that leads back to the mod. version: of the program. loaded: mods that
    are there already.
    """
    by_name: dict[str, Mod] = {mod.name: mod for mod in loaded}
    new: dict[str, Mod] = {}
    for mod in found:
        if mod.name in by_name:
            taken = tr(
                "There is a mod of this name already, from {source}; rename one of them.",
                source=by_name[mod.name].source,
            )
            mod.problem = mod.problem or taken
        else:
            by_name[mod.name] = new[mod.name] = mod
    ordered: list[Mod] = []
    for name in _sorted(new):
        mod = new[name]
        mod.problem = mod.problem or _unmet(mod, by_name, version)
        if not mod.off:
            ordered.append(mod)
    return ordered


def required(mod: Mod) -> list[str]:
    """Names of what a mod requires, the program included."""
    return [_parts(entry)[0] for entry in mod.requires]


def _sorted(mods: dict[str, Mod]) -> Iterator[str]:
    """Names of mods, each after those that it requires; every mod that requires itself gets that problem."""
    left = sorted(mods)
    while left:
        usable = [mods[name] for name in left if not mods[name].off]
        awaited = {mod.name: [name for name in required(mod) if name in left] for mod in usable}
        ready = next((name for name in left if not awaited.get(name)), None)
        if ready is not None:
            left.remove(ready)
            yield ready
            continue
        chain = [left[0]]
        while chain[-1] not in chain[:-1]:
            chain.append(awaited[chain[-1]][0])
        chain = chain[chain.index(chain[-1]) :]
        for name in chain[:-1]:
            mods[name].problem = tr(
                "These mods require each other: {chain}; remove one of the requirements.",
                chain=" → ".join(chain),
            )


def _parts(entry: str) -> tuple[str, str]:
    """A requirement's name and its range of versions."""
    from packaging.requirements import Requirement

    parsed = Requirement(entry)
    return parsed.name, str(parsed.specifier)


def _unmet(mod: Mod, by_name: dict[str, Mod], version: str) -> str:
    """The first requirement of a mod that is not met, as a sentence; "" if all are."""
    from packaging.specifiers import SpecifierSet

    for entry in mod.requires:
        name, allowed = _parts(entry)
        other = by_name.get(name)
        if name == PROGRAM:
            present = version
        elif other is None:
            return tr(
                "It requires the mod '{name}', which is not installed; install it, or remove the requirement.",
                name=name,
            )
        elif other.off:
            return tr(
                "It requires the mod '{name}', which cannot be used: {problem}",
                name=name,
                problem=other.problem,
            )
        else:
            present = other.version
        if not SpecifierSet(allowed).contains(present, prereleases=True):
            return tr(
                "It requires {name} {allowed}, but {name} {present} is installed; use another version of one of them.",
                name=name,
                allowed=allowed,
                present=present,
            )
    return ""
