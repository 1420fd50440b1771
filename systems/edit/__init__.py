"""Editing: picking, placing, moving, joining, selecting, and pulling what moves."""


class Refusal(ValueError):
    """An edit that cannot be made: nothing was changed; the message is a sentence with the reason and the remedy."""
