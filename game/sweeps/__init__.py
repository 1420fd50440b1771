"""Sweeps: many variants of one model, computed on all cores or a cluster."""

from game.sweeps.run import sweep
from game.sweeps.variation import SweepError

__all__ = ["SweepError", "sweep"]
