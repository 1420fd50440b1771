"""Parts of Pinjoint that are written as mods: they only register through `plugin(app)`."""

from game.included import collisions, histories, probes, walls
from game.mods import include

include(histories, "Loads that vary: sine, pulse, table, and base acceleration from a record")
include(probes, "Plots of any quantity while time passes (key O), CSV and PNG")
include(walls, "Walls and floors, off which particles bounce (key W)")
include(collisions, "The number of impacts, and the speeds of a gas beside Rayleigh's curve (key U)")
