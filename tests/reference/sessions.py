"""Sessions for tests, as no person has them."""

import numpy as np

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.documents.document import document
from pinjoint.documents.history.history import History
from pinjoint.documents.history.log import Run
from pinjoint.documents.models import load
from pinjoint.systems.statics.settle import Settlement, settle
from pinjoint.systems.statics.state import Start


def put_states_aside(session: Session, beyond: int) -> None:
    """Let a session that has just begun keep only so many bytes of states in memory, and the others on a shelf."""
    document = session.document
    document.history = History(document.model, document.simulation, document._changed, beyond)


def states_put_aside(session: Session) -> int:
    """How many states of its undo log are on the shelf now."""
    log = session.document.history._done
    return sum(isinstance(log._entries[at], Run) for at in log._places)


def solved_afresh(model: Model, theory: str | None = None) -> Settlement:
    """The way of a model's document, read into another model, from its undeformed beginning. Raises ValueError."""
    fresh = load(document(model))
    start = Start.undeformed(fresh, np.zeros(fresh.rods.count))
    return settle(fresh, fresh.settings.load_steps, theory or fresh.settings.theory, start)
