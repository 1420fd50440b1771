"""Editing: picking, placing, moving, joining, selecting, and pulling what moves."""

from collections.abc import Iterator
from contextlib import contextmanager

from pinjoint.components.mistake import Mistake


class Refusal(Mistake, ValueError):
    """An edit that cannot be made: nothing was changed; the message is a sentence with the reason and the remedy."""


@contextmanager
def saving() -> Iterator[None]:
    """Turn an OSError of writing into the working folder into a Refusal."""
    try:
        yield
    except OSError as error:
        raise Refusal(
            "Nothing was saved: {file}: {reason}. Start Pinjoint in a folder where you may write.",
            file=error.filename,
            reason=error.strerror,
        ) from None
