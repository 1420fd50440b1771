"""Gestures: what a person draws and drags with the pointer."""

from game.gestures.base import Gesture
from game.gestures.drawing import TOOL_HINTS, TOOLS, Drawing
from game.gestures.moving import Move, MovePoint, PullParticle
from game.gestures.selecting import BoxSelect
from game.gestures.supporting import DrawSupport

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
