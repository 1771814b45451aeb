"""Settings shared by all tests."""

import os

from hypothesis import settings

# No test opens a window.
os.environ["MPLBACKEND"] = "Agg"

# A busy machine must not fail a test, and a red run must be red again when repeated.
settings.register_profile("hp_gym", deadline=None, derandomize=True)
settings.load_profile("hp_gym")
