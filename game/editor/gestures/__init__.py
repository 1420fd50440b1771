"""Gestures: what a person draws and drags with the pointer."""

from game.editor.context import Gesture
from game.editor.gestures.drawing import TOOL_HINTS, TOOLS, Drawing, DrawSupport
from game.editor.gestures.moving import BoxSelect, Move, MovePoint, PullParticle

__all__ = [
    "TOOLS",
    "TOOL_HINTS",
    "BoxSelect",
    "DrawSupport",
    "Drawing",
    "Gesture",
    "Move",
    "MovePoint",
    "PullParticle",
]
