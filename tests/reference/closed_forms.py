"""Textbook answers, each with its formula. Any consistent units unless the docstring names them.

Symbols: ω = √(k/m) circular frequency, ζ = damping ratio c/(2mω), ω_d = ω√(1−ζ²), e = restitution.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import root

# Vibration of one degree of freedom: m u'' + c u' + k u = F(t)


def free_vibration(
    time: float, omega: float, zeta: float, displacement: float, velocity: float
) -> tuple[float, float]:
    """Return (u, u') at `time` after release with u₀, v₀.

    With σ = ζω: under-damped u = e^(−σt) (u₀ C + (v₀ + σu₀) S), where C = cos ω_d t, S = sin(ω_d t)/ω_d;
    critical C = 1, S = t; over-damped C = cosh βt, S = sinh(βt)/β, β = ω√(ζ²−1).
    u' = e^(−σt) (v₀ C − (ω²u₀ + σv₀) S). Over-damped, the two exponentials are summed directly, since
    cosh overflows where e^(−σt) underflows.
    """
    sigma = zeta * omega
    if zeta > 1:
        beta = omega * math.sqrt(zeta**2 - 1)
        slow, fast = math.exp((beta - sigma) * time), math.exp((-beta - sigma) * time)
        c, s = (slow + fast) / 2, (slow - fast) / (2 * beta)
    else:
        omega_d = omega * math.sqrt(1 - zeta**2)
        decay = math.exp(-sigma * time)
        c = decay * math.cos(omega_d * time)
        s = decay * (math.sin(omega_d * time) / omega_d if omega_d > 0 else time)
    return (
        displacement * c + (velocity + sigma * displacement) * s,
        velocity * c - (omega**2 * displacement + sigma * velocity) * s,
    )


def step_overshoot(zeta: float) -> float:
    """Return max u/u_static under a suddenly applied force, ζ < 1: 1 + e^(−πζ/√(1−ζ²)); 2 undamped."""
    return 1 + math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2))


def ramp_response(time: float, rise: float, omega: float) -> float:
    """Return u/u_static, undamped, force rising linearly during t_r.

    t ≤ t_r: (t − sin(ωt)/ω)/t_r; later: 1 + (sin ω(t−t_r) − sin ωt)/(ωt_r).
    """
    if time <= rise:
        return (time - math.sin(omega * time) / omega) / rise
    return 1 + (math.sin(omega * (time - rise)) - math.sin(omega * time)) / (omega * rise)


def elastoplastic_ductility(force_over_strength: float) -> float:
    """Return u_max/u_yield, undamped elastic-perfectly plastic, sudden constant F, R/2 ≤ F < R.

    Work F u = ½ R u_y + R (u − u_y) at the turning point: μ = 1/(2 (1 − F/R)).
    """
    return 1 / (2 * (1 - force_over_strength))


def elastic_plastic_step(time: float, omega: float, share: float) -> float:
    """Return u/u_yield at `time` after a sudden force of `share` > ½ of the strength, before it yields again.

    Elastic u = share (1 − cos ωt) to 1; then u'' = −ω² (1 − share) to rest, if share < 1; then about a new middle.
    """
    yields = math.acos(1 - 1 / share) / omega
    speed = share * omega * math.sin(omega * yields)
    slowing = omega**2 * (1 - share)
    rests = yields + speed / slowing if slowing > 0 else math.inf
    if time <= yields:
        return share * (1 - math.cos(omega * time))
    if time <= rests:
        since = time - yields
        return 1 + speed * since - slowing * since**2 / 2
    peak = 1 + speed**2 / (2 * slowing)
    return peak - (1 - share) * (1 - math.cos(omega * (time - rests)))


# Several degrees of freedom, large swings, impacts


def chain_frequencies(count: int, stiffness: float, mass: float) -> list[float]:
    """Return the natural frequencies [Hz] of n equal masses between n+1 equal springs, both ends fixed.

    f_j = (1/π) √(k/m) sin(jπ / (2(n+1))).
    """
    return [
        math.sqrt(stiffness / mass) / math.pi * math.sin(j * math.pi / (2 * (count + 1)))
        for j in range(1, count + 1)
    ]


def pendulum_period_ratio(amplitude: float) -> float:
    """Return T/T₀ of a pendulum released at `amplitude` [rad]: (2/π) K(sin θ₀/2) = 1/agm(1, cos θ₀/2)."""
    a, b = 1.0, math.cos(amplitude / 2)
    while abs(a - b) > 1e-15 * a:
        a, b = (a + b) / 2, math.sqrt(a * b)
    return 1 / a


def impact_velocities(
    mass1: float, mass2: float, velocity1: float, velocity2: float, restitution: float
) -> tuple[float, float]:
    """Return the velocities along the line of centres after impact.

    v₁' = [e m₂ (v₂ − v₁) + m₁v₁ + m₂v₂] / (m₁ + m₂), and symmetric.
    """
    momentum = mass1 * velocity1 + mass2 * velocity2
    exchange = restitution * (velocity2 - velocity1)
    total = mass1 + mass2
    return (mass2 * exchange + momentum) / total, (-mass1 * exchange + momentum) / total


def bounce_height(height: float, restitution: float, bounces: int) -> float:
    """Return the height reached after n bounces on the ground: e^(2n) h."""
    return height * restitution ** (2 * bounces)


def bouncing_time(height: float, gravity: float, restitution: float) -> float:
    """Return the time from release until a ball lies still: √(2h/g) (1 + e)/(1 − e)."""
    return math.sqrt(2 * height / gravity) * (1 + restitution) / (1 - restitution)


def galperin_contacts(power: int) -> int:
    """Return the contacts of a mass 1 between a wall and a coming mass 100^k: ⌈π/arctan 10^(−k)⌉ − 1."""
    return math.ceil(math.pi / math.atan(10.0**-power)) - 1


# Integrators on u'' + 2ζω u' + ω² u = 0


def taylor2_growth(omega_step: float) -> float:
    """Return the energy's growth per step of the thesis' scheme, undamped: 1 + (ωΔt)²/2.

    It is the determinant of [[1 − z²/2, z], [−z, 1]], z = ωΔt, whose eigenvalues are conjugate.
    """
    return 1 + omega_step**2 / 2


# Von Mises truss: two equal rods from supports 2b apart to a crown H above, loaded down at the crown


def von_mises_force(deflection: float, height: float, half_span: float, stiffness: float) -> float:
    """Return the load that holds the crown at `deflection` δ: P = 2 EA (H − δ) (1/L − 1/L₀).

    L = √(b² + (H − δ)²), rods linear in engineering strain.
    """
    rise = height - deflection
    return 2 * stiffness * rise * (1 / math.hypot(half_span, rise) - 1 / math.hypot(half_span, height))


def von_mises_energy(deflection: float, height: float, half_span: float, stiffness: float) -> float:
    """Return the strain energy of both rods at `deflection`: EA (L − L₀)²/L₀."""
    rest_length = math.hypot(half_span, height)
    return stiffness * (math.hypot(half_span, height - deflection) - rest_length) ** 2 / rest_length


def von_mises_limit(height: float, half_span: float, stiffness: float) -> tuple[float, float]:
    """Return (limit load, deflection there): dP/dδ = 0 where L³ = b² L₀."""
    length = (half_span**2 * math.hypot(half_span, height)) ** (1 / 3)
    deflection = height - math.sqrt(length**2 - half_span**2)
    return von_mises_force(deflection, height, half_span, stiffness), deflection


def von_mises_landing(height: float, half_span: float, stiffness: float) -> float:
    """Return the deflection beyond 2H at which the snapped truss carries its limit load."""
    load, _ = von_mises_limit(height, half_span, stiffness)
    return _bisect(
        lambda deflection: von_mises_force(deflection, height, half_span, stiffness) - load,
        2 * height,
        4 * height,
    )


def von_mises_dynamic_limit(height: float, half_span: float, stiffness: float) -> float:
    """Return the least suddenly applied load that snaps the undamped truss through.

    The crown just reaches the unstable equilibrium at rest: P δ = U(δ) and P = dU/dδ there.
    """
    _, at_limit = von_mises_limit(height, half_span, stiffness)

    def surplus(deflection: float) -> float:
        load = von_mises_force(deflection, height, half_span, stiffness)
        return load * deflection - von_mises_energy(deflection, height, half_span, stiffness)

    return von_mises_force(_bisect(surplus, at_limit, height), height, half_span, stiffness)


def von_mises_bifurcation(height: float, half_span: float, stiffness: float) -> float:
    """Return the load at which a steep truss, L₀² > 27b²/4, may give way sideways, before its limit load.

    The crown's lateral stiffness 2 EA (c²/L₀ + (1/L₀ − 1/L) s²), s = (H − δ)/L, c = b/L, vanishes where
    L³ = L₀ (L² − b²); the larger root lies above 2L₀/3.
    """
    rest_length = math.hypot(half_span, height)
    length = _bisect(lambda x: x**3 - rest_length * (x**2 - half_span**2), 2 * rest_length / 3, rest_length)
    deflection = height - math.sqrt(length**2 - half_span**2)
    return von_mises_force(deflection, height, half_span, stiffness)


# Chain of equal elastic rods between two fixed points


def hanging_chain(
    rods: int, span: tuple[float, float], rest_length: float, stiffness: float, weight: float
) -> np.ndarray:
    """Return the nodes (rods + 1, 2) [m] of a chain from (0, 0) to `span`, `weight` [kN] on each inner node.

    The horizontal force H is the same in all rods, the vertical one V grows by the weight from node to node:
    rod k carries N = √(H² + V²) along (H, V)/N, with length L₀ (1 + N/EA). H and V of the first rod are such
    that the chain ends at `span`.
    """

    def nodes(pull: np.ndarray) -> np.ndarray:
        force = np.column_stack([np.full(rods, pull[0]), pull[1] + weight * np.arange(rods)])
        size = np.hypot(*force.T)[:, None]
        steps = force / size * rest_length * (1 + size / stiffness)
        return np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])

    total = weight * (rods - 1)
    found = root(lambda pull: nodes(pull)[-1] - span, np.array([total, -total / 2]), tol=1e-15)
    return nodes(found.x)


# Three-bar truss: a vertical bar and two at 45°, equal area and strength S (force per bar), loaded down


def three_bar_first_yield(strength: float) -> float:
    """Return the load at which the vertical bar yields: S (1 + 2·½·√½) = 1.7071 S.

    Elastic: a bar at 45° has half the strain of the vertical one (first-order geometry).
    """
    return strength * (1 + math.sqrt(0.5))


def three_bar_collapse(strength: float) -> float:
    """Return the load at which all bars yield: S (1 + 2√½) = 2.4142 S."""
    return strength * (1 + math.sqrt(2))


def three_bar_residual(strength: float, load: float | None = None) -> tuple[float, float]:
    """Return the forces (vertical, inclined) after unloading from P (default: collapse), first yield < P.

    Under P the vertical bar carries S, the others (P − S)/√2. Elastic unloading takes P/P_yield times the
    forces at first yield, S and S/2. From collapse S (1 − √2) and S (1 − √½) are left.
    """
    load = three_bar_collapse(strength) if load is None else load
    share = load / three_bar_first_yield(strength)
    return strength * (1 - share), (load - strength) / math.sqrt(2) - strength / 2 * share


def _bisect(function: Callable[[float], float], low: float, high: float) -> float:
    """Return a root of `function` between `low` and `high`, where its signs differ, to the last bit."""
    sign = math.copysign(1.0, function(low))
    while low < (middle := (low + high) / 2) < high:
        if sign * function(middle) > 0:
            low = middle
        else:
            high = middle
    return high
