"""`pinjoint plan`: which systems run in a scene with a model, in order, and why the others do not."""

from __future__ import annotations

import csv
import io
import json
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from game.commands.arguments import Parser, UsageError, write
from game.commands.options import ANSWERED, add_model, add_output, session_of
from game.documents.autosave import Autosave
from game.preparation import Preparation
from game.session import Session
from systems.base import Phase, System
from systems.edit.hover import Hover


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        prog="pinjoint plan",
        description="The systems that run in the window in a scene with a model, by phase of the frame and in order.",
    )
    add_model(parser)
    parser.add_argument("--scene", default="simulation", metavar="NAME", help="default: simulation")
    parser.add_argument("--format", choices=("table", "json", "csv"), default="table")
    add_output(parser)
    options = parser.parse_args(words)
    with tempfile.TemporaryDirectory() as folder:
        found = plan(session_of(options, _of_window(Path(folder))), options.scene)
    texts = {"json": lambda: f"{json.dumps(found, indent=2)}\n", "csv": lambda: _as_csv(found)}
    write(texts.get(options.format, lambda: _as_table(found, options.model))(), options.output)
    return ANSWERED


def plan(session: Session, scene: str) -> dict[str, Any]:
    """The plan of a session, as names: {"scene", "phases": {phase: […]}, "left_out": {name: why}}."""
    if scene not in session.scenes.names:
        raise UsageError(f"There is no scene '{scene}'; there are {', '.join(session.scenes.names)}.")
    found = session.plan(scene)
    return {
        "scene": found.scene,
        "phases": {phase.value: [system.name for system in found.phases[phase]] for phase in Phase},
        "left_out": dict(found.left_out),
    }


def _of_window(folder: Path) -> list[System]:
    """The systems that a window adds to those of every session."""
    import pygame

    from systems.input.pygame_input import PygameInput
    from systems.render.pygame_render import PygameRender

    return [PygameInput(), Hover(), Autosave(folder), Preparation(), PygameRender(pygame.Surface((1, 1)))]


def _as_table(found: dict[str, Any], name: str) -> str:
    width = max(map(len, (*found["left_out"], *map(str, found["phases"]))), default=0)
    lines = [f"Scene {found['scene']}, model {name}", ""]
    for phase, names in found["phases"].items():
        lines += [f"{phase if index == 0 else '':{width}}  {each}" for index, each in enumerate(names or ["–"])]
    lines += ["", "Left out"]
    lines += [f"{system:{width}}  {why}" for system, why in found["left_out"].items()]
    return "\n".join(lines) + "\n"


def _as_csv(found: dict[str, Any]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("system", "phase", "order", "left_out"))
    writer.writerows(_rows(found))
    return text.getvalue()


def _rows(found: dict[str, Any]) -> Iterator[tuple[str, str, int | str, str]]:
    for phase, names in found["phases"].items():
        yield from ((name, phase, order, "") for order, name in enumerate(names, start=1))
    yield from ((name, "", "", why) for name, why in found["left_out"].items())
