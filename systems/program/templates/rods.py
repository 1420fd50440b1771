"""What is computed of one rod `r` from particle `a` to `b`: fragments, pasted into loops over the rods.

sx, sy: displacement of b relative to a (m). drift_x, drift_y: velocity of b relative to a (m/s).
"""

# ruff: noqa: F821, F841
# mypy: ignore-errors


def geometry():
    """Elongation (2D + Δu)·Δu / (L + L_original) + misfit (m): no digits cancel.

    Where no rod is warm the misfit is L_original − L₀, and both are at hand. A rod whose ends meet has no
    direction and pulls nowhere, until something else parts them.
    """
    dx = rods_difference[r, 0]
    dy = rods_difference[r, 1]
    x = dx + sx
    y = dy + sy
    original = rods_original_length[r]
    length = math.sqrt(x * x + y * y)
    inverse = 1.0 / length if length > 0.0 else 0.0
    nx = x * inverse
    ny = y * inverse
    both = length + original
    stretch = ((dx + x) * sx + (dy + y) * sy) / both if both > 0.0 else 0.0
    elongation = stretch + insert(misfit)


def rate():
    """How fast the rod grows longer (m/s)."""
    rate = drift_x * nx + drift_y * ny


def stored():
    """Elastic energy, largest force and stiffness, from the force that stores energy."""
    flexibility = rods_rest_length[r] / rods_stiffness[r]
    largest = max(largest, abs(axial_force))
    stiffest = max(stiffest, 1.0 / flexibility)
    elastic += axial_force * axial_force * flexibility


def observed():
    """The derived columns of rods. A rod yields where its axial force is at its strength, but for round-off."""
    rods_axial_force[r] = axial_force
    rods_length[r] = length
    rods_strain[r] = elongation / rods_rest_length[r]
    low, high = -insert(at_strength) * compression[r], insert(at_strength) * tension[r]
    yielding[r] = yields and (axial_force >= high or axial_force <= low)
