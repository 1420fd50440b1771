"""What is saved by leaving out what a model does not need: the same work with each part, and without."""

import os
from collections.abc import Callable
from typing import Any

from pinjoint import Session
from pinjoint.components.load import Load
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from tests.benchmarks.models import islands, lattice, mesh
from tests.benchmarks.timing import best_of_each, program_runner

RODS, STEPS = 10_000, 100
DISCS, FRAMES = 500, 10
STRENGTHS = {"tensile_strength": 1e6, "compressive_strength": 1e6}

Row = dict[str, Any]


def report() -> list[Row]:
    """What is left out, with what the work costs on one core with it and without."""
    return [*_parts_of_steps(), _contacts(), _islands(), _small_steps(), _pictures()]


def _parts_of_steps() -> list[Row]:
    """Parts of a step of 10 000 rods."""
    models = {
        "dampers": lattice(RODS, damping=1.0),
        "strengths": lattice(RODS, damping=0.0, **STRENGTHS),
        "cables": lattice(RODS, damping=0.0, tension_only=True),
        "changes of temperature": lattice(RODS, damping=0.0, temperature_change=1.0),
        "drag": _dragged(lattice(RODS, damping=0.0)),
        "a varying load on each particle": _loaded(lattice(RODS, damping=0.0)),
        "dampers, strengths and drag": _dragged(lattice(RODS, damping=1.0, **STRENGTHS)),
    }
    bare = lattice(RODS, damping=0.0)
    without, *costs = best_of_each(*(program_runner(model, STEPS) for model in (bare, *models.values())))
    return [
        _row(part, "a step", cost / STEPS, without / STEPS) for part, cost in zip(models, costs, strict=True)
    ]


def _dragged(model: Model) -> Model:
    model.environment.drag = 1.0
    return model


def _loaded(model: Model) -> Model:
    count = model.particles.count
    history = {"kind": "sine", "frequency": 10.0}
    model.create(Load, count, on=list(range(count)), force=[(1.0, 0.0)] * count, history=[history] * count)
    return model


def _contacts() -> Row:
    """A structure with a disc that flies by, among its particles or far from them."""
    near, far = (_flown_by(at) for at in ((5.5, 5.5), (-50.0, 5.5)))
    return _row("search for contacts", "a step", *(t / STEPS for t in best_of_each(near, far)))


def _islands() -> Row:
    """Ten lattices of which nine are at rest, kept awake or asleep."""
    awake, asleep = (_one_of_ten_moves(sleeping) for sleeping in (False, True))
    return _row("nine of ten islands, at rest", "a step", *(t / STEPS for t in best_of_each(awake, asleep)))


def _one_of_ten_moves(sleeping: bool) -> Callable[[], None]:
    model = islands(10, RODS // 10, damping=1.0, **STRENGTHS)
    model.settings.collisions, model.settings.sleeping = False, sleeping
    return _taking_steps(model)


def _flown_by(position: tuple[float, float]) -> Callable[[], None]:
    model = lattice(RODS, damping=0.0)
    model.create(Particle, position=[position], mass=[1.0], velocity=[(100.0, 0.0)])
    return _taking_steps(model)


def _taking_steps(model: Model) -> Callable[[], None]:
    model.settings.integrator, model.settings.time_step = "velocity_verlet", 1e-6
    session = Session(model)
    return lambda: session.simulation.advance(STEPS)


def _small_steps() -> Row:
    """Discs on their way past one another, in steps for the sake of a little drag, or in free flight."""
    return _row("small steps", "a flight", *best_of_each(_gas(drag=1e-9), _gas(drag=0.0)))


def _gas(drag: float) -> Callable[[], None]:
    model = Model()
    rows = range(DISCS)
    position = [(row % 25, row // 25) for row in rows]
    velocity = [(1.0 - row % 3, row % 5 - 2.0) for row in rows]
    model.create(Particle, DISCS, position=position, velocity=velocity, mass=1.0)
    model.environment.drag = drag
    session = Session(model)
    return lambda: session.simulation.run_to(session.model.clock.time + 0.02)


def _pictures() -> Row:
    """Frames of a paused window, in which the camera moves or nothing does."""
    return _row("pictures", "a frame", *(t / FRAMES for t in best_of_each(_window(pan=1.0), _window(pan=0.0))))


def _window(pan: float) -> Callable[[], None]:
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    from pinjoint.app import App

    app = App(mesh(RODS, damping=1.0))

    def run() -> None:
        for _ in range(FRAMES):
            if pan:
                app.session.view.camera.pan((pan, 0.0))
            app.frame(1 / 60)

    return run


def _row(part: str, work: str, present: float, absent: float) -> Row:
    return {
        "left_out": part,
        "of": work,
        "us_with": 1e6 * present,
        "us_without": 1e6 * absent,
        "saved": 1.0 - absent / present,
    }
