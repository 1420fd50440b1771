"""Step programs: laws, commits and a driver of one model, written as one module and compiled.

binding.py checks what may join, writer.py and its relatives write the source, cache.py compiles it or finds it
compiled, program.py binds it to the columns of a model and runs it; arranged.py does so for parts of models, and
in_blocks.py for very large ones.
"""
