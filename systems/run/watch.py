"""Watch: keeps the state of a run from time to time, so that an interrupt leaves one between two steps."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from pinjoint.systems.run.checkpoint import Checkpoint
from pinjoint.systems.run.simulation import Simulation

KEPT_EVERY = 0.5  # s; as much of a run an interrupt loses
WORK_AT_ONCE = 2**22  # steps × elements, after which a run looks up


@contextmanager
def watched(simulation: Simulation) -> Iterator[None]:
    """Where a run inside the `with` is interrupted, it goes back to the last state that was kept.

    The present one may be in the midst of a step, or ahead of the clock.
    """
    model, kept, when = simulation.model, list[Checkpoint](), 0.0

    def look() -> int:
        nonlocal when
        if not kept or time.monotonic() - when > KEPT_EVERY:
            kept[:], when = [simulation.checkpoint()], time.monotonic()
        return max(WORK_AT_ONCE // (model.particles.count + model.rods.count + 1), 1)

    simulation.before_steps.append(look)
    try:
        yield
    except Exception:  # such as a mod's, which comes between two steps
        raise
    except BaseException:
        if kept:
            simulation.resume(kept[0])
        raise
    finally:
        simulation.before_steps.remove(look)
