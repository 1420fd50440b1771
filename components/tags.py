"""Tags: empty components that mark the few entities a person has singled out."""

from __future__ import annotations


class Selected:
    """A person has selected it."""

    __slots__ = ()


class DiagramShown:
    """Its force diagram is drawn."""

    __slots__ = ()


class Hovered:
    """A click would hit it."""

    __slots__ = ()
