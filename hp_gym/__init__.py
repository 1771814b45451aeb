"""An electric vehicle's heat pump and thermal system as a Gymnasium environment."""

from hp_gym._core import __version__

__all__ = ["__version__"]
