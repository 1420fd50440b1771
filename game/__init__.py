"""COMPOSITION: the program. `Session` drives it from scripts, without a window.

Where to find what:

    session.py, desk.py         a model that is open, with all that belongs to it; what scripts and tests drive
    simulation.py, live.py      its run, by fixed steps, and frame by frame at a pace that suits a person
    program/  collisions/       the compiled steps of a run, and the impacts in it
    history/                    undo, redo, stepping back
    scenes/ actions/ gestures/  the modes, what keys and buttons do in them, what is drawn and dragged
    force_method/               the guide through the force method
    schedule.py, catalogue.py   which systems there are, which of them run, in which order
    document.py, models.py      models as plain data, and in files
    saved/                      what a person keeps: models, unsaved work, preferences
    cli/ reports/ sweeps/       the command line, and what it computes
    scripts/                    scripted sessions
    mods/ included/ checks.py   extensions by others, ours that are written like theirs, and how to test them
    app.py, showing.py          the window, and what it says
    preparation.py, prepare.py  compiling ahead of need, in another process
"""

from game.interrupts import unheard

with unheard():
    from game import included as _included  # noqa: F401 (registers what is written as mods are)
    from game.checks import SystemCheckError, check_system
    from game.session import Session
    from game.version import __version__

__all__ = ["Session", "SystemCheckError", "__version__", "check_system"]
