"""Models to draw, and what their pictures consist of."""

import numpy as np

from pinjoint.components.camera import Camera, Viewport
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.view import View
from pinjoint.components.world import Derivation
from pinjoint.systems.render.marks import Panel, Picture
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme

LIGHT = load_theme("light")


def triangle() -> Model:
    """The thesis' isostatic triangle with its exact forces."""
    model = Model()
    fixed = [(False, True), (False, False), (True, True)]
    model.create(Particle, 3, name=["A", "B", "C"], position=[(0, 0), (1, 1), (2, 0)], fixed=fixed)
    model.create(Rod, 3, between=[(0, 1), (1, 2), (2, 0)], name=["AB", "BC", "CA"])
    fill(model, "rods.axial_force", [-28.34277, -198.02746, 20.0679])
    fill(model, "particles.applied_force", [(0, 0), (120, -160), (0, 0)])
    fill(model, "particles.reaction", [(0, 20.01479), (0, 0), (-120, 139.98521)])
    return model


def fill(model: Model, column: str, values: object) -> None:
    """Give a derived column values, whatever would otherwise compute it."""
    rows = np.asarray(values)

    def write(world: object) -> None:
        model.writable(column)[...] = rows

    model.derive(Derivation((column,), ("particles.position",), write))


def view_of(model: Model, width: int = 600, height: int = 600, **options: object) -> View:
    """A view that shows all of a model."""
    view = View(camera=Camera(viewport=Viewport(0, 0, width, height)), **options)
    view.camera.fit(np.asarray(model.particles.position), 90.0 * view.pixel_ratio)
    return view


def picture_of(model: Model, **options: object) -> Picture:
    return compose(model, view_of(model, **options), LIGHT)


def marks_of(picture: Picture, kind: type, colour: tuple[int, ...] | None = None) -> list:
    marks = [mark for mark in picture.marks if isinstance(mark, kind)]
    colours = [mark.fill if isinstance(mark, Panel) else mark.colour for mark in marks] if colour else []
    return [m for m, own in zip(marks, colours, strict=True) if own[:3] == colour[:3]] if colour else marks
