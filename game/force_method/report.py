"""`pinjoint force-method`: the force method without a window."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from components.model import Model
from game.commands.output import Row
from game.force_method.guide import exact_forces
from systems.statics.force_method import find_unknown, redundants, solve


def force_method(model: Model, release: str | None) -> dict[str, Any]:
    """Displacements (m, m/kN) and hyperstatic forces (kN), with the exact forces beside them.

    release: "AC" or "A.y"; None: as many unknowns as make the structure isostatic, in lists and a matrix.
    Raises ForceMethodError.
    """
    unknowns = redundants(model) if release is None else [find_unknown(model, release)]
    solution = solve(model, unknowns)
    exact = exact_forces(model, unknowns)
    if release is not None:
        return {
            "released": release,
            "delta_real": float(solution.delta_real[0]),
            "delta_base": float(solution.delta_base[0]),
            "delta_unit": float(solution.delta_unit[0, 0]),
            "force": float(solution.force[0]),
            "exact_force": exact[0] if exact is not None else None,
        }
    return {
        "released": [unknown.name for unknown in unknowns],
        "delta_real": solution.delta_real.tolist(),
        "delta_base": solution.delta_base.tolist(),
        "delta_unit": solution.delta_unit.tolist(),
        "force": solution.force.tolist(),
        "exact_force": exact,
    }


def force_method_rows(found: Mapping[str, Any]) -> Iterator[Row]:
    """What `force_method` found as rows, one for every unknown, headings first."""
    if not isinstance(found["released"], list):
        found = {key: [value] for key, value in found.items()} | {"delta_unit": [[found["delta_unit"]]]}
    names = found["released"]
    exact = found["exact_force"] or [None] * len(names)
    unit = [f"delta_unit {name} (m/kN)" for name in names]
    yield "released", "delta_real (m)", "delta_base (m)", *unit, "force (kN)", "exact_force (kN)"
    parts = (names, found["delta_real"], found["delta_base"], found["delta_unit"], found["force"], exact)
    for name, real, base, row, force, exactly in zip(*parts, strict=True):
        yield name, real, base, *row, force, exactly
