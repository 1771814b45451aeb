"""Where everything stands, in design units: the picture is 960 of them wide and 540 high."""

from typing import Final

WIDTH: Final = 960
HEIGHT: Final = 540

HEADER_BASE: Final = 40.0
MARGIN: Final = 16.0

# All of the plant. Where it needs more room, it is drawn smaller.
PLANT_LEFT: Final = 16.0
PLANT_RIGHT: Final = 763.0
PLANT_TOP: Final = 50.0
PLANT_BOTTOM: Final = 425.0

# Refrigerant loop, at the left.
COMPRESSOR_X: Final = 44.0
VALVE_X: Final = 122.0
EXCHANGER_LEFT: Final = 16.0
EXCHANGER_RIGHT: Final = 148.0
EXCHANGER_MARGIN: Final = 12.0
"""How far an exchanger reaches beyond the rails of its loop."""

# Rails: hot loops above the components and cold ones below, further ones beyond the first.
CAPTION_OFFSET: Final = 19.0
"""From a rail to the line of text beyond it."""
SECOND_ROW: Final = 14.0
"""From that line of text to the next."""
FIRST_RAIL: Final = 80.0
"""From the components to the supply of the first loop."""
FURTHER_RAIL: Final = 74.0
"""From a loop's return to the supply of the one beyond it."""
RAIL_DISTANCE: Final = 41.0
"""From a loop's supply to its return."""
RAIL_LEFT_ALONE: Final = 24.0
"""Left end of rails where no refrigerant loop is at the left."""
NUMBERS_WIDTH: Final = 95.0
"""What the temperatures take between the left end of the rails and the first component."""
CENTRE_Y: Final = 231.0
RAIL_WIDTH: Final = 6.0
BRANCH_WIDTH: Final = 4.5
LEG_OFFSET: Final = 26.0
"""From the middle of a component to each of its two pipes."""
RAIL_OVERHANG: Final = 15.0
"""From the last pipe to the end of the rail."""

CHEVRON: Final = 5.0
"""Size of a mark of flow direction."""

MEMBER_HALF_WIDTH: Final = 39.5
MEMBER_TOP: Final = 198.0
MEMBER_BOTTOM: Final = 264.0
SLOT: Final = 84.0
"""From the middle of a component to that of the next, or between its pairs of pipes."""

HEATER_HALF_WIDTH: Final = 22.0
HEATER_HALF_HEIGHT: Final = 15.0
HEATER_MARGIN: Final = 8.0
"""From a heater on a rail to the pipes beside it."""
HEATER_PITCH: Final = 60.0
"""From the middle of a heater on a rail to that of the next."""
BOUNDARY: Final = 24.0
"""Between the components of two loops that stand side by side."""
PLATE_GAP: Final = 36.0
"""At the right of a plate, for the two pipes of the loop that it belongs to."""
PLATE_PIPES: Final = (14.0, 27.0)
"""From a plate's right edge to its pipe from the return and to that to the supply."""
PLATE_PORT: Final = 14.0
"""From the middle of a plate's edge to its pipes."""

# Instruments, at the right.
SIDE_LEFT: Final = 778.0
SIDE_RIGHT: Final = 944.0

# Legend, above the components where nothing else is there, or else in the header.
LEGEND_LEFT: Final = 614.0
LEGEND_RIGHT: Final = 758.0
LEGEND_BOTTOM: Final = 172.0

STRIP_TOP: Final = 428.0
