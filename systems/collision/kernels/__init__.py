"""How the kernels of this package are compiled: as parts of the programs that call them.

References to arrays are not counted: kernels are given many arrays at once and allocate none, so that counting
would only double the time of an impact.
"""

from pinjoint.systems.program.kernel import part

compiled = part(_nrt=False)
