"""Refusal: something a person asked for that cannot be done."""

from __future__ import annotations


class Refusal(ValueError):
    """Nothing was changed; the message is a sentence with the reason and the remedy."""
