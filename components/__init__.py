"""DATA: what an entity is. No pygame, no numba, no behaviour.

For scripts and mods:

>>> from pinjoint.components import Model, Particle, Rod
>>> model = Model()
>>> a, b = model.create(Particle, 2, position=[(0.0, 0.0), (3.0, 4.0)])
>>> (rod,) = model.create(Rod, between=[(a.row, b.row)], stiffness=1000.0)
>>> rod.rest_length
5.0
>>> model.particles.position.shape
(2, 2)
"""

from pinjoint.components.additions import Component
from pinjoint.components.commands import Assign, Command, Create, Custom, Delete, Group
from pinjoint.components.field import CM, Field, FieldError, Role, Vector
from pinjoint.components.grid import Grid
from pinjoint.components.handle import Handle
from pinjoint.components.load import HistoryKind, Load
from pinjoint.components.model import Model
from pinjoint.components.obstacles import Pieces
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.settings import Environment, Settings
from pinjoint.components.snapshot import Snapshot
from pinjoint.components.table import Table
from pinjoint.components.tags import Selected
from pinjoint.components.view import Plot, Readout
from pinjoint.components.world import Derivation, World

__all__ = [
    "CM",
    "Assign",
    "Command",
    "Component",
    "Create",
    "Custom",
    "Delete",
    "Derivation",
    "Environment",
    "Field",
    "FieldError",
    "Grid",
    "Group",
    "Handle",
    "HistoryKind",
    "Load",
    "Model",
    "Particle",
    "Pieces",
    "Plot",
    "Readout",
    "Rod",
    "Role",
    "Selected",
    "Settings",
    "Snapshot",
    "Table",
    "Vector",
    "World",
]
