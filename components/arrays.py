"""Arrays by what they hold, as annotations name them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Rows = NDArray[np.intp]  # of a table

ROUND_OFF = float(np.finfo(np.float64).eps)  # relative, of one operation
