"""Sessions to edit."""

import pytest

from pinjoint import Session
from tests.systems.edit.hand import EMPTY, opened, press_at


@pytest.fixture
def empty() -> Session:
    return Session.open(EMPTY)


@pytest.fixture
def triangle() -> Session:
    """At the default zoom, 100 px for 1 m, and with displacements as they are."""
    return opened()


@pytest.fixture
def two(empty: Session) -> Session:
    press_at(empty, "p", 0.0, 0.0)
    press_at(empty, "p", 1.5, 0.0)
    return empty
