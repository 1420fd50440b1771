"""Tags: empty components that mark elements which a person has singled out."""

from __future__ import annotations


class Rare:
    """A tag that few elements carry at a time: esper holds it, and its queries find them."""

    __slots__ = ()


class Hovered(Rare):
    """A click would hit it."""

    __slots__ = ()


class Selected:
    """A person has selected it."""

    __slots__ = ()


class DiagramShown:
    """Its force diagram is drawn."""

    __slots__ = ()
