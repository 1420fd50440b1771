"""Models of members that bend, for pictures of them."""

import itertools
from typing import Any

from pinjoint import Session
from tests.reference.models import model

EA, EI = 1.2e6, 8000.0
Source = dict[str, Any]


def frame(particles: dict[str, tuple[float, float, Source]], rods: dict[str, Source], **others: Any) -> Source:
    """A model: particles by name with place and facts; rods by the names of their ends ("A B") with facts."""
    return model(
        [{"name": name, "position": [x, y], **facts} for name, (x, y, facts) in particles.items()],
        [
            {"name": ends.replace(" ", ""), "between": ends.split(), "stiffness": EA, "bending_stiffness": EI}
            | facts
            for ends, facts in rods.items()
        ],
        **others,
    )


CLAMPED: Source = {"fixed": [True, True], "fixed_rotation": True}
PINNED: Source = {"fixed": [True, True]}
ROLLER: Source = {"fixed": [False, True]}


def portal() -> Source:
    """A clamped and a pinned foot, a distributed force on the beam, wind on a column."""
    return frame(
        {"A": (0.0, 0.0, CLAMPED), "B": (0.0, 4.0, {}), "C": (6.0, 4.0, {}), "D": (6.0, 0.0, PINNED)},
        {
            "A B": {"distributed_force": [3.0, 0.0]},
            "B C": {"distributed_force": [0.0, -12.0], "bending_stiffness": 2.0 * EI},
            "C D": {},
        },
        loads=[{"name": "wind", "on": "B", "force": [10.0, 0.0]}],
    )


def portal_at_rest() -> Source:
    """It, where a run leads to."""
    return at_rest(
        portal(),
        {
            "A": (0.0, 0.0, 0.0),
            "B": (0.0143417796, -0.000129422427, -0.00471245204),
            "C": (0.0142846859, -0.000180144345, 0.00238775396),
            "D": (0.0, 0.0, -0.00656343805),
        },
    )


def gerber_at_rest() -> Source:
    """It, where a run leads to."""
    return at_rest(
        gerber_beam(),
        {
            "A": (0.0, 0.0, -0.00843727505),
            "B": (-5.06426433e-05, -0.0154682242, 0.000703111446),
            "C": (-9.44651757e-05, 0.0, 0.00562479615),
            "D": (-0.000108715718, 0.0064596491, -0.00380852385),
            "E": (-0.00011757557, 0.0, 0.000937565011),
        },
    )


def at_rest(source: Source, state: dict[str, tuple[float, float, float]]) -> Source:
    """A model with displacements and rotations by particle."""
    for particle in source["particles"]:
        x, y, turn = state[particle["name"]]
        particle |= {"displacement": [x, y], "rotation": turn}
    return source


def gerber_beam() -> Source:
    """Hinged at D, with a force on the first span."""
    pressed = {"distributed_force": [0.0, -5.0]}
    return frame(
        {
            "A": (0.0, 0.0, PINNED),
            "B": (3.0, 0.0, {"force": [0.0, -20.0]}),
            "C": (6.0, 0.0, ROLLER),
            "D": (7.5, 0.0, {}),
            "E": (12.0, 0.0, ROLLER),
        },
        {"A B": pressed, "B C": pressed, "C D": {**pressed, "hinged": [False, True]}, "D E": pressed},
    )


def cantilever(count: int = 1, moment: float = 40.0) -> Source:
    """Bent strongly by a moment at its tip."""
    names = [f"P{number}" for number in range(count + 1)]
    particles = {name: (4.0 * number / count, 0.0, {}) for number, name in enumerate(names)}
    particles["P0"] = (0.0, 0.0, CLAMPED)
    particles[names[-1]] = (4.0, 0.0, {"moment": moment})
    soft = {"stiffness": 2e4, "bending_stiffness": 50.0}
    return frame(particles, {f"{a} {b}": soft for a, b in itertools.pairwise(names)})


def vierendeel() -> Source:
    """Four panels without diagonals."""
    particles: dict[str, tuple[float, float, Source]] = {}
    for number in range(5):
        particles[f"L{number}"] = (2.0 * number, 0.0, {0: PINNED, 4: ROLLER}.get(number, {}))
        particles[f"U{number}"] = (2.0 * number, 1.6, {"force": [0.0, -10.0]})
    chords = {f"{chord}{number} {chord}{number + 1}": {} for chord in "LU" for number in range(4)}
    posts = {f"L{number} U{number}": {} for number in range(5)}
    return frame(particles, {**chords, **posts})


def all_supports() -> Source:
    """Every kind of support and hinge, with moments, and a force along and across a rod."""
    held: Source = {"fixed_rotation": True}
    return frame(
        {
            "A": (0.0, 0.0, CLAMPED),
            "B": (2.0, 0.0, {**ROLLER, **held}),
            "C": (4.0, 0.0, {**held, "moment": 5.0}),
            "D": (6.0, 0.0, {"fixed": [True, False], **held}),
            "E": (2.0, 2.0, {"force": [10.0, -10.0]}),
            "F": (4.0, 2.0, {"moment": -5.0}),
            "G": (6.0, 2.0, PINNED),
        },
        {
            "A B": {},
            "B C": {},
            "C D": {"distributed_force": [4.0, -4.0]},
            "B E": {"hinged": [False, True]},
            "E F": {"hinged": [True, False]},
            "C F": {"hinged": [True, False], "distributed_force": [0.0, -3.0]},
            "F G": {"hinged": [False, True]},
        },
    )


FRAMES = {
    "portal": portal,
    "gerber beam": gerber_beam,
    "cantilever": cantilever,
    "cantilever in pieces": lambda: cantilever(8),
    "vierendeel": vierendeel,
    "all supports": all_supports,
}


def simple_beam(q: float = -8.0, length: float = 4.0) -> Session:
    """A beam on two supports under a distributed force (kN/m), in statics by first-order theory."""
    source = frame(
        {"A": (0.0, 0.0, PINNED), "B": (length, 0.0, ROLLER)}, {"A B": {"distributed_force": [0, q]}}
    )
    session = Session.open(source)
    session.resize(1000, 720)
    session.press("q")
    session.frame(0.0)
    session.view.fit(session.model)
    return session
