"""Pictures: a run over time, and the plant at one moment."""
