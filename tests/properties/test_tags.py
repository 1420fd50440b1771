"""Tags against brute force, through deletion and undo."""

import random

from pinjoint.components.handle import Handle
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.tags import DiagramShown, Hovered, Selected


def test_tags_of_a_model_agree_with_brute_force_through_deletion_and_undo() -> None:
    chance = random.Random(7)
    tags = (Selected, DiagramShown, Hovered)
    for _ in range(200):
        model = Model()
        log: list[object] = []
        particles = model.create(Particle, chance.randint(3, 12))
        model.on_command = log.append
        marks: dict[type, set[Handle]] = {tag: set() for tag in tags}
        for _ in range(20):
            particle, tag = chance.choice(particles), chance.choice(tags)
            if chance.random() < 0.2:
                model.delete([particle])
            elif log and chance.random() < 0.3:
                model.apply(log.pop())  # type: ignore[arg-type]
            elif particle in marks[tag] and chance.random() < 0.5:
                marks[tag] = {other for other in marks[tag] - {particle} if other.exists}
                model.tag_only(marks[tag], tag)
            elif particle.exists:
                marks[tag] = {other for other in {*marks[tag], particle} if other.exists}
                model.tag_only(marks[tag], tag)
            for tag in tags:
                assert model.tagged(tag) == [p for p in particles if p.exists and p in marks[tag]]


def test_only_one_element_at_a_time_is_under_the_pointer() -> None:
    model = Model()
    first, second = model.create(Particle, 2)
    model.tag_only([first], Hovered)
    revision = model.tags_revision
    model.tag_only([second], Hovered)
    assert model.tagged(Hovered) == [second]
    assert model.tags_revision > revision
