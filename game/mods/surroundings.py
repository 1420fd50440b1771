"""Surroundings: what a mod shares with the program, and must leave as it was."""

from __future__ import annotations

import math
import sys
import threading

import numpy as np

from pinjoint.mods.mod import ModError

_STREAMS = ("stdin", "stdout", "stderr")
_LIBRARIES = (math, np)  # by which everything computes


class Surroundings:
    """Modules, streams, threads and functions of libraries as they are before code of a mod runs."""

    def __init__(self) -> None:
        self._modules, self._threads = dict(sys.modules), set(threading.enumerate())
        self._streams = {name: getattr(sys, name) for name in _STREAMS}
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
