"""What the pictures of the examples on the start page show: each at a moment when something is to be seen.

`python -m tests.golden.previews` computes them anew.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

from pinjoint import Session
from pinjoint.components.rod import bends
from pinjoint.documents import models

FILE = Path(__file__).parents[2] / "assets" / "previews.json"
DIGITS = 5  # significant; pictures are small
STILL = 1e-6  # of the fastest: no motion that is to be seen
# Simulated time (s); the others are settled.
MOMENTS = {
    "ball_on_frame": 1.13,
    "ball_on_truss": 0.3,
    "billiards_break": 0.9,
    "catapult": 0.0,
    "collision_i": 0.0,
    "collision_ii": 0.0,
    "collision_iii": 0.0,
    "collision_iv": 0.0,
    "collision_v": 0.0,
    "collision_vi": 0.0,
    "demolition": 0.0,
    "falling_columns": 0.0,
    "flexible_pendulum": 0.6,
    "galperin_pi": 0.0,
    "hanging_net": 1.0,
    "hard_disc_gas": 1.0,
    "isostatic_collapse": 0.05,
    "newtons_cradle": 0.0,
    "pendulum": 0.25,
    "pile": 1.5,
    "rope_bridge": 0.0,
    "staircase": 0.6,
    "sway_resonance": 4.3,
    "swing": 0.3,
}


def preview_of(name: str) -> dict[str, Any]:
    """Displacements, velocities and forces in the rods of an example at its moment."""
    session = Session.open(name)
    if name not in MOMENTS:
        assert session.settle(session.settings.load_steps) in ("equilibrium", "neutral equilibrium"), name
    elif MOMENTS[name]:
        session.run(time=MOMENTS[name])
    velocity = session.model.writable("particles.velocity")
    velocity[np.abs(velocity) < STILL * np.abs(velocity).max(initial=0.0)] = 0.0
    columns: tuple[str, ...] = ("particles.displacement", "particles.velocity", "rods.axial_force")
    if bends(session.model):
        columns = *columns, "particles.rotation", "rods.end_moment", "rods.plastic_rotation"
    session.document.get_ready()
    state = {column: _rounded(session.model.column(column)) for column in columns}
    return {column: values for column, values in state.items() if np.any(values)}


def _rounded(column: Any) -> Any:
    return [_rounded(value) for value in column] if np.ndim(column) else float(f"{column:.{DIGITS}g}")


if __name__ == "__main__":
    made = {name: preview_of(name) for name in sorted(models.bundled())}
    lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(state)}" for name, state in made.items() if state)
    FILE.write_text("{\n" + lines + "\n}\n", encoding="utf-8")
