"""Finding mods: in folders, and among installed packages."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterable
from pathlib import Path

from game.documents.library import data_folder
from game.mods.manifest import MANIFEST, read_manifest
from game.mods.mod import Mod

GROUP = "pinjoint.mods"  # entry points of installed packages


def mods_folder() -> Path:
    """Where a person's mods lie, a folder each; it need not exist yet."""
    return data_folder() / "mods"


def in_folder(folder: Path) -> list[Mod]:
    """The mod that a folder is, or the mods in it, by name of their folders."""
    if (folder / MANIFEST).is_file():
        return [read_manifest(folder, str(folder))]
    try:
        inside = sorted(entry for entry in folder.iterdir() if entry.is_dir() and entry.name[0] not in "._")
    except OSError:
        return []
    return [read_manifest(entry, str(entry)) for entry in inside if _is_meant_as_mod(entry)]


def _is_meant_as_mod(folder: Path) -> bool:
    return (folder / MANIFEST).is_file() or (folder / "__init__.py").is_file()


def in_packages() -> list[Mod]:
    """The mods of installed packages, by name."""
    if not _any_entry_point():
        return []
    from importlib.metadata import entry_points

    return [_of_package(point.name, point.value) for point in sorted(entry_points(group=GROUP))]


def _any_entry_point() -> bool:
    """Whether an installed package might have a mod: importlib.metadata takes 50 ms to import, this 1 ms."""
    files: Iterable[Path] = (f for p in sys.path for f in Path(p).glob("*-info/entry_points.txt"))
    return any(GROUP.encode() in file.read_bytes() for file in files)


def _of_package(name: str, module: str) -> Mod:
    module = module.partition(":")[0].strip()
    source = f"package {module}"
    try:
        spec = importlib.util.find_spec(module)
    except (ImportError, ValueError):
        spec = None
    if spec is None or spec.origin is None:
        return Mod(name, module, source=source, problem=f"There is no module '{module}'; install it again.")
    made = read_manifest(Path(spec.origin).parent, source, name)
    made.module = module
    return made
