"""The picture of a vehicle's thermal plant at one moment, fast enough for video."""

from hp_gym import extras

with extras.needed("plot"):
    from hp_gym.pictures.rendering.renderer import Renderer

__all__ = ["Renderer"]
