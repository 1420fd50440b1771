"""Discs and straight obstacles: exact impact times, rest, sliding, gases in boxes, π from collisions."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numba import njit

from pinjoint.components.obstacles import Obstacles
from pinjoint.systems.collision.columns import Reason
from pinjoint.systems.collision.free.discs import Discs
from pinjoint.systems.collision.kernels.time_of_impact import INFINITY, first_touch
from tests.reference import collisions
from tests.reference.collisions import Impacts
from tests.reference.scenes_of_discs import GRAVITY

RADIUS = 0.05  # m
EPSILON = np.finfo(float).eps
Point = tuple[float, float]
Wall = tuple[Point, Point]


def obstacles(*walls: Wall, restitution: float = 1.0, radius: float = 0.0) -> Obstacles:
    """Return straight pieces from end to end."""
    ends, count = np.array(walls, dtype=float).reshape(-1, 2, 2), len(walls)
    names = [f"wall {k}" for k in range(count)]
    alike = np.full(count, restitution)
    return Obstacles(ends[:, 0], ends[:, 1] - ends[:, 0], np.full(count, radius), alike, names)


def box(width: float, height: float, restitution: float = 1.0) -> Obstacles:
    """Return the sides of the rectangle from (0, 0) to (width, height)."""
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    return obstacles(*zip(corners, corners[1:] + corners[:1], strict=True), restitution=restitution)


def fly(
    position: Sequence[Point],
    velocity: Sequence[Point] | np.ndarray,
    walls: Obstacles,
    until: float,
    *,
    pull: float = 0.0,
    masses: Sequence[float] = (),
    radius: float = RADIUS,
    restitution: float = 1.0,
) -> tuple[Discs, Impacts]:
    """Let discs happen up to a time."""
    count = len(position)
    inverse = np.repeat(1 / np.array(masses or [1.0] * count)[:, None], 2, axis=1)
    down = np.tile([0.0, -pull], (count, 1))
    discs = Discs(
        position,
        velocity,
        np.full(count, radius),
        inverse,
        acceleration=down,
        restitution=restitution,
        obstacles=walls,
    )
    reason, impacts = discs.advance(until)
    assert reason is Reason.DONE
    return discs, Impacts(impacts)


def places(discs: Discs, position: Sequence[Point]) -> np.ndarray:
    return np.array(position) + discs.state_at(discs.now)[0]


# --- one disc -----------------------------------------------------------------------------------------------


def test_a_bouncing_ball_comes_to_rest_when_infinitely_many_bounces_are_over() -> None:
    """It falls for √(2h/g); every bounce takes e times as long as the one before: Zeno's sum is t₀ (1 + e)/(1 − e)."""
    restitution, first = 0.5, math.sqrt(2 / GRAVITY)
    floor = obstacles(((-1.0, 0.0), (1.0, 0.0)), restitution=restitution)
    discs, impacts = fly([(0.0, 1.0 + RADIUS)], [(0, 0)], floor, 5.0, pull=GRAVITY)
    lasts = 2 * first * restitution ** np.arange(1, len(impacts))
    expected = first + np.concatenate([[0.0], np.cumsum(lasts)])
    assert len(impacts) > 12  # until a bounce is below 1e-9 of the radius
    assert impacts.time[:8] == pytest.approx(expected[:8], rel=1e-13)
    assert impacts.time == pytest.approx(expected, abs=1e-10)
    assert impacts.pairs.tolist() == [[0, 1]] * len(impacts)
    assert discs.at_rest
    assert discs.last_change == pytest.approx(first * (1 + restitution) / (1 - restitution), abs=1e-5)
    assert places(discs, [(0.0, 1.0 + RADIUS)])[0] == pytest.approx([0, RADIUS], abs=1e-6 * RADIUS)
    assert discs.contact_forces()[0] == pytest.approx([0, GRAVITY])


@given(
    start=st.tuples(st.floats(0.06, 1.9), st.floats(0.06, 0.9)),
    angle=st.floats(0, 2 * math.pi),
    speed=st.sampled_from([1e-3, 1.0, 1e6]),
)
@settings(max_examples=20)
def test_in_a_box_a_disc_goes_to_and_fro(start: Point, angle: float, speed: float) -> None:
    """Unfolded at the walls its path is straight: each coordinate is a triangle wave. Nothing tunnels."""
    width, height, duration = 2.0, 1.0, 200.0 / speed
    velocity = speed * np.array([math.cos(angle), math.sin(angle)])
    discs, impacts = fly([start], [tuple(velocity)], box(width, height), duration)
    room = np.array([width, height]) - 2 * RADIUS
    unfolded = np.array(start) - RADIUS + duration * velocity
    folded = room - np.abs(unfolded % (2 * room) - room)
    assert places(discs, [start])[0] == pytest.approx(RADIUS + folded, abs=1e-11)
    assert np.hypot(*discs.state_at(duration)[1][0]) == pytest.approx(speed, rel=1e-13)
    assert len(impacts) == np.abs(np.floor(unfolded / room)).sum()


def test_an_end_is_as_hard_as_the_side() -> None:
    """Head-on at its end; past it by less than the radius: the normal points from the end to the centre."""
    wall = obstacles(((0.0, 0.0), (1.0, 0.0)))
    head_on, impacts = fly([(-1.0, 0.0)], [(1, 0)], wall, 2.0)
    assert impacts.time[0] == pytest.approx(1 - RADIUS, rel=1e-15)
    assert head_on.state_at(2.0)[1][0].tolist() == [-1, 0]
    aside, impacts = fly([(-0.03, 1.0)], [(0, -1)], wall, 2.0)
    height = math.sqrt(RADIUS**2 - 0.03**2)
    assert impacts.time[0] == pytest.approx(1 - height, rel=1e-14)
    normal = np.array([-0.03, height]) / RADIUS
    assert aside.state_at(2.0)[1][0] == pytest.approx(np.array([0, -1]) + 2 * normal[1] * normal, abs=1e-14)
    assert impacts.point[0] == pytest.approx([0, 0], abs=1e-15)


def test_one_that_passes_beside_or_along_it_is_not_deflected() -> None:
    wall = obstacles(((0.0, 0.0), (1.0, 0.0)))
    for start, velocity in (
        ((-1.0, RADIUS * 1.0000001), (1, 0)),
        ((0.5, RADIUS), (1, 0)),
        ((-0.051, 1), (0, -1)),
    ):
        discs, impacts = fly([start], [velocity], wall, 5.0)
        assert len(impacts) == 0
        assert discs.state_at(5.0)[1][0].tolist() == list(velocity)


def test_sliding_down_an_incline_and_over_its_end() -> None:
    """Along it a = g sin α without steps; then it goes around the end while v²/R < g cos β, here not at all."""
    angle = math.radians(30)
    along, normal = np.array([math.cos(angle), -math.sin(angle)]), np.array([math.sin(angle), math.cos(angle)])
    incline = obstacles(((0.0, 0.0), tuple(along)), restitution=0.0)
    start = tuple(0.1 * along + RADIUS * normal)
    pull = GRAVITY * math.sin(angle)
    edge = math.sqrt(2 * 0.9 / pull)
    for time in (0.3, edge):
        discs, impacts = fly([start], [(0, 0)], incline, time, pull=GRAVITY, restitution=0.0)
        moved, velocity = (column[0] for column in discs.state_at(time))
        assert moved == pytest.approx(0.5 * pull * time**2 * along, abs=1e-14)
        assert velocity == pytest.approx(pull * time * along, abs=1e-13)
        assert len(impacts) == 0
    after = 0.2
    discs, _ = fly([start], [(0, 0)], incline, edge + after, pull=GRAVITY, restitution=0.0)
    expected = (0.9 + pull * edge * after) * along - [0, 0.5 * GRAVITY * after**2]
    assert discs.state_at(edge + after)[0][0] == pytest.approx(expected, abs=1e-11)


def test_slowly_over_an_edge_it_turns_until_it_leaves() -> None:
    """From rest it leaves the edge at cos β = 2/3, with v² = 2 g R (1 − cos β): a ball on a ball that is held."""
    table = obstacles(((-1.0, 0.0), (0.0, 0.0)), restitution=0.0)
    start, speed = (-0.01, RADIUS), 1e-4
    discs, _ = fly([start], [(speed, 0)], table, 100.0, pull=GRAVITY, restitution=0.0)
    trace = Discs(
        [start], [(speed, 0)], [RADIUS], [[1, 1]], acceleration=[[0, -GRAVITY]], restitution=0, obstacles=table
    )
    left = None
    for time in np.arange(100.0, 101.5, 1e-3):
        trace.advance(time)
        x, y = places(trace, [start])[0]
        if math.hypot(x, y) > RADIUS * (1 + 1e-6):
            break
        assert math.hypot(x, y) >= RADIUS * (1 - 1e-6)
        left = y / RADIUS
    assert left == pytest.approx(2 / 3, abs=0.03)
    assert discs.impacts == 0


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("walls", [1, 2])
@pytest.mark.parametrize("speed", [0.02, 0.1, 0.3])
def test_over_an_edge_it_leaves_once_whatever_stands_below(
    restitution: float, walls: int, speed: float
) -> None:
    """It leaves at cos β = 2/3 + v₀²/(3 g R), with v² = v₀² + 2 g R (1 − cos β).

    The force falls to 0 within a step there: let go at its start, the disc met the edge again at once, for ever.
    Two walls have one edge in common, not two whose forces are not determined.
    """
    edge = obstacles(((-1.0, 0.0), (0.0, 0.0)), ((0.0, 0.0), (0.1, -3.0)), restitution=restitution)
    if walls == 1:
        edge = obstacles(((-1.0, 0.0), (0.0, 0.0)), restitution=restitution)
    discs = Discs(
        [(-0.01, RADIUS)],
        [(speed, 0)],
        [RADIUS],
        [[1, 1]],
        acceleration=[[0, -GRAVITY]],
        restitution=restitution,
        obstacles=edge,
    )
    cosine = 2 / 3 + speed**2 / (3 * GRAVITY * RADIUS)
    leaving = math.sqrt(speed**2 + 2 * GRAVITY * RADIUS * (1 - cosine))
    turned = 0.01 / speed
    while places(discs, [(-0.01, RADIUS)])[0][1] > 0.5 * RADIUS * cosine:
        turned += 0.005
        reason, _ = discs.advance(turned, 1000)
        assert reason is Reason.DONE
    assert discs.impacts == 0
    across = discs.state_at(discs.now)[1][0][0]
    assert across == pytest.approx(leaving * cosine, rel=1e-4)


@pytest.mark.parametrize("angle", [15, 30, 45, 60])
def test_a_ball_in_a_v_of_two_walls_comes_to_rest_on_both(angle: float) -> None:
    """At height R / cos α; each wall pushes with m g / (2 cos α)."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    groove = obstacles(((-c, s), (0.0, 0.0)), ((0.0, 0.0), (c, s)), restitution=0.5)
    discs, _ = fly([(0.1, 1.0)], [(0, 0)], groove, 60.0, pull=GRAVITY, restitution=0.5)
    assert discs.at_rest
    assert places(discs, [(0.1, 1.0)])[0] == pytest.approx([0, RADIUS / c], abs=1e-6 * RADIUS)
    assert discs.contact_forces()[0] == pytest.approx([0, GRAVITY], abs=1e-6)


@njit
def _first(dx, dy, vx, vy, ax, ay, tx, ty, reach):
    return first_touch((dx, dy, vx, vy, ax, ay), tx, ty, 0.0, reach, 0.0, 0.0, 1e9, False)


COORDINATE = st.floats(-2, 2).map(lambda x: round(x, 3))


@given(
    first=st.tuples(COORDINATE, COORDINATE),
    span=st.tuples(COORDINATE, COORDINATE),
    velocity=st.tuples(COORDINATE, COORDINATE),
    pull=st.sampled_from([(0.0, 0.0), (0.0, 9.81), (1.0, 2.0)]),
)
@settings(max_examples=80)
def test_the_first_touch_is_that_of_the_slow_search(
    first: Point, span: Point, velocity: Point, pull: Point
) -> None:
    """Every root of every part's gap in extended precision; the first at which the distance comes down to R."""
    reach = 0.1
    assume(collisions.distance_to_piece(np.array(first), np.array(span)) >= reach + 1e-6)
    expected = collisions.time_to_piece(np.array([first, velocity, pull]), np.array(span), reach, 10.0)
    found = _first(*first, *velocity, *pull, *span, reach)
    if expected <= 10.0:
        graze = 1e-7 if found == INFINITY or abs(found - expected) > 1e-9 else 0.0  # within round-off of a miss
        wider = collisions.time_to_piece(np.array([first, velocity, pull]), np.array(span), reach - graze, 10.0)
        if wider <= 10.0:
            assert found == pytest.approx(float(expected), rel=1e-11, abs=1e-6 if graze else 1e-11)
    else:
        assert found > 10.0 - 1e-9


# --- many discs ---------------------------------------------------------------------------------------------


def test_a_gas_in_a_box_keeps_its_energy_and_presses_on_the_walls() -> None:
    """p A = N k T (1 + 2η + …) in 2D with k T = m v²/2, over the area that centres can reach; a hundred thousand impacts."""
    count, width, height, radius, duration = 400, 2.0, 1.0, 0.002, 150.0
    rng, across = np.random.default_rng(3), 40
    start = [((i % across + 0.5) * width / across, (i // across + 0.5) * height / 10) for i in range(count)]
    angle = rng.uniform(0, 2 * math.pi, count)
    velocity = np.column_stack([np.cos(angle), np.sin(angle)])
    discs, impacts = fly(start, velocity, box(width, height), duration, radius=radius)
    assert len(impacts) > 100_000
    place, velocity = places(discs, start), discs.state_at(duration)[1]
    assert (velocity**2).sum() == pytest.approx(count, rel=1e-12)
    assert (place >= radius * (1 - 1e-9)).all()
    assert (place <= np.array([width, height]) - radius * (1 - 1e-9)).all()
    on_walls = impacts.pairs[:, 1] >= count
    pressure = impacts.impulse[on_walls].sum() / duration / (2 * (width + height - 4 * radius))
    area = (width - 2 * radius) * (height - 2 * radius)
    filled = count * math.pi * radius**2 / (width * height)
    assert pressure * area == pytest.approx(count * 0.5 * (1 + 2 * filled), rel=0.01)


def test_a_pile_in_a_box_rests_on_its_floor() -> None:
    count, radius = 120, 0.04
    rng = np.random.default_rng(0)
    start = [(0.06 + (i % 12) * 0.085 + 0.01 * rng.random(), 0.05 + (i // 12) * 0.09) for i in range(count)]
    walls = box(1.1, 5.0, restitution=0.3)
    discs, _ = fly(start, np.zeros((count, 2)), walls, 30.0, pull=GRAVITY, radius=radius, restitution=0.3)
    place = places(discs, start)
    apart = np.hypot(*(place[:, None] - place[None]).transpose(2, 0, 1)) + 9 * np.eye(count)
    assert discs.at_rest
    assert apart.min() >= 2 * radius * (1 - 1e-6)
    assert place.min() >= radius * (1 - 1e-6)
    assert place[:, 0].max() <= 1.1 - radius * (1 - 1e-6)


@pytest.mark.parametrize(("count", "seed"), [(3, 5), (3, 59), (4, 36), (4, 50), (4, 53), (10, 0)])
def test_discs_that_slide_into_a_groove_do_not_sink_in(count: int, seed: int) -> None:
    """Their contacts with one another come and go; each goes on being pushed by the wall as it must be then."""
    rng = np.random.default_rng(seed)
    start = np.column_stack([rng.uniform(-0.7, 0.7, count), 1.0 + 0.12 * np.arange(count)])
    groove, down = obstacles(((-1.0, 1.0), (0.0, 0.0)), ((1.0, 1.0), (0.0, 0.0)), restitution=0.5), GRAVITY
    discs = Discs(
        start,
        np.zeros((count, 2)),
        np.full(count, 0.04),
        np.ones((count, 2)),
        acceleration=np.tile([0.0, -down], (count, 1)),
        restitution=0.5,
        obstacles=groove,
    )
    for time in np.arange(0.01, 2.5, 0.01):
        discs.advance(time)
        place = places(discs, start)
        to_sides = (place[:, 1] - np.abs(place[:, 0])) / math.sqrt(2)
        apart = np.hypot(*(place[:, None] - place[None]).transpose(2, 0, 1)) + 9 * np.eye(count)
        assert to_sides.min() >= 0.04 * (1 - 1e-6)
        assert apart.min() >= 0.08 * (1 - 1e-6)


def test_the_restitution_of_a_wall_is_its_own() -> None:
    """Impacts with it lose by its own number, those of discs with each other by theirs."""
    wall = obstacles(((0.0, -1.0), (0.0, 1.0)), restitution=0.25)
    discs, impacts = fly([(1, 0), (2, 0)], [(-1, 0), (-1, 0)], wall, 1.8, restitution=0.5)
    assert impacts.loss == pytest.approx([0.5 * (1 - 0.25**2), 0.25 * (1 - 0.5**2) * 1.25**2])
    assert discs.state_at(1.8)[1].sum() == pytest.approx(-0.75)
