"""Where the flight of discs keeps its few single numbers, and why it returns."""

from enum import IntEnum

# numbers, float64
NOW = 0  # s; everything up to now has happened
END = 1  # s; of the present window, in which all meetings are foreseen
WINDOW = 2  # s; length of a window
CELL = 3  # m; of the finest layer of the grid
CROWDING = 4  # neighbours found per area of boxes, 1/m²
RESTITUTION = 5
REST_HEIGHT = 6  # of the smaller radius; bounces that would rise less end in contact
NUMBERS = 7

# counts, int64
QUEUED = 0  # meetings in the queue
LAYERS = 1  # of the grid
REPORTED = 2  # impacts in the report
IMPACTS = 3  # so far, every contact of a joint impact counted
STRIKES = 4  # so far, a joint impact counted once
LEVEL = 5  # coarsest level that a disc needed beyond those of the grid
RENEW = 6  # 1: the window must be opened anew before anything else
SPARE = 7  # first unused entry of the table of lasting contacts
SPARES = 8  # how many are unused
COUNTS = 9


class Reason(IntEnum):
    """Why the flight returned."""

    DONE = 0  # arrived
    BUSY = 1  # as many strikes as were allowed
    REPORT_FULL = 2  # take the reported impacts and go on
    QUEUE_FULL = 3  # enlarge the queue and go on
    GRID_FULL = 4  # enlarge the grid and go on
    GROUP_FULL = 5  # enlarge the room for the contacts of a group and for lasting contacts and go on
