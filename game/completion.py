"""What is written as mods are is registered before the first model is made, whatever part a script begins with."""

from importlib import import_module

from pinjoint.interrupts import quietly_interrupted


def complete() -> None:
    """Register walls, plots, histories and counts of impacts, once, so that models can hold them.

    They need what calls this, so that importing them must wait for the call.
    """
    with quietly_interrupted():
        import_module("pinjoint.included")
