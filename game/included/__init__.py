"""Parts of Pinjoint that are written as mods: they only register through `plugin(app)`."""

from pinjoint.components.language import marked
from pinjoint.included import collisions, histories, probes, walls
from pinjoint.mods import include

include(histories, marked("Loads that vary: sine, pulse, table, and base acceleration from a record"))
include(probes, marked("Plots of any quantity while time passes (key O), CSV and PNG"))
include(walls, marked("Walls and floors, off which particles bounce (key W)"))
include(collisions, marked("The number of impacts, and the speeds of a gas beside Rayleigh's curve (key U)"))
