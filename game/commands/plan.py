"""`pinjoint plan`: which systems run in a scene with a model, in order, and why the others do not."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pinjoint.commands.arguments import Parser, UsageError, option
from pinjoint.commands.options import ANSWERED, add_model, add_steps, session_of
from pinjoint.commands.output import Row, add_output, write_result
from pinjoint.components.language import tr
from pinjoint.session import Session
from pinjoint.systems.base import Phase


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        "plan",
        "List the systems (parts of the program) that run in a scene of the window, in their order in a frame.",
    )
    add_model(parser)
    add_steps(parser)
    option(parser, "--scene NAME", "the scene; default simulation", default="simulation")
    add_output(parser)
    options = parser.parse_args(words)
    from pinjoint.app import window_systems  # pygame takes a while to import

    with tempfile.TemporaryDirectory() as folder:
        found = plan(session_of(options, window_systems(Path(folder))), options.scene)
    write_result(options, found, _rows, lambda found: _lines(found, options.model))
    return ANSWERED


def plan(session: Session, scene: str) -> dict[str, Any]:
    """The plan of a session, as names: {"scene", "phases": {phase: […]}, "left_out": {name: why}}."""
    if scene not in session.scenes.names:
        raise UsageError(
            "There is no scene '{scene}'; choose from {names}.",
            scene=scene,
            names=", ".join(session.scenes.names),
        )
    found = session.plan(scene)
    return {
        "scene": found.scene,
        "phases": {phase.value: [system.name for system in found.phases[phase]] for phase in Phase},
        "left_out": dict(found.left_out),
    }


def _lines(found: dict[str, Any], model: str) -> Iterator[str]:
    width = max(map(len, (*found["left_out"], *found["phases"])))
    yield tr("Scene '{scene}', model '{model}'", scene=found["scene"], model=model)
    yield ""
    for phase, names in found["phases"].items():
        for index, name in enumerate(names or ["–"]):
            yield f"{phase if index == 0 else '':{width}}  {name}"
    yield ""
    yield tr("Left out")
    yield from (f"{system:{width}}  {why}" for system, why in found["left_out"].items())


def _rows(found: dict[str, Any]) -> Iterator[Row]:
    yield "system", "phase", "order", "left_out"
    for phase, names in found["phases"].items():
        yield from ((name, phase, order, "") for order, name in enumerate(names, start=1))
    yield from ((name, "", "", why) for name, why in found["left_out"].items())
