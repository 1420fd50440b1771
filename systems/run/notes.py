"""Notes: what a person is told of a run that goes on, or has come to rest."""

from __future__ import annotations

from pinjoint.components import written
from pinjoint.components.language import marked, plural, tr
from pinjoint.systems.program.entries import SMALLEST_ENERGY

TOLD_OVERLAP = 2e-3  # of a radius; smaller: tells of piles of like discs, too, whose steps leave up to 1.3e-3
_TOLD_SHARE = 0.1  # of all energy ever supplied; smaller: warns of lattices by automatic steps of Verlet


def energy_warning(imbalance: float, scale: float) -> str:
    """The sentence that steps lost (positive) or created this energy (J); "" if it is a small part of all supplied."""
    if not abs(imbalance) > _TOLD_SHARE * scale + SMALLEST_ENERGY:
        return ""
    share = abs(imbalance) / max(scale, SMALLEST_ENERGY)
    lost = marked(
        "The time steps lost {share} of the supplied energy: the errors of the results may be as large."
    )
    made = marked(
        "The time steps created {share} of the supplied energy: the errors of the results may be as large."
    )
    if share >= 10.0:
        lost = marked(
            "The time steps lost {times} times the supplied energy: the errors of the results may be as large."
        )
        made = marked(
            "The time steps created {times} times the supplied energy: the errors of the results may be as large."
        )
    said = lost if imbalance > 0.0 else made
    return tr(said, share=written.share(share), times=written.number(share, 3))


def overlap_warning(deepest: float) -> str:
    """The sentence that discs of a pile were in one another by this share of a radius; "" where that is common."""
    if deepest <= TOLD_OVERLAP:
        return ""
    return tr(
        "Discs of a pile were in one another by up to {share} of a radius: its places and energies are off accordingly.",
        share=written.share(deepest),
    )


def contact_warning(steps: int, most: float) -> str:
    """The sentence that so many steps left contacts open, or discs in one another, by a share of a radius; "" if none."""
    if not steps:
        return ""
    return plural(
        "In one step no forces were found that close all contacts: they were left open, or discs in one another, by up to"
        " {share} of a radius.",
        "In {count} steps no forces were found that close all contacts: they were left open, or discs in one another, by up"
        " to {share} of a radius.",
        steps,
        share=written.share(most),
    )


def reflection_warning(impacts: int) -> str:
    """The sentence that so many joint impacts had more reflections than are followed; "" if none."""
    if not impacts:
        return ""
    return plural(
        "One joint impact had more reflections than can be followed: the rest of it was taken as plastic.",
        "{count} joint impacts had more reflections than can be followed: the rest of them was taken as plastic.",
        impacts,
    )


def at_rest_since(time: float) -> str:
    """The message of a model that came to rest at this time (s)."""
    return tr("At rest since t = {time}.", time=written.time(time))
