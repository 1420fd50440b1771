"""Step programs: the laws, the commits and the integrator of one plan, written as one module and compiled.

To understand a step, read `Program.source` of a small model first: it is the whole program as plain Python.

>>> from pinjoint import Session
>>> print(Session.open("isostatic").simulation.program.source)  # doctest: +SKIP

README.md in this folder says how it is made, file by file.
"""
