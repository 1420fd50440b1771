"""How long a picture takes on one core: composing it, drawing it, and its share of a running window's frame."""

import os
import time
from typing import Any

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")

import numpy as np
import pygame

from pinjoint.app import App
from pinjoint.components.camera import Viewport
from pinjoint.components.model import Model
from pinjoint.components.view import View
from pinjoint.systems.render.backends.pygame_canvas import Canvas
from pinjoint.systems.render.backends.raster import load_raster
from pinjoint.systems.render.labels.placing import Placed
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.benchmarks.models import mesh

SIZE = 1280, 800  # px
ROUNDS = 7
SIZES = (100, 1_000, 10_000, 100_000, 1_000_000)
QUICK = SIZES[:4]

Row = dict[str, Any]


def pictures(*, quick: bool) -> list[Row]:
    """Least milliseconds of this thread per picture of a mesh that moves, and per element, by size and contents."""
    sizes = QUICK if quick else SIZES
    return [_picture(mesh(size, damping=1.0), diagrams) for size in sizes for diagrams in (False, True)]


def _picture(model: Model, diagrams: bool) -> Row:
    view = View(all_diagrams=diagrams)
    view.camera.viewport = Viewport(0, 0, *SIZE)
    view.fit(model)
    surface, canvas, theme = pygame.Surface(SIZE, depth=32), Canvas(load_raster), load_theme()
    composing = drawing = np.inf
    placed: Placed = {}
    # every picture another one, with other values to write; the first is left out
    for seed in range(ROUNDS + 1):
        _deform(model, seed)
        started = time.thread_time()
        picture = compose(model, view, theme, placed)
        composed = time.thread_time()
        canvas.draw(surface, picture)
        drawn = time.thread_time()
        if seed:
            composing, drawing = min(composing, composed - started), min(drawing, drawn - composed)
    elements = model.rods.count + model.particles.count
    return {
        "rods": model.rods.count,
        "particles": model.particles.count,
        "diagrams": diagrams,
        "compose_ms": 1e3 * composing,
        "draw_ms": 1e3 * drawing,
        "picture_ms": 1e3 * (composing + drawing),
        "ns_per_element": 1e9 * (composing + drawing) / elements,
    }


def _deform(model: Model, seed: int) -> None:
    """Displacements of a tenth of a rod and forces of either sign, so that no line is level and no diagram alike."""
    rng = np.random.default_rng(seed)
    model.writable("particles.displacement")[...] = rng.normal(0.0, 0.08, (model.particles.count, 2))
    model.writable("rods.axial_force")[...] = rng.normal(0.0, 5.0, model.rods.count)


def frames(*, quick: bool) -> list[Row]:
    """What a frame of a running window consists of: milliseconds of each system, and of the steps."""
    return [row for size in (QUICK[2:3] if quick else SIZES[1:4]) for row in _frame(size)]


def _frame(rods: int, count: int = 10) -> list[Row]:
    app = App(mesh(rods, damping=1.0))
    app.window.size = SIZE
    app.session.view.all_diagrams = True
    app.session.press("space")
    for _ in range(3):
        app.frame(1 / 60)
    before = dict(app.session.schedule.seconds)
    started = time.perf_counter()
    for _ in range(count):
        app.frame(1 / 60)
    spent = {name: seconds - before.get(name, 0.0) for name, seconds in app.session.schedule.seconds.items()}
    spent["whole frame"] = time.perf_counter() - started
    return [{"rods": app.session.rods.count, "part": name, "ms": 1e3 * s / count} for name, s in spent.items()]


def report(*, quick: bool) -> dict[str, list[Row]]:
    """Everything this benchmark measures, by table."""
    return {"pictures": pictures(quick=quick), "frames": frames(quick=quick)}
