"""A window for pictures."""

import numpy as np
from numpy.typing import NDArray

from hp_gym import extras


class Window:
    """Shows one picture after another with matplotlib; without a display it shows nothing."""

    def __init__(self) -> None:
        with extras.needed("plot"):
            import matplotlib.pyplot as plt

        self._figure = plt.figure("EVHeatPump-v0", frameon=False, figsize=(9.6, 5.4))
        self._axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self._axes.set_axis_off()
        # Only canvases of a graphical toolkit need its event loop.
        self._visible = self._figure.canvas.required_interactive_framework not in {None, "headless"}
        if self._visible:
            self._figure.show()

    def show(self, picture: NDArray[np.uint8]) -> None:
        """Shows a picture."""
        if self._axes.images:
            self._axes.images[0].set_data(picture)
        else:
            self._axes.imshow(picture)
        if self._visible:
            self._figure.canvas.draw_idle()
            self._figure.canvas.flush_events()

    def close(self) -> None:
        """Closes the window."""
        import matplotlib.pyplot as plt

        plt.close(self._figure)
