"""Names that are not there, and what is said of them."""

import pytest

from pinjoint.components.suggestions import missing, nearest


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
