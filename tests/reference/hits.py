"""What can be pressed in the pictures of a session, and pressing it, as a person with a mouse does."""

from pinjoint import Session
from pinjoint.components.view import Hit
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme


def hits_in(session: Session) -> list[Hit]:
    """All hits, the topmost last."""
    theme = load_theme(session.view.theme)
    return [hit for shown, view in session.stages for hit in compose(shown, view, theme).hits]


def hits_for(session: Session, action: str) -> list[Hit]:
    """Those of an action."""
    return [hit for hit in hits_in(session) if hit.action == action]


def push(session: Session, action: str, key: str = "click") -> None:
    """Press the topmost hit of an action."""
    session.press(key, hits_for(session, action)[-1].middle)
