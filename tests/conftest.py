"""Settings shared by all tests."""

import os

import pytest
from hypothesis import settings

# No test opens a window.
os.environ["MPLBACKEND"] = "Agg"

# A busy machine must not fail a test, and a red run must be red again when repeated.
settings.register_profile("hp_gym", deadline=None, derandomize=True)
settings.load_profile("hp_gym")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds what asks for more than a change needs."""
    parser.addoption("--long-examples", action="store_true", help="run the examples that take ten seconds")
    parser.addoption(
        "--all-climates",
        action="store_true",
        help="drive the cars of examples/cars at -20 to 40 degC in steps of 5 K instead of at five of them",
    )
