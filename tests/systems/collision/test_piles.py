"""Steps of piles: whatever jams, they supply no energy."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from pinjoint.components.obstacles import Obstacles
from pinjoint.systems.collision.columns import Count, Number, Reason
from pinjoint.systems.collision.free.discs import EVENTS, HORIZONS, PILES, Discs
from pinjoint.systems.collision.kernels.pile import begin_steps
from tests.reference.scenes_of_discs import GRAVITY

RADIUS = 0.05


def jammed(seed: int, count: int, fit: int, restitution: float) -> tuple[Discs, np.ndarray]:
    """Discs of very different masses (kg) in a box as wide as `fit` of them, thrown together; and their masses."""
    random = np.random.default_rng(seed)
    half, columns = RADIUS * fit, max(int(2 * RADIUS * fit / 0.115), 1)
    k = np.arange(count)
    place = np.column_stack([-half + 0.0525 + 0.11 * (k % columns), 0.06 + 0.13 * (k // columns)])
    mass, velocity = random.choice([1.0, 1.0, 1.0, 10.0, 0.1], count), random.normal(size=(count, 2))
    start = np.array([[-half, 0.0], [-half, 0.0], [half, 0.0]])
    end = np.array([[half, 0.0], [-half, 9.0], [half, 9.0]])
    box = Obstacles(start, end - start, np.zeros(3), np.full(3, restitution), ["floor", "left", "right"])
    discs = Discs(
        place,
        velocity,
        np.full(count, RADIUS),
        np.column_stack([1 / mass, 1 / mass]),
        acceleration=[0.0, -GRAVITY],
        restitution=restitution,
        obstacles=box,
    )
    return discs, mass


def energy(discs: Discs, mass: np.ndarray, time: float) -> float:
    """Of motion and of weight, J; 0 where everything would begin at rest."""
    displacement, velocity = discs.state_at(time)
    return float(0.5 * mass @ (velocity**2).sum(axis=1) + GRAVITY * mass @ displacement[:, 1])


@example(seed=22, count=13, fit=3, restitution=0.9)
@example(seed=391763, count=36, fit=4, restitution=0.5)  # forces of a jam that hardly any sweeps find
@settings(max_examples=60)
@given(st.integers(0, 10**6), st.integers(4, 40), st.integers(2, 6), st.sampled_from([0.0, 0.2, 0.5, 0.9, 1.0]))
def test_no_step_supplies_energy_to_what_jams(seed: int, count: int, fit: int, restitution: float) -> None:
    """Every step is one of a pile here, from the first on. What sinks in a little is lifted out again by the next steps."""
    for module in (EVENTS, HORIZONS, PILES):
        module.load()
    discs, mass = jammed(seed, count, fit, restitution)
    discs.advance(0.0)
    first = energy(discs, mass, 0.0)
    before = [first]
    reason = Reason.BUSY
    while reason is not Reason.DONE and not discs.at_rest:
        if not discs.counts[Count.STEPPING]:
            begin_steps(discs.numbers, discs.counts)
        reason, _ = discs.advance(1.0, 1)
        stepping = bool(discs.counts[Count.STEPPING])
        now = energy(discs, mass, float(discs.numbers[Number.STEP_END]) if stepping else discs.now)
        assert now <= max(before[-4:]) + 1e-3 * (abs(first) + abs(now))
        assert now <= first + 1e-3 * RADIUS * GRAVITY * mass.sum()
        before.append(now)
