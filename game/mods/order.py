"""The order of mods: what each requires is checked before anything is loaded; then by dependency and name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from graphlib import CycleError, TopologicalSorter

from game.mods.mod import Mod

PROGRAM = "pinjoint"


def in_order(found: Iterable[Mod], version: str, loaded: Sequence[Mod] = ()) -> list[Mod]:
    """The mods that can be loaded, each after those that it requires, otherwise by name.

    The others are told their problem: a name that is taken (the first found has it), a requirement that is
    missing or of a wrong version, or one that leads back to the mod. version: of the program. loaded:
    mods that are there already.
    """
    by_name: dict[str, Mod] = {mod.name: mod for mod in loaded}
    candidates: list[Mod] = []
    for mod in found:
        if mod.name in by_name:
            mod.problem = (
                mod.problem or f"There is a mod of this name already, from {by_name[mod.name].source}."
            )
            continue
        by_name[mod.name] = mod
        candidates.append(mod)
    candidates.sort(key=lambda mod: mod.name)
    _refuse_cycles(candidates, by_name)
    ordered: list[Mod] = []
    while ready := [mod for mod in candidates if _is_ready(mod, by_name, candidates)]:
        candidates.remove(ready[0])
        ready[0].problem = ready[0].problem or _unmet(ready[0], by_name, version)
        if not ready[0].off:
            ordered.append(ready[0])
    return ordered


def required(mod: Mod) -> list[str]:
    """Names of what a mod requires, the program included."""
    return [_parts(entry)[0] for entry in mod.requires]


def _parts(entry: str) -> tuple[str, str]:
    """A requirement's name and its range of versions."""
    from packaging.requirements import Requirement

    parsed = Requirement(entry)
    return parsed.name, str(parsed.specifier)


def _is_ready(mod: Mod, by_name: dict[str, Mod], waiting: Sequence[Mod]) -> bool:
    return mod.off or not any(by_name.get(name) in waiting for name in required(mod))


def _refuse_cycles(mods: Sequence[Mod], by_name: dict[str, Mod]) -> None:
    """Refuse every mod that requires itself through others."""
    while True:
        usable = [mod for mod in mods if not mod.off]
        graph = {mod.name: [name for name in required(mod) if name in by_name] for mod in usable}
        try:
            TopologicalSorter(graph).prepare()
        except CycleError as error:
            chain: list[str] = error.args[1][::-1]
            for name in chain[:-1]:
                by_name[name].problem = f"These mods require each other: {' → '.join(chain)}; drop one."
            continue
        return


def _unmet(mod: Mod, by_name: dict[str, Mod], version: str) -> str:
    """Why a mod cannot have what it requires, or ""."""
    from packaging.specifiers import SpecifierSet

    for entry in mod.requires:
        name, allowed = _parts(entry)
        other = by_name.get(name)
        if name == PROGRAM:
            present = version
        elif other is None:
            return f"It requires the mod '{name}', which is not there; install it, or drop the requirement."
        elif other.off:
            return f"It requires the mod '{name}', which cannot be used: {other.problem}"
        else:
            present = other.version
        if not SpecifierSet(allowed).contains(present, prereleases=True):
            return f"It requires {name} {allowed}, but there is {name} {present}; take another version of one."
    return ""
