"""The reference policies, which are compiled into the package (agents/reference_policies)."""

from typing import Final

from hp_gym import _core
from hp_gym.agents.policies import policy_file
from hp_gym.agents.policies.errors import PolicyError
from hp_gym.agents.policies.saved_policy import SavedPolicy

_ABLATIONS: Final = "ablations/"


def names() -> list[str]:
    """Returns the names of the reference policies, each of which has a file a seed."""
    return sorted({file.rsplit("-seed", 1)[0] for file in _files()})


def policies(name: str = "ppo") -> dict[str, SavedPolicy]:
    """Returns the policies of a name by their file's name without ending, in the order of their seeds.

    Raises:
        PolicyError: There is none of this name, or one does not fit this version of hp_gym.
    """
    found = [file for file in _files() if file.rsplit("-seed", 1)[0] == name]
    if not found:
        message = f"no reference policy `{name}`; available: {', '.join(names()) or 'none'}"
        raise PolicyError(message)
    return {file: _policy(file) for file in sorted(found, key=_seed)}


def ablations() -> dict[str, SavedPolicy]:
    """Returns the policies that were trained with one thing changed, by their file's name without ending.

    Raises:
        PolicyError: One does not fit this version of hp_gym.
    """
    files = [file for file in _core.reference_policy_names() if file.startswith(_ABLATIONS)]
    return {file.removeprefix(_ABLATIONS): _policy(file) for file in files}


def _files() -> list[str]:
    return [file for file in _core.reference_policy_names() if "/" not in file and "-seed" in file]


def _policy(file: str) -> SavedPolicy:
    return policy_file.parse(f"reference policy {file}", _core.reference_policy(file))


def _seed(file: str) -> tuple[int, str]:
    number = file.rsplit("-seed", 1)[1]
    return (int(number) if number.isdigit() else -1, number)
