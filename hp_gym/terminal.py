"""Where everything that takes long tells how far it is."""

from typing import Final

from rich.console import Console

progress_console: Final = Console(stderr=True, highlight=False)
"""For progress and remarks; keeps clear of a result that is piped elsewhere."""
