"""Discs jammed between walls: they come to rest, however a run is divided, and what they lose stays lost."""

from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.systems.collision.kernels.pile import DEPTH
from pinjoint.systems.run.notes import overlap_warning
from pinjoint.systems.run.simulation import Simulation

JAMS = Path(__file__).parent / "jams"


def opened(name: str) -> Simulation:
    return Session.open(str(JAMS / f"{name}.json")).simulation


@pytest.mark.parametrize("name", ["seven_under_drag", "eight_under_drag"])
def test_discs_jammed_under_drag_come_to_rest_alike_in_twenty_runs_and_in_one(name: str) -> None:
    """Their speeds stayed at 10⁻¹¹ m/s, and whether many were a crowd hung on when pairs had been listed."""
    once, often = opened(name), opened(name)
    once.run_to(20.0)
    for second in range(20):
        often.run_to(second + 1.0)
    assert once.message == often.message
    assert once.message.startswith("At rest since t = ")
    for column in ("displacement", "velocity"):
        assert np.array_equal(getattr(once.model.particles, column), getattr(often.model.particles, column))


def test_advice_to_discs_speaks_of_no_rods() -> None:
    run = opened("seven_under_drag")
    assert not run.run_until_rest(0.1)
    assert run.message.endswith("Raise the limit, or the drag.")


def test_what_a_jam_of_unequal_masses_loses_stays_lost() -> None:
    """Its dissipation fell by up to 113 J in 2 ms, in steps that energy came from, and the account balanced."""
    run, before, least = opened("unequal_masses"), 0.0, 0.0
    for moment in np.arange(0.002, 0.8, 0.002):
        run.run_to(float(moment))
        energy = run.energy
        assert energy.dissipated_impact >= before
        before, least = energy.dissipated_impact, min(least, energy.imbalance)
    assert least < 0.0
    again = opened("unequal_masses")
    again.run_to(float(moment))
    assert again.energy == energy


def test_overlaps_that_a_pile_did_not_keep_are_told() -> None:
    """Up to 15 % of a radius, of masses from 10⁻³ to 10³ kg; what piles keep is not worth a word."""
    run = opened("unequal_masses")
    run.run_to(0.5)
    assert "were in one another by up to" in run.said
    assert overlap_warning(DEPTH) == ""


def test_energy_that_a_jam_takes_from_what_was_lost_before_is_told() -> None:
    """Steps of this pile of light and heavy discs created a fifth of all that was supplied, without a word."""
    run = opened("energy_from_losses")
    run.run_to(0.49)
    energy = run.energy
    assert energy.imbalance < -0.2 * energy.work
    assert "The time steps created 2" in run.said
    once = opened("unequal_masses")
    once.run_to(0.5)
    assert "created" not in once.said  # less than a tenth
