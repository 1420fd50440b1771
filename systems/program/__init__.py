"""Step programs: laws, commits and an integrator of one plan, written as one module and compiled.

To understand a step, read `Program.source` of a small model first: it is the whole program as plain Python.
binding.py checks what may join, writer.py and its relatives write the source, compiler.py compiles it or finds it
compiled, program.py binds it to the columns of a model and runs it; reordered.py does so for parts of models,
parallel.py for very large ones, in blocks.
"""
