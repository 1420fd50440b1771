"""Laws of rods and particles: scalars of one element in, its force out."""

import math

from pinjoint.systems.base import StopReason
from pinjoint.systems.program.entries import SMALLEST_ENERGY, Account, Measure
from pinjoint.systems.program.kernel import compiled, part

REST_RESIDUAL = 2e-9  # of the largest force, so that sums of residuals are within 1e-8; larger: rests sooner
SMALL_SHARE = 1e-3  # of the largest force ever, taken as scale where all forces die out
DIVERGENCE_SHARE = 0.2  # of all energy ever supplied; smaller: may stop good runs at large steps
YIELDING_SHARE = 0.5  # of what yielding dissipated, which is of first order where a step passes the strength
WOBBLE_SHARE = 10.0  # of all energy supplied; at stable steps of the thesis' scheme at most 8 is possible
INSTABILITY_SHARE = 2.0  # of all energy ever supplied; at stable steps at most 1 is possible
AMPLIFIED = 50.0  # times all energy ever supplied; Verlet amplifies one mode as much at 0.99 of its stable step
LARGEST_ENERGY = 1e90  # J, of the largest mass at the largest speed that can be computed with
LOST_UNSEEN = 1e-9  # of all energy ever supplied; larger: motion that the method took passes for rest
AT_TAUT = 1e-9  # elastic strain within which a cable's motion tells whether it is slack


@compiled
def elastic(elongation, rods_stiffness, rods_rest_length):
    """N = EA ε, ε = (L − L₀)/L₀."""
    return rods_stiffness * (elongation / rods_rest_length)


@compiled
def elastic_after_yielding(elongation, rods_stiffness, rods_rest_length, rods_plastic_strain):
    """N = EA (ε − ε_p)."""
    return rods_stiffness * (elongation / rods_rest_length - rods_plastic_strain)


@compiled
def axial_damper(rate, rods_damping):
    """Force of the axial damper, tension positive: C × rate of elongation."""
    return rods_damping * rate


@compiled
def taut_damper(rate, axial_force, rods_damping, rods_tension_only):
    """The same, but of a cable none while it is slack, and at most what leaves no compression."""
    force = rods_damping * rate
    return max(force, -max(axial_force, 0.0)) * (axial_force > 0.0) if rods_tension_only else force


@compiled
def taut(axial_force, rods_tension_only):
    """A cable bears no compression."""
    return max(axial_force, 0.0) if rods_tension_only else axial_force


@compiled
def slack_branch(elongation, rate, rods_rest_length, rods_plastic_strain, rods_tension_only):
    """1: a cable that is slack or about to be, 0: any other rod."""
    strain = elongation / rods_rest_length - rods_plastic_strain
    if rods_tension_only and (strain < -AT_TAUT or (strain <= AT_TAUT and rate <= 0.0)):
        return 1.0
    return 0.0


@compiled
def slack_margin(branch, elongation, rods_rest_length, rods_plastic_strain, rods_tension_only):
    """Elastic strain up to which a cable stays taut, or slack."""
    if not rods_tension_only:
        return 1.0
    strain = elongation / rods_rest_length - rods_plastic_strain
    return -strain if branch != 0.0 else strain


@compiled
def buckled(axial_force, rods_stiffness, rods_buckling_load):
    """A strut that is pushed by more than P bears P (1 + r/2): r is what of its shortening is not elastic, over L₀."""
    beyond = -axial_force - rods_buckling_load
    return -rods_buckling_load * (1.0 + 0.5 * beyond / rods_stiffness) if beyond > 0.0 else axial_force


@compiled
def buckling_energy(axial_force, rods_stiffness, rods_rest_length, rods_buckling_load):
    """What a strut that bears P (1 + r/2) stores, L₀ (P²/2EA + P (r + r²/4)), less N² L₀/2EA."""
    beyond = -axial_force - rods_buckling_load
    if not beyond > 0.0:
        return 0.0
    squares = beyond * (rods_buckling_load - axial_force)  # N² − P²
    return rods_rest_length * squares * (1.0 / rods_buckling_load - 0.5 / rods_stiffness)


@compiled
def buckling_branch(
    elongation, rate, rods_stiffness, rods_rest_length, rods_plastic_strain, rods_buckling_load
):
    """1: a strut that has buckled or is about to, 0: any other rod."""
    beyond = rods_plastic_strain - elongation / rods_rest_length - rods_buckling_load / rods_stiffness
    return 1.0 if beyond > AT_TAUT or (beyond >= -AT_TAUT and rate < 0.0) else 0.0


@compiled
def buckling_margin(
    branch, elongation, rods_stiffness, rods_rest_length, rods_plastic_strain, rods_buckling_load
):
    """Strain up to which a strut stays straight, or bent aside."""
    if rods_buckling_load == math.inf:
        return 1.0
    beyond = rods_plastic_strain - elongation / rods_rest_length - rods_buckling_load / rods_stiffness
    return beyond if branch != 0.0 else -beyond


@compiled
def bending(slope_start, slope_end, rods_end_stiffness, rods_initial_slopes):
    """End moments of a rod K (φ − φ⁰), K by its hinges, φ⁰ where it is warmer on one side."""
    at_start, at_end = slope_start - rods_initial_slopes[0], slope_end - rods_initial_slopes[1]
    start, mixed, end = rods_end_stiffness
    return start * at_start + mixed * at_end, mixed * at_start + end * at_end


@compiled
def bending_energy(slope_start, slope_end, rods_end_stiffness, rods_initial_slopes):
    """½ (φ − φ⁰)ᵀ K (φ − φ⁰) (kN·m)."""
    at_start, at_end = slope_start - rods_initial_slopes[0], slope_end - rods_initial_slopes[1]
    start, mixed, end = rods_end_stiffness
    return 0.5 * (start * at_start * at_start + end * at_end * at_end) + mixed * at_start * at_end


@compiled
def bending_damper(rate_start, rate_end, rods_end_damping):
    """End moments of a rod by the rates of its slopes."""
    start, mixed, end = rods_end_damping
    return start * rate_start + mixed * rate_end, mixed * rate_start + end * rate_end


@compiled
def turning_drag(particles_inertia, particles_angular_velocity, environment_drag):
    """−drag × J × ω, in kN·m."""
    return -0.001 * environment_drag * particles_inertia * particles_angular_velocity


@compiled
def drag(particles_mass, particles_velocity, environment_drag):
    """−drag × m × v, in kN."""
    factor = -0.001 * environment_drag * particles_mass
    return factor * particles_velocity[0], factor * particles_velocity[1]


@part()
def conserved(measures, account, dt, shadow):
    """Kinetic − (h²/8) fᵀM⁻¹f + elastic + lost by yielding and impacts − supplied (J), as in judge().

    Semi-implicit Euler's velocity is Verlet's half a step earlier: its kinetic energy is
    kinetic + (h/2) f·v + (h²/8) fᵀM⁻¹f, of which the last term cancels.
    What dampers take is left out: near the largest stable step it is known too coarsely.
    """
    kinetic, elastic = measures[Measure.KINETIC], measures[Measure.ELASTIC]
    supplied = account[Account.WORK] + measures[Measure.POTENTIAL] - account[Account.POTENTIAL_REFERENCE]
    lost = account[Account.DISSIPATED_PLASTIC] + account[Account.DISSIPATED_IMPACT]
    if shadow == 2.0:
        return kinetic + 0.5 * dt * measures[Measure.POWER] + elastic + lost - supplied
    missing = max(shadow, 0.0) * dt * dt / 8.0 * measures[Measure.POWER_NORM]
    return kinetic + elastic - missing + lost - supplied


@part()
def judge(measures, account, dt, shadow, ahead, loads_are_over):
    """The StopReason that follows from the measures of a state: DONE (go on), REST or DIVERGED.

    measures, account: see Measure and Account in systems/program/entries.py; the scales and the largest imbalance in
        `account` are kept up to date.
    shadow: 1 if the integrator conserves kinetic − (h²/8) fᵀM⁻¹f + elastic, 2 if it does with velocities
        half a step earlier, -1 if it is as exact as its tolerance, else 0.
    ahead: energy that varying loads will supply in the next step (J); after a jump they have moved the mass but
        done no work yet.

    Diverged: energy came from nowhere, more than a share of all that was supplied (or, where nothing is
    conserved, of what one step can move) and of what yielding took. Beyond the stable step Verlet conserves
    its energy too, while the second term grows past the elastic energy, and both past all that was supplied;
    at the stable step the two are equal, and there is many times more energy than was supplied.
    Rest: the largest residual and the kinetic energy are small relative to the present forces or, in a model that
    swings out to nothing, to a small part of the largest ever; and it was not the method that took the motion. Discs
    that touch swing through no elastic energy: what errors of their contact forces move is small beside all supplied.
    """
    kinetic, elastic = measures[Measure.KINETIC], measures[Measure.ELASTIC]
    power_norm, largest = measures[Measure.POWER_NORM], measures[Measure.LARGEST_FORCE]
    work, begun = account[Account.WORK], account[Account.INITIAL_ENERGY]
    damped = account[Account.DISSIPATED_DAMPING]
    supplied = work + measures[Measure.POTENTIAL] - account[Account.POTENTIAL_REFERENCE]
    lost = account[Account.DISSIPATED_PLASTIC] + account[Account.DISSIPATED_IMPACT]
    deficit = min(max(shadow, 0.0), 1.0) * dt * dt / 8.0 * power_norm
    swinging = kinetic + 0.5 * dt * measures[Measure.POWER] + deficit if shadow == 2.0 else kinetic
    present = swinging + elastic + lost - supplied - begun
    created = conserved(measures, account, dt, shadow) - account[Account.GUARD_ENERGY]
    if shadow < 0.0:
        created = min(created, present)
    account[Account.FORCE_SCALE] = max(account[Account.FORCE_SCALE], largest)
    supply = max(abs(begun), abs(work), abs(supplied), ahead)
    wobble = min(dt * dt * power_norm, WOBBLE_SHARE * supply) if shadow == 0.0 else 0.0
    account[Account.ENERGY_SCALE] = max(account[Account.ENERGY_SCALE], supply, wobble)
    scale = account[Account.ENERGY_SCALE]
    if abs(present + damped) > abs(account[Account.LARGEST_IMBALANCE]):
        account[Account.LARGEST_IMBALANCE] = -present - damped
    bound = DIVERGENCE_SHARE * scale + YIELDING_SHARE * account[Account.DISSIPATED_PLASTIC] + SMALLEST_ENERGY
    amplified = AMPLIFIED * scale + SMALLEST_ENERGY
    if not (created <= bound and present <= amplified and kinetic <= LARGEST_ENERGY):
        return StopReason.DIVERGED
    if min(max(swinging, elastic), deficit - elastic) > INSTABILITY_SHARE * scale + SMALLEST_ENERGY:
        return StopReason.DIVERGED
    still_force = REST_RESIDUAL * max(largest, SMALL_SHARE * account[Account.FORCE_SCALE])
    still_energy = REST_RESIDUAL**2 * max(elastic, (SMALL_SHARE**2 if elastic > 0.0 else 1.0) * scale)
    is_still = measures[Measure.RESIDUAL] <= max(still_force, 8.0 * measures[Measure.ROUND_OFF])
    is_its_own = -present - damped <= damped + LOST_UNSEEN * scale + SMALLEST_ENERGY
    if loads_are_over and is_still and kinetic <= still_energy and is_its_own:
        return StopReason.REST
    return StopReason.DONE


@part()
def lowest(before, slope_before, after, slope_after, dt):
    """The least value of the cubic with these values and slopes, falling first and rising last, dt apart."""
    first = slope_before * dt
    rise = after - before
    second = 3.0 * rise - (2.0 * slope_before + slope_after) * dt
    third = (slope_before + slope_after) * dt - 2.0 * rise
    at = -first / (second + math.sqrt(max(second * second - 3.0 * third * first, 0.0)))
    return before + at * (first + at * (second + at * third))
