"""Names and values in sentences: short, on one line, without characters that do not print."""

from typing import Any

import pytest

from pinjoint import Session
from pinjoint.components.field import FieldError
from pinjoint.components.particle import Particle
from pinjoint.components.wording import cut, missing, nearest, printable, quoted


def test_what_does_not_print_is_written_out() -> None:
    assert (
        printable("a\x1b[31m\n\x00\x85\u2028\u202e\ud800b") == "a\\x1b[31m\\n\\x00\\x85\\u2028\\u202e\\ud800b"
    )
    assert printable("é क्षि 👩\u200d🔬 Ångström") == "é क्षि 👩\u200d🔬 Ångström"


def test_long_names_are_cut() -> None:
    assert cut("x" * 60) == "x" * 60
    assert cut("x" * 61) == "x" * 59 + "…"


def nested(depth: int) -> Any:
    value: Any = []
    for _ in range(depth):
        value = [value]
    return value


@pytest.mark.parametrize(
    "value",
    ["x" * 10_000, list(range(10_000)), nested(900), 10**5000, nested(50_000)],
    ids=["text", "list", "nested", "number", "deep"],
)
def test_values_are_cut(value: Any) -> None:
    assert len(quoted(value)) < 200


def test_messages_name_elements_so() -> None:
    session = Session.open("isostatic")
    (particle,) = session.model.create(Particle, 1, name=["\x1b[31mred\n" + "x" * 1000])
    with pytest.raises(FieldError) as caught:
        particle.radius = -1.0
    assert len(str(caught.value)) < 200
    assert str(caught.value).startswith("particle \\x1b[31mred\\nxx")
    with pytest.raises(FieldError) as caught:
        particle.force = nested(900)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(
    ("name", "names", "said"),
    [
        ("raduis", ["mass", "radius"], "did you mean 'radius'?"),
        ("b", ["A", "B"], "did you mean 'B'?"),  # capitals do not count
        ("Q", ["A", "B"], "choose one of A, B."),
        ("Q", [f"node {n}" for n in range(51)], "there are 51 to choose from."),
        ("Q", [], "there are none."),
    ],
)
def test_what_is_meant_is_told(name: str, names: list[str], said: str) -> None:
    assert missing("things", name, names) == f"There is no '{name}' among the things; {said}"


def test_nothing_near_is_nothing() -> None:
    assert nearest("Q", ["A"]) is None
    assert nearest("rotation_fixed", ["rotation", "fixed_rotation"]) == "fixed_rotation"
