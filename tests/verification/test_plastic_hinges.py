"""Plastic hinges in statics: against calculation from event to event, and closed forms of collapse and shakedown."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint.documents import models
from pinjoint.systems.statics.settle import Settlement, settle
from tests.reference.models import model
from tests.reference.plastic_hinges import Frame
from tests.verification.test_frame_theory import free, held

Document = dict[str, Any]
SEEDS = st.integers(0, 2**31)


def hinged_frame(seed: int) -> Document:
    """A frame of storeys and bays that yields at its ends, with loads on joints, inside beams and along members."""
    lot = np.random.default_rng(seed)
    bays, storeys = int(lot.integers(1, 3)), int(lot.integers(1, 3))
    particles: list[Document] = []
    rods: list[Document] = []
    same = {"stiffness": 1e6, "bending_stiffness": 1e4, "plastic_moment": 100.0}

    def join(first: str, second: str, weight: float = 0.0) -> None:
        facts = dict(same)
        if alike > 0.3:
            facts["bending_stiffness"] = float(10.0 ** lot.uniform(3.5, 4.5))
            facts["plastic_moment"] = float(lot.uniform(60.0, 150.0))
        if lot.random() < 0.1:
            facts["hinged"] = [bool(lot.random() < 0.5), False]
        facts["distributed_force"] = [0.0, -weight]
        rods.append({"name": f"{first}-{second}", "between": [first, second], **facts})

    alike = lot.random()
    for floor in range(storeys + 1):
        for bay in range(bays + 1):
            name, x, y = f"P{floor}{bay}", 6.0 * bay, 4.0 * floor
            if floor == 0:
                particles.append(held(name, x, y, fixed_rotation=bool(lot.random() < 0.7) or bay == 0))
                continue
            push = [float(lot.uniform(5.0, 20.0)) if bay == 0 else 0.0, float(lot.uniform(-40.0, 0.0))]
            particles.append(free(name, x, y, force=push))
            if lot.random() < 0.1:
                particles[-1]["moment"] = float(lot.normal(0.0, 20.0))
            join(f"P{floor - 1}{bay}", name)
    for floor in range(1, storeys + 1):
        for bay in range(bays):
            middle, weight = f"M{floor}{bay}", float(lot.uniform(0.0, 8.0) * (lot.random() < 0.4))
            push = [0.0, -float(lot.uniform(10.0, 60.0))]
            particles.append(
                free(middle, 6.0 * bay + float(lot.choice([2.0, 3.0, 3.7])), 4.0 * floor, force=push)
            )
            join(f"P{floor}{bay}", middle, weight)
            join(middle, f"P{floor}{bay + 1}", weight)
    return model(particles, rods)


def events(found: Settlement, kind: str) -> list[Any]:
    return [event for event in found.events if event.kind == kind]


def same_hinges(found: Settlement, frame: Frame, within: float) -> None:
    """The same joints at the same load factors, in order; those that form at once in any."""
    told = [(event.load_factor, event.place["particle"]) for event in events(found, "hinge")]
    wanted = frame.hinges
    assert len(told) >= len(wanted), (told, wanted)
    assert [f for f, _ in told[: len(wanted)]] == pytest.approx([f for f, _ in wanted], rel=within)
    for factor, name in wanted:
        assert any(n == name and f == pytest.approx(factor, rel=within) for f, n in told), (name, told, wanted)


@settings(max_examples=12, deadline=None)
@given(seed=SEEDS)
def test_frames_up_to_collapse_from_event_to_event(seed: int) -> None:
    document = hinged_frame(seed)
    frame = Frame(document)
    assert not frame.to(1e4)
    found = settle(models.load(document), 1e4, "first-order")
    assert found.status == "collapse"
    (collapse,) = events(found, "collapse")
    assert collapse.load_factor == pytest.approx(frame.factor, rel=1e-9)
    same_hinges(found, frame, 1e-9)


@settings(max_examples=12, deadline=None)
@given(seed=SEEDS, share=st.floats(0.5, 1.05))
def test_load_steps_leave_the_residual_moments_of_theory(seed: int, share: float) -> None:
    document = hinged_frame(seed)
    whole = Frame(document)
    whole.to(1e4)
    factors = [share * whole.factor, 0.0, -0.6 * whole.factor, 0.2 * whole.factor, 0.0]
    found, frame = settle(models.load(document), factors, "first-order"), Frame(document)
    for state, factor in zip(found.states, factors, strict=False):
        stands = frame.to(factor)
        assert state.status == ("equilibrium" if stands else "collapse")
        assert state.load_factor == pytest.approx(frame.factor, rel=1e-9)
        size = np.abs(frame.moment).max(initial=1.0)
        assert np.abs(state.diagrams["bending_moment"] - frame.moment).max() <= 1e-9 * size
