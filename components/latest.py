"""Latest: what was found last, kept as long as what it follows from stays the same."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")


class Latest(Generic[T]):
    """One thing that takes a while to find."""

    def __init__(self) -> None:
        self.of: object = self  # nothing else equals it

    def get(self, of: object, find: Callable[[], T]) -> T:
        """What there is for what it follows from, such as a revision, found anew where that is another one."""
        if self.of != of:
            self._found, self.of = find(), of
        return self._found
