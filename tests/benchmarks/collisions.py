"""Colliding discs against pymunk in the same run: gases, what an impact costs, piles, memory, energy kept; and discs on
structures, beside the same structures without discs.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pymunk  # here, so that a missing peer is told before anything is measured

from pinjoint.systems.collision.free.discs import EVENTS, HORIZONS, PILES, Discs
from tests.benchmarks.structures_and_discs import driven
from tests.reference.scenes_of_discs import GRAVITY, Scene, gas, lattice, packed, stacked

STEP = 1 / 240  # s; pymunk's
DOWN = np.array([0.0, -GRAVITY])

Row = dict[str, Any]


def _ours(scene: Scene, seconds: float, **rest: Any) -> tuple[float, Discs]:
    discs = Discs(**scene, **rest)
    discs.advance(0.0)
    started = time.process_time()
    discs.advance(seconds)
    return time.process_time() - started, discs


def _pymunk_space(scene: Scene, restitution: float, gravity: float) -> tuple[Any, list[Any]]:
    """The same discs in pymunk, without friction; held ones are static."""
    space = pymunk.Space(threaded=False)
    space.gravity = (0.0, -gravity)
    bodies = []
    columns = (scene[key].tolist() for key in ("position", "velocity", "radius", "inverse_mass"))
    for place, velocity, radius, inverse in zip(*columns, strict=True):
        body = pymunk.Body(1 / inverse[0], 1.0) if inverse[0] else pymunk.Body(body_type=pymunk.Body.STATIC)
        body.position, body.velocity = tuple(place), tuple(velocity)
        circle = pymunk.Circle(body, radius)
        circle.elasticity, circle.friction = restitution, 0.0
        space.add(body, circle)
        bodies.append(body)
    return space, bodies


def _pymunk(scene: Scene, seconds: float, restitution: float, gravity: float) -> tuple[float, Any, list[Any]]:
    space, bodies = _pymunk_space(scene, restitution, gravity)
    started = time.process_time()
    _take_steps(space, seconds)
    return time.process_time() - started, space, bodies


def _take_steps(space: Any, seconds: float) -> None:
    for _ in range(round(seconds / STEP)):
        space.step(STEP)


def gases(*, quick: bool) -> list[Row]:
    """CPU seconds per simulated second of gases at e = 1, what an impact costs, and the energy that is lost.

    The last one expands: discs on a lattice of 0.3 m, 9 % of whose area they cover, without walls.
    """
    scenes = [
        (f"{100 * filled:.0f} % filled", gas(count, filled), count)
        for count in ((5_000,) if quick else (1_000, 5_000))
        for filled in (0.02, 0.1)
    ]
    rows = []
    for name, scene, count in [*scenes, ("expanding", lattice(70), 4_900)]:
        seconds = 0.5 if quick else 2.0
        ours, discs = _ours(scene, seconds)
        theirs, _, bodies = _pymunk(scene, seconds, 1.0, 0.0)
        before = (scene["velocity"] ** 2).sum()
        kept = (discs.state_at(seconds)[1] ** 2).sum() / before
        pymunk_kept = sum(body.velocity.length**2 for body in bodies[:count]) / before
        rows.append(
            {
                "gas": name,
                "discs": count,
                "impacts_per_s": discs.impacts / seconds,
                "us_per_impact": ours / discs.impacts * 1e6,
                "s_per_s": ours / seconds,
                "pymunk_s_per_s": theirs / seconds,
                "times_faster": theirs / ours,
                "energy_lost": float(1 - kept),
                "pymunk_energy_lost": float(1 - pymunk_kept),
            }
        )
    return rows


def growth(*, quick: bool) -> list[Row]:
    """CPU time of one impact by number of discs, in a gas that covers a tenth of its area."""
    rows = []
    for count in (500, 5_000, 50_000):
        scene = gas(count, 0.1)
        discs = Discs(**scene)
        discs.advance(0.0)
        best = np.inf
        for turn in range(1, 3 if quick else 6):
            before, started = discs.impacts, time.process_time()
            discs.advance(turn * 20_000 / (1.9 * count))
            best = min(best, (time.process_time() - started) / max(discs.impacts - before, 1))
        rows.append({"discs": count, "impacts": discs.impacts, "us_per_impact": best * 1e6})
    for row in rows:
        row["relative_to_log_n"] = (row["us_per_impact"] / rows[0]["us_per_impact"]) / (
            np.log(row["discs"]) / np.log(rows[0]["discs"])
        )
    return rows


def memory() -> list[Row]:
    """Memory (MB) of the process, and what 50 000 discs of a gas add to it on their way."""
    scene = gas(50_000, 0.1)
    before = _resident()
    discs = Discs(**scene)
    discs.advance(0.2)
    return [{"discs": 50_000, "process_MB": before, "discs_MB": _resident() - before}]


def _resident() -> float:
    """Resident memory of this process (MB), as Linux tells it."""
    rows = Path("/proc/self/status").read_text().splitlines()
    return next(int(row.split()[1]) / 1024 for row in rows if row.startswith("VmRSS"))


def piles(*, quick: bool) -> list[Row]:
    """CPU seconds of piles: 2000 discs that lie packed, and discs that fall into a box, until at rest.

    unaccounted: energy that is neither there nor among what impacts and contacts took, of what the fall set free.
    sunk: the deepest overlap, at the end. while_moving: that of the first second, looked at in another run.
    """
    rows = []
    dropped = [("200 dropped", stacked(200, 14), 4)] + (
        [] if quick else [("2000 dropped", stacked(2000, 50), 6)]
    )
    for name, scene, seconds in [("2000 packed", packed(41, 50), 1 if quick else 2), *dropped]:
        movable = scene["inverse_mass"][:, 0] > 0
        ours, discs = _ours(scene, 1, acceleration=DOWN, restitution=0.3)
        theirs, space, bodies = _pymunk(scene, 1, 0.3, GRAVITY)
        started = time.process_time()
        discs.advance(seconds)
        later = time.process_time() - started
        started = time.process_time()
        _take_steps(space, seconds - 1)
        pymunk_later = time.process_time() - started
        moving, pymunk_moving = _sunk_on_the_way(scene)
        rows.append(
            {
                "pile": name,
                "discs": int(movable.sum()),
                "first_s": ours,
                "pymunk_first_s": theirs,
                "seconds_more": seconds - 1,
                "more_s": later,
                "pymunk_more_s": pymunk_later,
                "at_rest": discs.at_rest,
                "unaccounted": _unaccounted(discs, scene, seconds),
                "while_moving_radii": moving,
                "pymunk_while_moving_radii": pymunk_moving,
                "sunk_radii": _sunk(scene["position"] + discs.state_at(seconds)[0], scene),
                "pymunk_sunk_radii": _sunk(_places(bodies), scene),
                "pymunk_fastest_m_s": max(body.velocity.length for body in bodies),
            }
        )
    return rows


def _places(bodies: list[Any]) -> np.ndarray:
    return np.array([tuple(body.position) for body in bodies])


def _sunk_on_the_way(scene: Scene) -> tuple[float, float]:
    """The deepest overlaps in the first second of a pile, looked at 80 times: ours and pymunk's."""
    discs = Discs(**scene, acceleration=DOWN, restitution=0.3)
    space, bodies = _pymunk_space(scene, 0.3, GRAVITY)
    deepest, pymunk_deepest = 0.0, 0.0
    for moment in np.arange(1, 81) * (3 * STEP):
        discs.advance(float(moment))
        _take_steps(space, 3 * STEP)
        deepest = max(deepest, _sunk(scene["position"] + discs.state_at(moment)[0], scene))
        pymunk_deepest = max(pymunk_deepest, _sunk(_places(bodies), scene))
    return deepest, pymunk_deepest


def _unaccounted(discs: Discs, scene: Scene, seconds: float) -> float:
    """The share of what the weights set free that is nowhere; of their fall through a radius at least."""
    movable = scene["inverse_mass"][:, 0] > 0
    mass, radius = 1 / scene["inverse_mass"][movable, 0], scene["radius"][movable]
    displacement, velocity = (part[movable] for part in discs.state_at(seconds))
    free = -GRAVITY * mass @ displacement[:, 1]
    left = free - 0.5 * mass @ (velocity**2).sum(axis=1) - discs.lost_at(seconds)
    return float(abs(left) / max(free, GRAVITY * mass @ radius))


def _sunk(place: np.ndarray, scene: Scene) -> float:
    """The deepest overlap, in the smallest radius."""
    from pinjoint.systems.broad_phase import near_pairs

    pairs = near_pairs(place, scene["radius"])
    pairs = pairs[(scene["inverse_mass"][pairs] > 0).any(axis=(1, 2))]
    line = place[pairs[:, 1]] - place[pairs[:, 0]]
    gap = np.hypot(line[:, 0], line[:, 1]) - scene["radius"][pairs].sum(axis=1)
    return float(max(-gap.min(initial=0.0), 0.0) / scene["radius"].min())


def report(*, quick: bool) -> dict[str, list[Row]]:
    """Everything this benchmark measures, by table."""
    for module in (EVENTS, HORIZONS, PILES):
        module.load()
    _ours(packed(20, 20), 0.2, acceleration=DOWN)  # imports what finds equilibria
    tables: dict[str, Callable[..., list[Row]]] = {"gases": gases, "growth": growth, "piles": piles}
    tables["driven"] = driven
    return {"memory": memory()} | {name: table(quick=quick) for name, table in tables.items()}
