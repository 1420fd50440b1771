"""Plastic hinges of single rods: the law in step programs against the energy's own answer by trying all cases."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from pinjoint.components.derived import on_axis
from pinjoint.components.model import Model
from pinjoint.documents.document import parse
from pinjoint.systems.plasticity.hinges import slips
from pinjoint.systems.program.writer import FEW, MANY
from pinjoint.systems.statics.bending import at_limits, flows, yielding
from tests.reference.models import model as document
from tests.systems.program.test_frames import program_of

NEAR_BUCKLING = -9.0  # N L₀²/EI, beyond which no more is compared


def apart(lot: np.random.Generator, steep: float, count: int = 400) -> dict[str, Any]:
    """Rods of their own, with rigid, sprung and hinged ends, held in random states in which these may slip."""
    particles, rods = [], []
    for number in range(count):
        length, bending = lot.uniform(1.0, 4.0), 10 ** lot.uniform(0.0, 2.0)
        moment = bending / length * 10 ** lot.uniform(-2.0, 0.0)
        moved = length * lot.normal(0.0, 0.01)
        for end in (0, 1):
            held = {"fixed": [True, True], "fixed_rotation": True, "rotation": float(lot.normal(0.0, steep))}
            place = {"position": [end * length, 10.0 * number], "displacement": [end * moved, 0.0]}
            particles.append({"name": f"{'AB'[end]}{number}", **held, **place})
        stiffness = 10 ** lot.uniform(2.0, 5.0)
        joints = lot.choice(3, 2, p=(0.6, 0.2, 0.2))
        rods.append(
            {
                "name": f"R{number}",
                "between": [f"A{number}", f"B{number}"],
                "stiffness": stiffness,
                "bending_stiffness": bending,
                "plastic_moment": moment,
                "hinged": (joints == 1).tolist(),
                "end_springs": np.where(joints == 2, bending * lot.uniform(0.5, 9.0), 0.0).tolist(),
                "tensile_strength": stiffness * 10 ** lot.uniform(-3.0, 0.0),
                "compressive_strength": stiffness * 10 ** lot.uniform(-3.0, 0.0),
                "distributed_force": [0.0, float(lot.normal(0.0, 3.0 * moment / length**2))],
                "temperature_gradient": float(lot.normal(0.0, 1000.0)),
            }
        )
    return document(particles, rods, settings={"collisions": False})


class Rod:
    """The energy of one rod of a model, by its columns."""

    def __init__(self, model: Model, row: int) -> None:
        rods = model.rods
        (start, mixed, end), (bow, both, other) = rods.end_stiffness[row], rods.bowing[row]
        self.stiffness, self.bowing = (
            np.array([[start, mixed], [mixed, end]]),
            np.array([[bow, both], [both, other]]),
        )
        self.axial, self.length, self.bending = (
            rods.stiffness[row],
            rods.rest_length[row],
            rods.bending_stiffness[row],
        )
        self.limit, self.warped = rods.moment_limit[row], rods.initial_slopes[row]
        self.strength = -rods.compression_limit[row], rods.tension_limit[row]
        self.load = -on_axis(rods.span_load[row : row + 1], np.array([[1.0, 0.0]]))[1][0]
        particles = model.particles
        self.slopes = particles.rotation[rods.between[row]] * (rods.turning_shares[row] > 0.0)
        self.elongation = particles.displacement[rods.between[row, 1], 0]

    def force(self, slopes: np.ndarray) -> float:
        strain = self.elongation / self.length + 0.5 * slopes @ self.bowing @ slopes
        return float(np.clip(self.axial * strain, *self.strength))

    def moments(self, slopes: np.ndarray, force: float) -> np.ndarray:
        bent = self.stiffness @ (slopes - self.warped) + self.load
        return np.asarray(bent + force * self.length * self.bowing @ slopes)

    def least_energy(self) -> np.ndarray | None:
        """Slips by trying all nine ways in which ends may slip; the axial force of each is a root by bisection."""
        found = []
        for signs in itertools.product((0.0, 1.0, -1.0), repeat=2):
            flows = np.array(signs) != 0.0
            if (flows & ~np.isfinite(self.limit)).any():
                continue
            bound = np.where(flows, np.where(flows, self.limit, 0.0) * signs, 0.0)

            def slipping(force: float, flows: Any = flows, bound: Any = bound) -> np.ndarray:
                elastic = self.stiffness + force * self.length * self.bowing
                over, slip = self.moments(self.slopes, force) - bound, np.zeros(2)
                slip[flows] = np.linalg.solve(elastic[np.ix_(flows, flows)], over[flows])
                return slip

            def miss(force: float, slipping: Any = slipping) -> float:
                return force - self.force(self.slopes - slipping(force))

            low, high = NEAR_BUCKLING * self.bending / self.length**2, self.axial
            if miss(low) >= 0.0:
                continue
            slip = slipping(brentq(miss, low, high, xtol=1e-300, rtol=1e-15))
            moments = self.moments(self.slopes - slip, self.force(self.slopes - slip))
            if (slip * signs >= 0.0).all() and (np.abs(moments) <= self.limit * (1.0 + 1e-9)).all():
                found.append(slip)
        if not found:
            return None
        assert np.ptp(found, axis=0).max() <= 1e-8, "there is one answer"
        return found[0]


@pytest.mark.parametrize("form", [FEW, MANY])
@pytest.mark.parametrize("steep", [0.3, 0.02, 0.002])
def test_slips_are_those_of_least_energy(steep: float, form: str) -> None:
    session, program = program_of(parse(apart(np.random.default_rng(3), steep)), form=form)
    model, compared, yielded = session.model, 0, 0
    program.observe()
    rods = model.rods
    assert (np.abs(rods.end_moment) <= rods.moment_limit).all(), "to the last bit"
    program.commit()
    for row in range(rods.count):
        rod, slip = Rod(model, row), rods.plastic_rotation[row]
        wanted, force = rod.least_energy(), rods.axial_force[row]
        if wanted is None or force * rod.length**2 / rod.bending < NEAR_BUCKLING:
            continue
        compared, yielded = compared + 1, yielded + bool(wanted.any())
        strain = abs(rod.elongation / rod.length) + np.square(rod.slopes).sum()
        noise = 1e-15 * rod.axial * strain  # of the axial force
        of_slips = noise * rod.length * np.abs(rod.bowing @ rod.slopes).max()
        firmness = max(np.diag(rod.stiffness).max(), 1e-300)
        assert slip == pytest.approx(wanted, rel=1e-11, abs=1e-13 * steep + 100.0 * of_slips / firmness)
        assert force == pytest.approx(rod.force(rod.slopes - slip), rel=1e-12, abs=100.0 * noise)
    assert compared > 0.5 * rods.count
    assert yielded > 0.15 * rods.count


def test_ends_that_tie_share_what_slips_and_no_rounding_confuses_them() -> None:
    stiffness, bowing = (4.0, 2.0, 4.0), (4.0 / 30.0, -1.0 / 30.0, 4.0 / 30.0)
    for over in (1e-16, 1e-15, 1e-12, 1e-3):
        start, end = slips(6.0 * (1.0 + over), 6.0 * (1.0 + over), 6.0, 6.0, 0.0, stiffness, bowing)
        assert (start, end) == pytest.approx((over, over), abs=3e-16)
    assert slips(6.0, -6.0, 6.0, 6.0, 0.0, stiffness, bowing) == (0.0, 0.0)
    assert slips(8.0, 0.0, 6.0, math.inf, 0.0, stiffness, bowing) == (0.5, 0.0)


def test_statics_and_motion_have_one_law_of_two_ends() -> None:
    """The vectorised law of statics tells of random states, ties among them, what the kernel of motion does."""
    lot, count = np.random.default_rng(3), 3000
    bending, thrust = 10 ** lot.uniform(0.0, 2.0, count), lot.uniform(-8.0, 8.0, count)
    three = bending[:, None] * ([4.0, 2.0, 4.0] + thrust[:, None] * [4.0 / 30.0, -1.0 / 30.0, 4.0 / 30.0])
    moment, limit = 2.0 * lot.normal(size=(count, 2)), 0.1 + np.abs(lot.normal(size=(count, 2)))
    near = lot.choice([1.0 - 1e-16, 1.0, 1.0 + 2e-16, 1.0 + 1e-12, 2.0], (len(limit[::5]), 2))
    moment[::5] = np.sign(moment[::5]) * limit[::5] * near
    limit[1::7, 1], limit[::7, 1] = limit[1::7, 0], np.inf
    moment[1::7, 1] = moment[1::7, 0] * lot.choice([1.0, -1.0], len(moment[1::7]))
    pairs = three[:, [0, 1, 1, 2]].reshape(-1, 2, 2)
    sense = yielding(pairs, moment, limit)
    turned = flows(pairs, moment - at_limits(sense, limit), sense != 0.0)
    given = zip(moment.tolist(), limit.tolist(), three.tolist(), strict=True)
    wanted = np.array([slips(*m, *most, 0.0, stiffness, (0.0, 0.0, 0.0)) for m, most, stiffness in given])
    assert (wanted != 0.0).any(axis=1).sum() > 0.5 * count
    assert np.abs(bending[:, None] * (turned - wanted)).max() <= 1e-14
