"""Dropping: opening the files that a person drops on the window."""

from __future__ import annotations

from pathlib import Path

from pinjoint.documents import models
from pinjoint.documents.format import ModelError
from pinjoint.documents.open_documents import file_of
from pinjoint.editor.context import Context
from pinjoint.scripts.script import Script

MODEL, SCRIPT = ".json", ".jsonl"


def open_dropped(context: Context, path: Path) -> None:
    """Open a model file, or play a recorded session. Raises ModelError or ScriptError; then nothing has changed.

    The document in use stays open unless it is empty.
    """
    if path.is_dir():
        raise ModelError("'{name}' is a folder; drop the model files that are in it.", name=path.name)
    if path.suffix.lower() not in (MODEL, SCRIPT):
        raise ModelError(
            "'{name}' is not a model: Pinjoint opens model files ({model}) and recorded sessions ({script}).",
            name=path.name,
            model=MODEL,
            script=SCRIPT,
        )
    script = Script(path) if path.suffix.lower() == SCRIPT else None
    if script is not None and script.has_tasks:
        context.lesson = script
        return
    model = models.load(path if script is None else script.source)
    keep = context.model.particles.count > 0
    context.adopt(model, file_of(path if script is None else script.source), keep=keep)
    context.lesson = script or context.lesson
