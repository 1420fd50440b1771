"""Gestures: what a person draws and drags with the pointer."""

from game.editor.gestures.base import Gesture
from game.editor.gestures.drawing import TOOL_HINTS, TOOLS, Drawing
from game.editor.gestures.moving import Move, MovePoint, PullParticle
from game.editor.gestures.selecting import BoxSelect
from game.editor.gestures.supporting import DrawSupport

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
