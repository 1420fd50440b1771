"""Sweeps: many variants of one model, computed on all cores or a cluster."""

from pinjoint.sweeps.run import sweep
from pinjoint.sweeps.variation import SweepError

__all__ = ["SweepError", "sweep"]
