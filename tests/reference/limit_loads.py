"""Collapse loads of plane frames by the textbook's linear program, with moments limited at very many sections."""

from typing import Any

import numpy as np
from scipy.optimize import linprog

from tests.reference.elements import Model


def collapse_factor(model: Model, sections: int = 401) -> float:
    """Largest λ for equilibrium of joints under λ × loads, |N| ≤ strength and |M| ≤ M_p at sections of every member.

    Unknowns: N and the moments on the ends of every member; rigid supports, uniform loads alone between ends.
    """
    names = [p["name"] for p in model["particles"]]
    places = np.array([p["position"] for p in model["particles"]], dtype=float)
    count, members = len(names), len(model["rods"])
    balance, right = np.zeros((3 * count, 3 * members + 1)), np.zeros(3 * count)
    rows: list[Any] = []
    bounds: list[Any] = []
    for number, p in enumerate(model["particles"]):
        balance[3 * number : 3 * number + 2, -1] = p.get("force", [0.0, 0.0])
    for number, each in enumerate(model["rods"]):
        a, b = (names.index(name) for name in each["between"])
        axis = places[b] - places[a]
        length = float(np.hypot(*axis))
        axis /= length
        left = np.array([-axis[1], axis[0]])
        n, ma, mb = 3 * number, 3 * number + 1, 3 * number + 2
        for joint, sign in ((a, -1.0), (b, 1.0)):  # what the member pulls the joint with is −sign N n
            balance[3 * joint : 3 * joint + 2, n] -= sign * axis
            for moment in (ma, mb):
                balance[3 * joint : 3 * joint + 2, moment] += sign * left / length
        balance[3 * a + 2, ma] -= 1.0
        balance[3 * b + 2, mb] -= 1.0
        q = np.array(each.get("distributed_force", [0.0, 0.0]), dtype=float)
        for joint in (a, b):
            balance[3 * joint : 3 * joint + 2, -1] += 0.5 * length * q
        strength = each.get("plastic_moment")
        hinged = each.get("hinged", [False, False])
        if each.get("tension_only"):
            bounds.append((0.0, each.get("tensile_strength")))
        else:
            crushed = each.get("compressive_strength")
            bounds.append((None if crushed is None else -crushed, each.get("tensile_strength")))
        stiff = each.get("bending_stiffness", 0.0) > 0.0
        for free in hinged:
            bounds.append((0.0, 0.0) if free or not stiff else (None, None))
        if strength is not None and stiff:
            across = float(q @ left)
            for share in np.linspace(0.0, 1.0, sections if across else 2):
                row = np.zeros(3 * members + 1)
                row[ma], row[mb] = share - 1.0, share
                row[-1] = -0.5 * across * length**2 * share * (1.0 - share)
                rows += [(row, strength), (-row, strength)]
    held = np.array(
        [[*p.get("fixed", [False, False]), p.get("fixed_rotation", False)] for p in model["particles"]]
    )
    free = np.flatnonzero(~held.ravel())
    cost = np.zeros(3 * members + 1)
    cost[-1] = -1.0
    found = linprog(
        cost,
        A_ub=np.array([row for row, _ in rows]) if rows else None,
        b_ub=np.array([limit for _, limit in rows]) if rows else None,
        A_eq=balance[free],
        b_eq=right[free],
        bounds=[*bounds, (0.0, None)],
    )
    return float("inf") if found.status == 3 else float(found.x[-1])
