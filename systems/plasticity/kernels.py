"""Linear elastic, perfectly plastic: both limits move with the plastic strain."""

from systems.kernels import compiled


@compiled
def limited(axial_force, rods_tension_limit, rods_compression_limit):
    """The axial force cannot pass a strength."""
    return min(max(axial_force, -rods_compression_limit), rods_tension_limit)


@compiled
def yielded(
    elongation,
    rods_stiffness,
    rods_rest_length,
    rods_plastic_strain,
    rods_tension_limit,
    rods_compression_limit,
):
    """Plastic strain after ε_p has taken up what exceeds the elastic range, and |N| |Δε_p| L₀."""
    strain = elongation / rods_rest_length
    trial = rods_stiffness * (strain - rods_plastic_strain)
    if trial > rods_tension_limit:
        plastic = strain - rods_tension_limit / rods_stiffness
        return plastic, rods_tension_limit * (plastic - rods_plastic_strain) * rods_rest_length
    if trial < -rods_compression_limit:
        plastic = strain + rods_compression_limit / rods_stiffness
        return plastic, rods_compression_limit * (rods_plastic_strain - plastic) * rods_rest_length
    return rods_plastic_strain, 0.0
