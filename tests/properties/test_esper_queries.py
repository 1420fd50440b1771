"""esper's queries against brute force.

Versions 3.5 to 3.8 raise KeyError in some queries of three types, if the rarest type is named late: about
8 in 100 small random worlds. Few examples miss it, so thousands are made, and every order is asked for.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator

import esper
import pytest

from components.handle import Handle
from components.model import Model
from components.particle import Particle
from components.tags import DiagramShown, Hovered, Selected


class A:
    pass


class B:
    pass


class C:
    pass


QUERIES = [query for size in (1, 2, 3) for query in itertools.permutations((A, B, C), size)]


@pytest.fixture
def context() -> Iterator[None]:
    """An esper context of its own, gone afterwards."""
    esper.switch_world("queries")
    yield
    esper.clear_database()
    esper.switch_world("default")
    esper.delete_world("queries")


def agree(world: dict[int, dict[type, object]]) -> None:
    """Every query answers what looking at every entity answers; order is none of its promises."""
    for query in QUERIES:
        expected = {
            entity: tuple(components[kind] for kind in query)
            for entity, components in world.items()
            if all(kind in components for kind in query)
        }
        answer = esper.get_components(*query)
        assert len(answer) == len(expected)
        assert dict(answer) == expected
        if len(query) == 1:
            single = esper.get_component(query[0])
            assert {entity: (component,) for entity, component in single} == expected


def test_queries_of_three_types_agree_with_brute_force(context: None) -> None:
    chance = random.Random(20150923)
    for _ in range(5000):
        esper.clear_database()
        world: dict[int, dict[type, object]] = {}
        for _ in range(chance.randint(3, 12)):
            components: dict[type, object] = {t: t() for t in (A, B, C) if chance.random() < 0.5}
            world[esper.create_entity(*components.values())] = components
        agree(world)


def test_queries_agree_after_every_change(context: None) -> None:
    chance = random.Random(3)
    for _ in range(100):
        esper.clear_database()
        world: dict[int, dict[type, object]] = {}
        for _ in range(25):
            entity = chance.choice([*world, 0])
            kind = chance.choice((A, B, C))
            if entity == 0:
                component = kind()
                world[esper.create_entity(component)] = {kind: component}
            elif kind in world[entity]:
                assert esper.remove_component(entity, kind) is world[entity].pop(kind)
            else:
                world[entity][kind] = kind()
                esper.add_component(entity, world[entity][kind])
            agree(world)


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
                model.untag(particle, tag)
                marks[tag].discard(particle)
            elif particle.exists:
                model.tag(particle, tag)
                marks[tag].add(particle)
            for tag in tags:
                assert model.tagged(tag) == [p for p in particles if p.exists and p in marks[tag]]
            for pair in itertools.permutations(tags, 2):
                model.activate()
                found = {handle for _, (handle, *_) in esper.get_components(Particle, *pair)}
                assert found == {p for p in particles if p.exists and all(p in marks[t] for t in pair)}
