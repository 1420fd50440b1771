"""Animation: a run as a GIF, at the pace at which a window shows it."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from pinjoint.components.snapshot import Snapshot
from pinjoint.components.view import drawn_places
from pinjoint.documents.models import replace
from pinjoint.session import Session
from pinjoint.systems.render.labels.placing import Placed

FRAME = 0.05  # s for which each picture is shown; viewers of GIFs slow down quicker ones
LONGEST = 12.0  # s shown; a longer run to a time is shown faster, one until rest in part and at its end
HELD = 1.5  # s for which the last picture stays
COLOURS = 128


def render_gif(
    session: Session, path: str, size: tuple[int, int], theme: str, *, until: float | None, limit: float
) -> str:
    """Run to a time (s; None: until at rest) and write the pictures of the run as a GIF; returns the status.

    Raises OSError if the file cannot be written.
    """
    from PIL import Image

    from pinjoint.pictures import frame

    status, moments = _run(session, until, limit)
    session.exaggerate()
    places = []
    for moment in moments:
        moment.restore(session.model)
        places.append(drawn_places(session.model))
    around, images = np.concatenate(places), []
    placed: Placed = {}
    for moment in moments:
        moment.restore(session.model)
        image = Image.fromarray(frame(session, size, theme, around, placed))
        images.append(image.quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE))
    durations = [round(1000 * FRAME)] * (len(images) - 1) + [round(1000 * HELD)]
    made = io.BytesIO()
    images[0].save(made, "GIF", save_all=True, append_images=images[1:], duration=durations, loop=0)
    replace(path, made.getvalue())
    return status


def _run(session: Session, until: float | None, limit: float) -> tuple[str, list[Snapshot]]:
    """The status at the end of the run, and the states of the pictures."""
    moments = [Snapshot.take(session.model)]
    status = "time reached"
    for begin, end in pairwise(_times(session, until, limit)):
        status = session.run(time=end - begin)
        moments.append(Snapshot.take(session.model))
        if status != "time reached":
            return status, moments
    if until is None:  # the rest of a run that takes longer than is shown
        status = session.run(until="rest", limit=limit)
        moments.append(Snapshot.take(session.model))
    return status, moments


def _times(session: Session, until: float | None, limit: float) -> Iterator[float]:
    """The simulated times of the pictures (s)."""
    begin, most = session.time, math.floor(LONGEST / FRAME)
    step = FRAME * session.pace
    if until is None:
        count = min(most, math.ceil(limit / step))
    else:
        count = max(min(most, math.ceil((until - begin) / step)), 1)
        step = (until - begin) / count
    yield from (begin + number * step for number in range(count + 1))
