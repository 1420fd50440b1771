"""Mistake: what a person can put right."""


class Mistake(Exception):
    """An error whose sentence is for the person: where the mistake is, what it is, and the remedy.

    The command line says it as it is; anything else that is raised is a fault of the program.
    """
