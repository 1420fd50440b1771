"""The collision engine against closed forms, conservation laws and the slow, exact reference."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from pinjoint.systems.collision.columns import Reason
from pinjoint.systems.collision.free.discs import Discs
from pinjoint.systems.collision.kernels.time_of_impact import INFINITY, first_approach
from tests.reference import closed_forms, collisions
from tests.reference.collisions import Impacts
from tests.reference.scenes_of_discs import GRAVITY, Scene, break_shot, gas, line, stacked, with_held

EPSILON = np.finfo(float).eps
RADIUS = 0.05  # m


def fly(scene: Scene, until: float, **rest: object) -> tuple[Discs, Impacts]:
    """Let a scene happen up to a time."""
    discs = Discs(**scene, **rest)
    reason, impacts = discs.advance(until)
    assert reason is Reason.DONE
    return discs, Impacts(impacts)


def velocities(discs: Discs) -> np.ndarray:
    return discs.state_at(discs.now)[1]


def places(discs: Discs, scene: Scene) -> np.ndarray:
    return scene["position"] + discs.state_at(discs.now)[0]


def kinetic_energy(velocity: np.ndarray, scene: Scene) -> float:
    inverse = scene["inverse_mass"]
    return float((velocity[inverse > 0] ** 2 / inverse[inverse > 0]).sum() / 2)


# --- two discs ----------------------------------------------------------------------------------------------


@given(
    masses=st.tuples(*[st.floats(-3, 3).map(lambda power: 10.0**power)] * 2),
    speeds=st.tuples(st.floats(1e-3, 1e3), st.floats(-1e3, -1e-3)),
    restitution=st.floats(0, 1),
)
@settings(max_examples=40)
def test_any_two_masses_by_newtons_law(
    masses: tuple[float, float], speeds: tuple[float, float], restitution: float
) -> None:
    """v₁' = [e m₂ (v₂ − v₁) + m₁v₁ + m₂v₂]/(m₁ + m₂), impulse (1 + e) μ Δv, (1 − e²) μ Δv²/2 lost; μ = m₁m₂/(m₁ + m₂)."""
    scene = line([0, 1], list(speeds), list(masses))
    meeting = 0.9 / (speeds[0] - speeds[1])
    discs, impacts = fly(scene, 1.5 * meeting, restitution=restitution)
    expected = closed_forms.impact_velocities(*masses, *speeds, restitution)
    size = max(map(abs, speeds))
    assert velocities(discs)[:, 0] == pytest.approx(expected, rel=1e-12, abs=8 * EPSILON * size)
    reduced, approach = masses[0] * masses[1] / sum(masses), speeds[0] - speeds[1]
    assert impacts.impulse == pytest.approx([(1 + restitution) * reduced * approach], rel=1e-12)
    loss = (1 - restitution**2) * reduced * approach**2 / 2
    assert impacts.loss[0] == pytest.approx(loss, rel=1e-10, abs=16 * EPSILON * reduced * size**2)


def test_between_two_held_discs() -> None:
    """The gap is crossed once every 0.8 m / (2 m/s)."""
    discs, impacts = fly(line([0, 0.5, 1.0], [0, 2, 0], [0, 1, 0]), 4.1)
    expected = 0.2 + 0.4 * np.arange(10)
    assert impacts.time == pytest.approx(expected, rel=1e-14)
    assert np.abs(velocities(discs)[1]).tolist() == [2, 0]


def test_held_discs_do_not_meet() -> None:
    scene = line([0, 0.05, 0.5], [0, 0, 1], [0, 0, 1])
    discs, impacts = fly(scene, 0.42)
    assert len(impacts) == 0
    assert places(discs, scene)[2, 0] == pytest.approx(0.92)


# --- Galperin, cradles, breaks ------------------------------------------------------------------------------


@pytest.mark.parametrize("power", range(6))
def test_galperin_counts_the_digits_of_pi(power: int) -> None:
    """A mass 1 at rest between a wall and a coming mass 100^k: 3, 31, 314, … contacts."""
    scene = line([0, 1, 2], [0, 0, -1], [0, 1, 100.0**power])
    discs, impacts = fly(scene, 1e4)
    assert len(impacts) == closed_forms.galperin_contacts(power) == int(math.pi * 10**power)
    assert kinetic_energy(velocities(discs), scene) == pytest.approx(
        100.0**power / 2, rel=len(impacts) * EPSILON
    )


@pytest.mark.parametrize("power", range(1, 5))
def test_thousands_of_reflections_at_one_instant_lose_nothing(power: int) -> None:
    """Galperin's masses, touching: all contacts happen at once, and the heavy one is sent back as in the plane."""
    scene = line([0, 0.1, 0.2], [0, 0, -1], [0, 1, 100.0**power])
    discs, _ = fly(scene, 0.01)
    count = closed_forms.galperin_contacts(power)
    assert kinetic_energy(velocities(discs), scene) == pytest.approx(100.0**power / 2, rel=8 * count * EPSILON)
    small, heavy = velocities(discs)[1:, 0]
    assert 0.0 <= small <= heavy


@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_a_row_that_fits_exactly_between_two_held_discs_stops(restitution: float) -> None:
    """Nothing can open its contacts: reflected, it would bounce for ever at one instant."""
    places = 0.1 * np.arange(7)
    discs, impacts = fly(
        line(places.tolist(), [0, 1, 0, -2, 0, 3, 0], [0, 1, 1, 1, 1, 1, 0]), 0.5, restitution=restitution
    )
    assert np.abs(velocities(discs)).max() <= 1e-12
    assert impacts.loss.sum() == pytest.approx(0.5 * (1 + 4 + 9), rel=1e-12)


@pytest.mark.parametrize("gap", [0.0, 1e-6])
@pytest.mark.parametrize("struck", [1, 2, 3, 4])
def test_cradle(struck: int, gap: float) -> None:
    """k balls in, k balls out."""
    waiting = [(0.1 + gap) * k for k in range(5 - struck)]
    coming = [-1.0 - (0.1 + gap) * k for k in range(struck)]
    scene = line(coming + waiting, [1] * struck + [0] * (5 - struck), [1] * 5)
    discs, _ = fly(scene, 2.0)
    ordered = velocities(discs)[np.argsort(places(discs, scene)[:, 0], kind="stable")]
    assert ordered[:, 0] == pytest.approx([0] * (5 - struck) + [1] * struck, abs=1e-14)


def mirrored_error(value: np.ndarray, place: np.ndarray) -> float:
    """How far a column of vectors is from its mirror image about the x axis, disc by disc."""
    partner = np.hypot(*(place[:, None] - place[None] * [1, -1]).transpose(2, 0, 1)).argmin(axis=1)
    return float(np.abs(value - value[partner] * [1, -1]).max())


@pytest.mark.parametrize("restitution", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("rows", [2, 5, 8])
def test_break_of_touching_balls_is_symmetric_and_loses_nothing(rows: int, restitution: float) -> None:
    """All contacts of the rack are struck at one instant; a fixed serial order would break the symmetry."""
    scene = break_shot(rows)
    discs, impacts = fly(scene, 0.6, restitution=restitution)
    velocity = velocities(discs)
    assert mirrored_error(velocity, scene["position"]) <= 1e-13 * 5
    assert mirrored_error(discs.state_at(0.6)[0], scene["position"]) <= 1e-13 * 5
    assert velocity.sum(axis=0) == pytest.approx([5, 0], abs=1e-13)
    assert kinetic_energy(velocity, scene) + impacts.loss.sum() == pytest.approx(12.5, rel=1e-13)
    if restitution == 1.0:
        assert impacts.loss.sum() == pytest.approx(0, abs=1e-13)


def grown(scene: Scene, until: float, size: float = 1e-10) -> float:
    """By how much a small error at the start has grown, at least 1."""
    rng = np.random.default_rng(0)
    shift = size * rng.uniform(-1, 1, scene["position"].shape) * (scene["inverse_mass"] > 0)
    moved = {**scene, "position": scene["position"] + shift}
    (there, _), (beside, _) = fly(scene, until), fly(moved, until)
    errors = places(beside, moved) - places(there, scene), velocities(beside) - velocities(there)
    return max(1.0, *(float(np.abs(error).max()) / size for error in errors))


def test_break_with_gaps_stays_symmetric() -> None:
    scene = break_shot(5, gap=5e-3)
    discs, impacts = fly(scene, 0.5)
    assert len(impacts) == 10
    assert mirrored_error(discs.state_at(0.5)[0], scene["position"]) <= 1e-12


def test_time_reversal_of_a_break() -> None:
    """Turned back, everything returns to the start, within the error that chaos allows."""
    scene = break_shot(5, gap=2e-2)
    scene["position"] += np.random.default_rng(1).uniform(-5e-3, 5e-3, scene["position"].shape)
    discs, impacts = fly(scene, 0.6)
    back = {**scene, "position": places(discs, scene), "velocity": -velocities(discs)}
    returned, again = fly(back, 0.6)
    assert len(again) == len(impacts) == 12
    allowed = 16 * EPSILON * max(grown(scene, 0.6), grown(back, 0.6))
    assert allowed < 1e-6
    assert np.abs(places(returned, back) - scene["position"]).max() <= allowed
    assert np.abs(velocities(returned) + scene["velocity"]).max() <= allowed


# --- many impacts -------------------------------------------------------------------------------------------


def test_energy_of_a_gas_over_a_hundred_thousand_impacts() -> None:
    """Momentum: what the walls gave is what the gas has more."""
    scene = gas(400, 0.4)
    discs, impacts = fly(scene, 16.0)
    assert len(impacts) > 100_000
    assert kinetic_energy(velocities(discs), scene) == pytest.approx(200, rel=1e-12)
    assert abs(impacts.loss.sum()) <= 1e-12 * 200
    at_wall = impacts.pairs[:, 1] >= 400
    ball, wall = impacts.pairs[at_wall].T
    line_of_centres = impacts.point[at_wall] - scene["position"][wall]
    pushed = impacts.impulse[at_wall, None] * line_of_centres / RADIUS
    exchanged = impacts.impulse[at_wall].sum()
    gained = (velocities(discs) - scene["velocity"]).sum(axis=0)
    assert gained == pytest.approx(pushed.sum(axis=0), abs=1e-12 * exchanged)
    assert (ball < 400).all()


def test_momentum_and_energy_of_very_unequal_masses() -> None:
    """A mass 1 squeezed between two that close in, each 10⁹; an impact rounds a heavy one's speed by up to ε/2."""
    heavy = 1e9
    scene = line([-1, 0, 1.5], [1, 0.3, -1], [heavy, 1, heavy])
    discs, impacts = fly(scene, 3.0)
    velocity = velocities(discs)[:, 0]
    assert len(impacts) > 60_000
    allowed = len(impacts) * EPSILON
    assert abs(heavy * (velocity[0] + velocity[2]) + velocity[1] - 0.3) <= allowed * heavy
    assert kinetic_energy(velocities(discs), scene) == pytest.approx(heavy + 0.045, rel=allowed)


def test_speeds_of_a_gas_become_maxwellian() -> None:
    """Rayleigh's distribution: mean speed √π/2 v₀ of discs that all began at v₀; standard error √((4 − π)/4n)."""
    count = 900
    scene = gas(count, 0.3)
    discs, _ = fly(scene, 2.0)
    means = []
    for time in np.linspace(2.5, 6.0, 8):
        discs.advance(float(time))
        means.append(np.hypot(*velocities(discs)[:count].T).mean())
    error = math.sqrt((4 - math.pi) / 4 / count)
    assert np.mean(means) == pytest.approx(math.sqrt(math.pi) / 2, abs=2 * error)


# --- gravity ------------------------------------------------------------------------------------------------


def dropped(height: float) -> Scene:
    """A ball above a held disc."""
    scene = line([0, 0], [0, 0], [0, 1])
    scene["position"][1, 1] = 2 * RADIUS + height
    return scene


DOWN = np.array([0.0, -GRAVITY])


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.9])
def test_bouncing_ball(restitution: float) -> None:
    """hₙ = e²ⁿ h; impacts at √(2h/g)(1 + 2e + … + 2eⁿ); at rest after √(2h/g)(1 + e)/(1 − e), losing m g h."""
    height = 0.7
    fall = math.sqrt(2 * height / GRAVITY)
    ends = closed_forms.bouncing_time(height, GRAVITY, restitution)
    scene = dropped(height)
    discs, impacts = fly(scene, ends + 0.1, acceleration=DOWN, restitution=restitution)
    bounce = np.arange(len(impacts))
    expected = fall * (1 + 2 * restitution * (1 - restitution**bounce) / (1 - restitution))
    speed = math.sqrt(2 * GRAVITY * height) * restitution**bounce
    assert (np.abs(impacts.time - expected) <= 8 * EPSILON / (speed * (1 - restitution))).all()
    kept = np.where(bounce < len(impacts) - 1, restitution, 0.0)  # the last bounce is not worth it
    assert (np.abs(impacts.impulse - (1 + kept) * speed) <= 8 * GRAVITY * EPSILON / speed).all()
    heights = closed_forms.bounce_height(height, restitution, 1)
    assert (impacts.impulse[1] / (1 + restitution)) ** 2 / (2 * GRAVITY) == pytest.approx(heights, rel=1e-12)
    rest = 1e-9 * RADIUS  # bounces lower than that are not worth it
    assert (
        0
        < ends - impacts.time[-1]
        <= 2 * math.sqrt(2 * rest / GRAVITY) * restitution / (1 - restitution) + 1e-12
    )
    assert velocities(discs)[1].tolist() == [0, 0]
    assert places(discs, scene)[1] == pytest.approx([0, 2 * RADIUS], abs=1e-12)
    assert impacts.loss.sum() == pytest.approx(GRAVITY * height, rel=1e-9)
    assert discs.contact_forces()[1] == pytest.approx([0, GRAVITY], rel=1e-12)


def test_a_ball_bounces_for_ever_without_loss() -> None:
    scene = dropped(0.5)
    fall = math.sqrt(2 * 0.5 / GRAVITY)
    _, impacts = fly(scene, 200.5 * fall, acceleration=DOWN)
    assert impacts.time == pytest.approx(fall * (1 + 2 * np.arange(100)), rel=1e-13)


def test_what_lies_still_stays_where_it_is() -> None:
    scene = dropped(0.0)
    discs, impacts = fly(scene, 1e6, acceleration=DOWN, restitution=0.5)
    assert len(impacts) == 0
    assert places(discs, scene).tolist() == scene["position"].tolist()
    assert discs.contact_forces()[1] == pytest.approx([0, GRAVITY], rel=1e-14)


@pytest.mark.parametrize("start", [0.01, 0.3])
def test_sliding_off_a_ball(start: float) -> None:
    """Without friction it leaves where cos θ = ⅔ cos θ₀, at a speed of v² = g R cos θ."""
    reach = 2 * RADIUS
    scene = dropped(0.0)
    scene["position"][1] = reach * math.sin(start), reach * math.cos(start)
    discs = Discs(**scene, acceleration=DOWN, restitution=0.5)
    for _ in range(1000):  # one step of the contact at a time
        discs.advance(10.0, 1)
        if not discs.contact_forces()[1].any():
            break
    displacement, speeds = discs.state_at(discs.last_change)
    left, velocity = scene["position"][1] + displacement[1], speeds[1]
    # a step of the contact turns by 0.0156
    assert left[1] / reach == pytest.approx(2 / 3 * math.cos(start), rel=0.018)
    assert velocity @ velocity == pytest.approx(GRAVITY * left[1], rel=0.04)
    energy = velocity @ velocity / 2 + GRAVITY * left[1]
    assert energy == pytest.approx(GRAVITY * reach * math.cos(start), rel=0.0156**2 / 12)  # of second order


def test_a_ball_in_a_groove_presses_by_its_weight() -> None:
    """Two contacts at 30° from the vertical: N = m g / (2 cos 30°) each; so do 3 balls in a column above."""
    apex = math.sqrt(3) * RADIUS
    scene = line([-RADIUS, RADIUS, 0, 0, 0], [0] * 5, [0, 0, 1, 1, 1])
    scene["position"][2:, 1] = apex, apex + 0.1, apex + 0.2
    discs, _ = fly(scene, 1.0, acceleration=DOWN, restitution=0.5)
    assert velocities(discs).any() == False  # noqa: E712
    state = discs.state()
    forces = {
        tuple(sorted(pair)): force for pair, force in zip(state.contacts.tolist(), state.forces, strict=True)
    }
    side = 3 * GRAVITY / (2 * math.cos(math.pi / 6))
    assert forces[0, 2] == pytest.approx(side, rel=1e-9)
    assert forces[1, 2] == pytest.approx(side, rel=1e-9)
    assert [forces[2, 3], forces[3, 4]] == pytest.approx([2 * GRAVITY, GRAVITY], rel=1e-9)


# --- the instant of contact ---------------------------------------------------------------------------------


@njit
def touch_time(dx, dy, vx, vy, ax, ay, reach):  # type: ignore[no-untyped-def]
    return first_approach((dx, dy, vx, vy, ax, ay), reach, 0.0, 0.0, 1e9, False)


coordinate = st.floats(-3, 3).map(lambda x: round(x, 3))
direction = st.tuples(coordinate, coordinate)


@given(
    distance=st.floats(1.01, 10), angle=st.floats(0, 2 * math.pi), velocity=direction, acceleration=direction
)
@settings(max_examples=150)
def test_roots_of_the_gap_against_numpy(
    distance: float, angle: float, velocity: tuple[float, float], acceleration: tuple[float, float]
) -> None:
    """|d + v t + a t²/2|² = R², a quartic in t; the least root at which the gap closes."""
    d = distance * np.array([math.cos(angle), math.sin(angle)])
    v, a = np.array(velocity), np.array(acceleration)
    quartic = np.array([a @ a / 4, v @ a, v @ v + d @ a, 2 * d @ v, d @ d - 1])
    found = touch_time(*d, *v, *a, 1.0)
    at = lambda t: np.polyval(quartic, t)  # noqa: E731
    roots = np.roots(np.trim_zeros(quartic, "f")) if quartic[:-1].any() else np.array([])
    near_real = roots[np.abs(roots.imag) <= 1e-5 * (1 + np.abs(roots))].real
    candidates = sorted(t for t in near_real if t > 0)
    if found == INFINITY:
        clear = [t for t in candidates if at(t * (1 + 1e-4)) < -1e-8 or at(t) < -1e-8]
        assert not clear
    else:
        assert min(abs(found - t) / found for t in candidates) <= 1e-4
        scale = np.polyval(np.abs(quartic), found)
        assert abs(at(found)) <= 64 * EPSILON * scale
        before = np.linspace(0, found, 200)[:-1]
        assert (at(before) >= -64 * EPSILON * scale).all()


@pytest.mark.parametrize("speed", [1.0, 1e3, 1e9])
def test_nothing_tunnels(speed: float) -> None:
    """A ball at any speed hits the only disc in its way."""
    scene = line([0, 1.0], [speed, 0], [1, 1])
    discs, impacts = fly(scene, 2.0)
    assert impacts.time == pytest.approx([0.9 / speed], rel=1e-14)
    assert velocities(discs)[:, 0].tolist() == pytest.approx([0, speed], abs=EPSILON * speed)


# --- against the slow reference -----------------------------------------------------------------------------


@st.composite
def scenes(draw: st.DrawFn) -> tuple[collisions.Scene, float]:
    """A few discs of various sizes and masses, some held, at random; perhaps with accelerations of their own."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(2, 7))
    cells = rng.permutation(9)[:count]
    position = np.column_stack([cells % 3, cells // 3]) + rng.uniform(-0.2, 0.2, (count, 2))
    radius = rng.uniform(0.02, 0.28, count)
    inverse_mass = np.repeat(10 ** rng.uniform(-2, 2, (count, 1)), 2, axis=1)
    inverse_mass[rng.random(count) < 0.2] = 0.0
    inverse_mass[rng.random((count, 2)) < draw(st.sampled_from([0.0, 0.15]))] = 0.0
    acceleration = np.zeros((count, 2))
    kind = draw(st.sampled_from(["none", "gravity", "own"]))
    if kind != "none":
        acceleration += [0.3, -1.0]
    if kind == "own":
        acceleration += rng.normal(0, 1.0, (count, 2))
    restitution = draw(st.sampled_from([1.0, 0.9, 0.5])) if kind == "none" else 1.0
    velocity = rng.normal(0, 2.0, (count, 2)) * (inverse_mass > 0)
    if not (inverse_mass > 0).any():
        inverse_mass[0] = 1.0
    return collisions.Scene(position, velocity, acceleration, radius, inverse_mass, restitution), 2.0


@given(scenes())
@settings(max_examples=25)
def test_random_scenes_as_the_reference_has_them(case: tuple[collisions.Scene, float]) -> None:
    """The same impacts in the same order; places and speeds to 1e-10 of what errors grow to."""
    scene, duration = case
    expected, history = collisions.run(scene, duration)
    growth = collisions.amplification(scene, duration)
    if growth > 1e4:  # there even the order is a matter of chance
        return
    discs = Discs(
        scene.position,
        scene.velocity * (scene.inverse_mass > 0),
        scene.radius,
        scene.inverse_mass,
        acceleration=scene.acceleration,
        restitution=scene.restitution,
    )
    reason, rows = discs.advance(duration)
    impacts = Impacts(rows)
    assert reason is Reason.DONE
    assert impacts.pairs.tolist() == [list(impact.pair) for impact in history]
    displacement, velocity = discs.state_at(duration)
    tolerance = 1e-10 * growth
    assert np.abs(scene.position + displacement - expected.position).max() <= tolerance
    assert np.abs(velocity - expected.velocity).max() <= tolerance
    for name in ("time", "impulse", "loss"):
        wanted = [getattr(impact, name) for impact in history]
        assert getattr(impacts, name) == pytest.approx(wanted, rel=tolerance, abs=tolerance)


# --- the order of things ------------------------------------------------------------------------------------


def test_when_one_looks_does_not_matter() -> None:
    """Many short advances and one long one give the same bits, for gases and for piles."""
    for scene, rest in ((gas(60, 0.3), {}), (stacked(40, 6), {"acceleration": DOWN, "restitution": 0.3})):
        at_once, _ = fly(scene, 1.0, **rest)
        in_steps = Discs(**scene, **rest)
        for time in np.linspace(0, 1, 61)[1:]:
            in_steps.advance(float(time))
        for one, other in zip(at_once.state_at(1.0), in_steps.state_at(1.0), strict=True):
            assert one.tobytes() == other.tobytes()


def test_a_pile_goes_on_from_its_paths_bit_for_bit() -> None:
    rest = {"acceleration": DOWN, "restitution": 0.3}
    scene = stacked(40, 6)
    through, _ = fly(scene, 0.6, **rest)
    resumed = Discs(**scene, **rest)
    for time in (0.2, 0.4, 0.47, 0.6):
        resumed.advance(time)
        state = resumed.state()
        resumed = Discs(**scene, **rest, time=time)
        resumed.resume(state)
    assert through.counts[9] == resumed.counts[9] == 1  # it steps
    for time in (0.6, 3.0):
        through.advance(time)
        resumed.advance(time)
        for one, other in zip(through.state_at(time), resumed.state_at(time), strict=True):
            assert one.tobytes() == other.tobytes()
        assert through.lost_at(time) == resumed.lost_at(time)
    assert through.at_rest


def test_bystanders_do_not_change_what_happens() -> None:
    """A far disc of another size changes grid and windows, but not a bit of the others' paths."""
    scene = gas(60, 0.3)
    alone, _ = fly(scene, 1.0)
    watched = with_held(scene, np.array([[1e5, 0.0]]), 100.0)
    beside, _ = fly(watched, 1.0)
    assert alone.state_at(1.0)[0].tobytes() == beside.state_at(1.0)[0][:-1].tobytes()
