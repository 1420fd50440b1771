"""Loading mods: find them, put them in order, import them, register what they add; each mod wholly or not at all."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import ModuleType

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import tr
from pinjoint.documents.preferences import preferred_keys
from pinjoint.interrupts import is_persons, mark_interrupts
from pinjoint.mods import finding
from pinjoint.mods.app import App, check_plugin
from pinjoint.mods.declared import check_has_run
from pinjoint.mods.finding import in_order, required
from pinjoint.mods.mod import MANIFEST, Mod, ModError
from pinjoint.mods.surroundings import Surroundings
from pinjoint.systems.catalogue import all_systems
from pinjoint.systems.input.actions import ACTIONS
from pinjoint.systems.schedule import Schedule
from pinjoint.version import __version__

PATIENCE = 30.0  # s that loading one mod may take


def load(folders: Iterable[str | Path] = (), *, installed: bool = False) -> list[Mod]:
    """Load the mods in these folders (and, if `installed`, the person's own and those of packages).

    Returns all mods that were found, each with its `problem` if it was left out. Mods that are loaded stay.
    """
    found = [mod for folder in folders for mod in finding.in_folder(Path(folder))]
    if installed:
        found += [*finding.in_folder(finding.mods_folder()), *finding.in_packages()]
    known: dict[Path | None, Mod] = {
        mod.folder: mod for mod in EXTENSIONS.mods if mod.loaded and mod.folder is not None
    }
    new = [mod for mod in found if mod.folder not in known]
    ordered = in_order(new, __version__, [mod for mod in EXTENSIONS.mods if mod.loaded])
    EXTENSIONS.mods.extend(new)
    if ordered:
        mark_interrupts()
    for mod in ordered:
        _load(mod)
    EXTENSIONS.faults.extend(
        tr("The mod '{name}' was left out: {problem}", name=mod.name, problem=mod.problem)
        for mod in new
        if mod.off
    )
    for scene, key, action in preferred_keys() if new else ():
        ACTIONS.prefer(scene, key, action)
    return [known.get(mod.folder, mod) for mod in found]


def load_all(folders: Iterable[str | Path]) -> None:
    """Load the mods in these folders, every one of them. Raises ModError."""
    for folder in folders:
        found = load([folder])
        if not found:
            raise ModError(
                "There is no mod in {folder}; a mod is a folder with a file {manifest}.",
                folder=folder,
                manifest=MANIFEST,
            )
        for mod in found:
            if mod.off:
                raise ModError("The mod '{name}' cannot be used: {problem}", name=mod.name, problem=mod.problem)


def include(module: ModuleType, description: str) -> None:
    """Load a module of ours that is written as a mod is."""
    mod = Mod(module.__name__.rpartition(".")[2], module.__name__, __version__, description)
    app = App(mod)
    module.plugin(app)
    mod.withdraw = app.withdraw
    EXTENSIONS.mods.append(mod)


def unload(mods: Sequence[Mod]) -> None:
    """Forget mods as if they had never been loaded, the last first; for tests."""
    for mod in reversed(mods):
        if mod.withdraw is not None:
            mod.withdraw()
            _forget(mod)
        if mod in EXTENSIONS.mods:
            EXTENSIONS.mods.remove(mod)


def _load(mod: Mod) -> None:
    app = App(mod)
    surroundings = Surroundings()
    try:
        for name in required(mod):
            if any(other.name == name and other.off for other in EXTENSIONS.mods):
                raise ModError("It requires the mod '{name}', which cannot be used.", name=name)
        mod.within(PATIENCE, lambda: _plug_in(mod, app))
        surroundings.check()
    except ModError as error:
        mod.problem = str(error)
    except BaseException as error:  # of code that is not ours
        if is_persons(error):
            raise
        mod.problem = mod.describe(error)
        if isinstance(error, ModuleNotFoundError) and error.name == "numba":
            mod.problem = tr(
                "It imports numba, which is not installed ({place}); mark kernels with @compiled from pinjoint.api instead,"
                " which works without numba.",
                place=mod.place_of(error),
            )
    surroundings.put_back()
    if mod.off:
        app.withdraw()
        _forget(mod)
    else:
        mod.withdraw = app.withdraw


def _plug_in(mod: Mod, app: App) -> None:
    """Import a mod and let it register what it has. Raises ModError, or whatever its code raises."""
    app.catalogues()
    module = _import(mod)
    check_has_run(check_plugin(getattr(module, "plugin", None))(app), tr("what plugin(app) returned"))
    Schedule(all_systems())


def _import(mod: Mod) -> ModuleType:
    if not mod.source.startswith("package "):
        _find(mod)
    return importlib.import_module(mod.module)


def _find(mod: Mod) -> None:
    """Make the folder of a mod the package of its name. Raises ModError if another has that name."""
    assert mod.folder is not None
    file = mod.folder / "__init__.py"
    if not file.is_file():
        raise ModError("It has no __init__.py; write one with a function plugin(app).")
    origin = finding.origin_of_module(mod.name)
    if origin is not None and not _is_from(origin, file):
        raise ModError("There is a Python module '{name}' already; give the mod another name.", name=mod.name)
    if mod.name in sys.modules:
        return
    spec = importlib.util.spec_from_file_location(mod.name, file, submodule_search_locations=[str(mod.folder)])
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[mod.name] = module
    spec.loader.exec_module(module)


def _is_from(origin: str, file: Path) -> bool:
    return Path(origin).resolve() == file.resolve()


def _forget(mod: Mod) -> None:
    """Let the modules of a mod be imported anew; one of its name that is not its own stays."""
    root = sys.modules.get(mod.module)
    file = getattr(root, "__file__", None)
    if mod.folder is None or not isinstance(file, str) or not Path(file).resolve().is_relative_to(mod.folder):
        return
    for name in [name for name in sys.modules if name == mod.module or name.startswith(f"{mod.module}.")]:
        del sys.modules[name]
