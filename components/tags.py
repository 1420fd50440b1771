"""Tags: empty components that mark elements which a person has singled out."""

from __future__ import annotations


class Hovered:
    """A click would hit it."""

    __slots__ = ()


class Selected:
    """A person has selected it."""

    __slots__ = ()


class DiagramShown:
    """Its force diagram is drawn."""

    __slots__ = ()
