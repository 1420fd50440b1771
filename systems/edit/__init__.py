"""Editing: picking, placing, moving, joining, selecting, and pulling what moves."""

from pinjoint.components.mistake import Explained


class Refusal(Explained, ValueError):
    """An edit that cannot be made: nothing was changed; the message is a sentence with the reason and the remedy."""
