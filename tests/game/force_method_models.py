"""Usual exercises of the force method, as textbooks have them."""

from pinjoint.components.model import Model
from pinjoint.documents import models
from tests.systems.render.frame_models import CLAMPED, PINNED, ROLLER, frame


def panels() -> Model:
    """Two crossed panels on two supports: a truss with two redundants."""
    particles = {
        name: (3.0 * at, 0.0, held) for at, (name, held) in enumerate((("A", PINNED), ("B", {}), ("C", ROLLER)))
    }
    particles |= {name: (3.0 * at, 3.0, {}) for at, name in enumerate("DEF")}
    rods = ("A B", "B C", "D E", "E F", "A D", "B E", "C F", "A E", "B D", "B F", "C E")
    loads = [
        {"name": "down", "on": "B", "force": [0.0, -60.0]},
        {"name": "wind", "on": "F", "force": [30.0, 0.0]},
    ]
    source = frame(
        particles, {ends: {"bending_stiffness": 0.0} for ends in rods}, loads=loads, title="Two crossed panels"
    )
    return models.load(source)


def propped() -> Model:
    """A propped cantilever under a uniform load."""
    particles = {"A": (0.0, 0.0, CLAMPED), "B": (6.0, 0.0, ROLLER)}
    return models.load(
        frame(particles, {"A B": {"distributed_force": [0.0, -10.0]}}, title="Propped cantilever")
    )


def two_span() -> Model:
    """A beam over two spans, of which one is loaded along its length and the other at its middle."""
    particles = {
        "A": (0.0, 0.0, PINNED),
        "B": (6.0, 0.0, ROLLER),
        "D": (9.0, 0.0, {}),
        "C": (12.0, 0.0, ROLLER),
    }
    rods = {"A B": {"distributed_force": [0.0, -8.0]}, "B D": {}, "D C": {}}
    loads = [{"name": "P", "on": "D", "force": [0.0, -20.0]}]
    return models.load(frame(particles, rods, loads=loads, title="Beam over two spans"))
