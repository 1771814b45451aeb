"""The tables of the environment's documentation are those of the code."""

import ast
import json
import re

from hp_gym import _core
from hp_gym.envs import settings
from hp_gym.envs.env import EVHeatPumpEnv

DOCUMENTATION = EVHeatPumpEnv.__doc__ or ""


def table(section: str) -> list[list[str]]:
    """Rows of the first table of a section, without its head."""
    text = DOCUMENTATION.split(f"## {section}")[1].split("\n    ## ")[0]
    rows = [
        [cell.strip() for cell in line.strip().strip("|").split("|")]
        for line in text.splitlines()
        if "|" in line
    ]
    return rows[2:]


def test_the_action_table_is_that_of_the_actuators() -> None:
    actuators = EVHeatPumpEnv()._episode.action_rows()
    rows = table("Action Space")
    assert [(int(row[0]), row[1]) for row in rows] == list(enumerate(name for name, *_ in actuators))
    for row, (_, _, options, _) in zip(rows, actuators, strict=True):
        levels = "off, 10 levels" if row[1] == "compressor_power" else "11 levels"
        assert row[2] == (", ".join(options) or levels)
    counts = [len(options) or 11 for _, _, options, _ in actuators]
    assert f"MultiDiscrete({str(counts).replace(',', '')})" in DOCUMENTATION


def test_the_observation_table_is_that_of_the_core() -> None:
    rows = [
        (int(num), name, unit, float(low), float(high))
        for num, name, unit, low, high in table("Observation Space")
    ]
    observed = EVHeatPumpEnv()._episode.observation_rows()
    assert rows == [(num, name, unit, low, high) for num, (name, unit, low, high, _) in enumerate(observed)]


def test_every_argument_is_documented() -> None:
    rows = {row[0].strip("`"): row[1].strip("`") for row in table("Arguments")}
    code = EVHeatPumpEnv.__init__.__code__
    own = code.co_varnames[1 : 1 + code.co_argcount - 1 + code.co_kwonlyargcount]
    assert list(rows) == [*own, *settings.NAMES]
    defaults = json.loads(_core.default_settings())
    assert defaults.keys() == {*settings.NAMES, "reward_overrides"}
    for name in settings.NAMES:
        shown = ast.literal_eval(rows[name])
        assert defaults[name] in (shown, [shown]) or (shown is None and not defaults[name]), name


def test_the_page_has_the_sections_of_gymnasium() -> None:
    assert re.findall(r"^    ## (.+)$", DOCUMENTATION, re.MULTILINE) == [
        "Description",
        "Action Space",
        "Observation Space",
        "Rewards",
        "Info",
        "Starting State",
        "Episode End",
        "Arguments",
        "Vectorized environment",
        "Version History",
    ]
