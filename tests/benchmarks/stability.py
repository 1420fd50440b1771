"""Where each integrator is right, and where it stops and says why: a map of hard cases; and the drift of energy."""

from collections.abc import Callable
from typing import Any

from pinjoint import Session
from pinjoint.components.settings import AUTOMATIC, INTEGRATORS
from pinjoint.documents.document import document
from tests.benchmarks.models import lattice
from tests.reference.elements import Model
from tests.reference.models import oscillator
from tests.stability.cases import OMEGA, SHARES, Case, Outcome, cases, follow, stepping

Row = dict[str, Any]
RIGHT = 0.1  # relative error up to which a warning is not worth a word
FREE = ("velocity_verlet", "semi_implicit_euler", "rk4", "dop853")  # followed without dampers


def report(*, quick: bool) -> dict[str, list[Row]]:
    """The map, and what millions of steps without dampers do to the energy."""
    most = 20_000 if quick else 200_000
    return {"map": stability_map(most), "drift": drift(10**6 if quick else 10**7)}


def stability_map(most_steps: int) -> list[Row]:
    """A row for each case: the relative error of each integrator, or why there is no answer."""
    rows = [_row(case, lambda _, case=case: case, most_steps) for case in cases()]
    return rows + [_row(stepping(AUTOMATIC, share), _by_share(share), most_steps) for share in SHARES]


def _by_share(share: float) -> Callable[[str], Case]:
    return lambda integrator: stepping(integrator, share)


def _row(named: Case, case: Callable[[str], Case], most_steps: int) -> Row:
    cells = {name: _cell(follow(case(name), name, most_steps)) for name in INTEGRATORS}
    return {"varied": named.varied, "value": f"{named.value:g}", **cells}


def _cell(found: Outcome) -> str:
    """The error; or "stopped", or "warned" of an error that is large."""
    if found.status == "diverged":
        return "stopped"
    return "warned" if found.message and not found.error <= RIGHT else f"{found.error:.0e}"


def drift(steps: int) -> list[Row]:
    """The energy that appeared or was lost, relative to the initial one, after ever more steps."""
    swinging = oscillator(OMEGA, displacement=[0.1, 0])
    net = document(lattice(100, damping=0.0))
    for place, node in enumerate(net["particles"]):
        held = any(node.get("fixed", ()))
        node |= {"force": [0, 0], "velocity": [0.0, 0.0 if held else 0.1 * (place % 3)]}
    return [
        row
        for title, model, count in (("one mass", swinging, steps), ("lattice of 100 rods", net, steps // 10))
        for name in FREE
        for row in _drifting(title, model, name, count)
    ]


def _drifting(title: str, model: Model, integrator: str, steps: int) -> list[Row]:
    settings = {"integrator": integrator, "collisions": False}
    session = Session.open(model | {"settings": settings})
    session.simulation.advance(0)
    rows = []
    for power in range(3, len(str(steps))):
        session.simulation.advance(10**power - session.model.clock.steps)
        energy = session.energy
        rows.append(
            {
                "model": title,
                "integrator": integrator,
                "steps": session.model.clock.steps,
                "time_s": session.time,
                "imbalance": energy.imbalance / energy.initial,
            }
        )
    return rows
