"""Loading mods: find them, put them in order, import them, register what they add; each mod wholly or not at all."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import math
import sys
import threading
from collections.abc import Iterable, Iterator, Sequence
from importlib.resources import files
from pathlib import Path
from types import ModuleType

import numpy as np

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import marked, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.wording import missing
from pinjoint.documents.library import data_folder
from pinjoint.documents.preferences import preferred_keys
from pinjoint.interrupts import is_persons, mark_interrupts
from pinjoint.mods.app import App
from pinjoint.mods.declared import check_has_run
from pinjoint.mods.mod import MANIFEST, Mod, ModError, read_manifest
from pinjoint.systems.catalogue import all_systems
from pinjoint.systems.input.actions import ACTIONS
from pinjoint.systems.schedule import Schedule
from pinjoint.version import __version__

PATIENCE = 30.0  # s that loading one mod may take


def load(folders: Iterable[str | Path] = (), *, installed: bool = False) -> list[Mod]:
    """Load the mods in these folders, or examples by name (and, if `installed`, the person's own and those of packages).

    Returns all mods that were found, each with its `problem` if it was left out. Mods that are loaded stay, but one that
    failed is loaded anew.
    """
    found = [mod for folder in folders for mod in _in_folder(folder_of(folder))]
    if installed:
        found += [*_in_folder(mods_folder()), *_in_packages()]
    unload([mod for mod in EXTENSIONS.mods if mod.off and mod.folder in {other.folder for other in found}])
    known: dict[Path | None, Mod] = {
        mod.folder: mod for mod in EXTENSIONS.mods if mod.loaded and mod.folder is not None
    }
    new = [mod for mod in found if mod.folder not in known]
    ordered = in_order(new, __version__, [mod for mod in EXTENSIONS.mods if mod.loaded])
    EXTENSIONS.mods.extend(new)
    if ordered:
        importlib.import_module("pinjoint.api")  # what they rely on; our keys come before theirs
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


def unload(mods: Iterable[Mod | str]) -> None:
    """Forget mods, or those of these names, with those that require them, as if they had never been loaded.

    Sessions that use them go on without them. Raises ModError if there is none of a name.
    """
    known = {mod.name: mod for mod in EXTENSIONS.mods if not mod.included}
    gone = list[Mod]()
    for one in mods:
        if isinstance(one, str) and one not in known:
            raise ModError(missing(marked("mods"), one, known))
        gone.append(known[one] if isinstance(one, str) else one)
    for mod in EXTENSIONS.mods:
        if mod.loaded and mod not in gone and not {other.name for other in gone}.isdisjoint(required(mod)):
            gone.append(mod)
    for mod in sorted(gone, key=lambda mod: EXTENSIONS.mods.index(mod) if mod in EXTENSIONS.mods else -1)[::-1]:
        if mod.withdraw is not None:
            mod.withdraw()
            mod.withdraw = None
            _forget(mod)
        mod.problem = mod.problem or tr("It was unloaded.")
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
    except (ModError, WrongValue) as error:  # what it registers cannot be used
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
    if not mod.source.startswith("package "):
        _find(mod)
    plugin = getattr(importlib.import_module(mod.module), "plugin", None)
    if not callable(plugin):
        raise ModError("It has no function plugin(app); write `def plugin(app): …` in its __init__.py.")
    if len(inspect.signature(plugin).parameters) != 1:
        raise ModError("Its function plugin must take one argument: def plugin(app).")
    check_has_run(plugin(app), tr("what plugin(app) returned"))
    Schedule(all_systems())


def _find(mod: Mod) -> None:
    """Make the folder of a mod the package of its name. Raises ModError if another has that name."""
    assert mod.folder is not None
    file = mod.folder / "__init__.py"
    if not file.is_file():
        raise ModError("It has no __init__.py; write one with a function plugin(app).")
    origin = origin_of_module(mod.name)
    if origin is not None and Path(origin).resolve() != file.resolve():
        raise ModError("There is a Python module '{name}' already; give the mod another name.", name=mod.name)
    if mod.name in sys.modules:
        return
    spec = importlib.util.spec_from_file_location(mod.name, file, submodule_search_locations=[str(mod.folder)])
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[mod.name] = module
    spec.loader.exec_module(module)


def _forget(mod: Mod) -> None:
    """Let the modules of a mod be imported anew; one of its name that is not its own stays."""
    root = sys.modules.get(mod.module)
    file = getattr(root, "__file__", None)
    if mod.folder is None or not isinstance(file, str) or not Path(file).resolve().is_relative_to(mod.folder):
        return
    for name in [name for name in sys.modules if name == mod.module or name.startswith(f"{mod.module}.")]:
        del sys.modules[name]


# --- what a mod shares with the program ---------------------------------------------------------------------


_LIBRARIES = (math, np)  # by which everything computes


class Surroundings:
    """Modules, streams, threads and functions of libraries as they are before code of a mod runs."""

    def __init__(self) -> None:
        self._modules, self._threads = dict(sys.modules), set(threading.enumerate())
        self._streams = {name: getattr(sys, name) for name in ("stdin", "stdout", "stderr")}
        self._functions = [(library, dict(vars(library))) for library in _LIBRARIES]

    def check(self) -> None:
        """Raise ModError if the mod changed anything of it, or left a thread running."""
        for name, stream in self._streams.items():
            if getattr(sys, name, None) is not stream:
                raise ModError(
                    "It replaced or removed sys.{name}, which the program needs; leave it as it is.", name=name
                )
            if getattr(stream, "closed", False):
                raise ModError("It closed sys.{name}, which the program needs; leave it open.", name=name)
        for name, module in self._modules.items():
            if sys.modules.get(name) is not module:
                raise ModError(
                    "It replaced or removed the module '{name}' in sys.modules, which others use; leave it there.",
                    name=name,
                )
        for library, functions in self._functions:
            for name, function in functions.items():
                if vars(library).get(name) is not function:
                    raise ModError(
                        "It replaced or removed {name}, by which others compute; leave it as it is.",
                        name=f"{library.__name__}.{name}",
                    )
        for thread in set(threading.enumerate()) - self._threads:
            if thread.is_alive() and not thread.daemon:
                raise ModError(
                    "Its plugin(app) left the thread '{name}' running, which would keep the program from ending; start"
                    " the thread with daemon=True.",
                    name=thread.name,
                )

    def put_back(self) -> None:
        """Undo what can be undone; Python leaves the files of standard streams open that are closed."""
        sys.modules.update(self._modules)
        for library, functions in self._functions:
            vars(library).update(functions)
        for number, (name, stream) in enumerate(self._streams.items()):
            if getattr(stream, "closed", False):
                mode = "r" if name == "stdin" else "w"
                stream = open(number, mode, encoding=stream.encoding, errors="replace", closefd=False)  # noqa: SIM115
            setattr(sys, name, stream)


# --- finding them ------------------------------------------------------------------------------------------


_GROUP = "pinjoint.mods"  # entry points of installed packages
PROGRAM = "pinjoint"  # what a mod calls the program that it requires


def mods_folder() -> Path:
    """The folder with a person's mods, a folder each; it need not exist yet."""
    return data_folder() / "mods"


def folder_of(name: str | Path) -> Path:
    """A folder with mods, or that of a bundled example by its name, such as "wind"."""
    example = Path(str(files("pinjoint.assets") / "mods")) / name
    return example if not Path(name).is_dir() and (example / MANIFEST).is_file() else Path(name)


def _in_folder(folder: Path) -> list[Mod]:
    """The mod that a folder is, or the mods in it, by name of their folders."""
    if (folder / MANIFEST).is_file():
        return [read_manifest(folder, str(folder))]
    try:
        inside = sorted(entry for entry in folder.iterdir() if entry.is_dir() and entry.name[0] not in "._")
    except OSError:
        return []
    parts = (MANIFEST, "__init__.py")
    return [read_manifest(made, str(made)) for made in inside if any((made / part).is_file() for part in parts)]


def _in_packages() -> list[Mod]:
    """The mods of installed packages, by name."""
    lists = (file for path in sys.path for file in Path(path).glob("*-info/entry_points.txt"))
    if not any(_GROUP.encode() in file.read_bytes() for file in lists):
        return []  # in 1 ms: importlib.metadata takes 50 ms to import
    from importlib.metadata import entry_points

    return [_of_package(point.name, point.value) for point in sorted(entry_points(group=_GROUP))]


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
