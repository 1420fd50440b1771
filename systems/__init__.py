"""BEHAVIOUR: what happens to entities, one folder per domain."""


def is_ours(module: object) -> bool:
    """True for the name of a module of Pinjoint, wherever that is installed; not for one of a mod."""
    return str(module).startswith(f"{__name__.partition('.')[0]}.")
