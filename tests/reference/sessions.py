"""Sessions for tests, as no person has them."""

from pinjoint import Session
from pinjoint.documents.history.history import History
from pinjoint.documents.history.log import Run


def put_states_aside(session: Session, beyond: int) -> None:
    """Let a session that has just begun keep only so many bytes of states in memory, and the others on a shelf."""
    document = session.document
    document.history = History(document.model, document.simulation, document._changed, beyond)


def states_put_aside(session: Session) -> int:
    """How many states of its undo log are on the shelf now."""
    log = session.document.history._done
    return sum(isinstance(log._entries[at], Run) for at in log._places)
