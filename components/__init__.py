"""DATA: what an entity is. No pygame, no numba, no behaviour.

For scripts and mods:

>>> from components import Model, Particle, Rod
>>> model = Model()
>>> a, b = model.create(Particle, 2, position=[(0.0, 0.0), (3.0, 4.0)])
>>> (rod,) = model.create(Rod, between=[(a.row, b.row)], stiffness=1000.0)
>>> rod.rest_length
5.0
>>> model.particles.position.shape
(2, 2)
"""

from components.commands import Assign, Command, Create, Custom, Delete, Group
from components.component import Component
from components.environment import Environment
from components.field import CM, Field, FieldError, Role, Vector
from components.grid import Grid
from components.handle import Handle
from components.load import HistoryKind, Load
from components.model import Model
from components.obstacles import Pieces
from components.particle import Particle
from components.rod import Rod
from components.settings import Settings
from components.snapshot import Snapshot
from components.table import Table
from components.tags import Selected
from components.view import Plot, Readout
from components.world import Derivation, World

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
