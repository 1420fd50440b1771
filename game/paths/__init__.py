"""Paths: what `particles.B.force` and the like mean on the command line, in sweeps and in scripts."""
