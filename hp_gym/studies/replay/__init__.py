"""Measured trips driven by the model, and what both came to."""
