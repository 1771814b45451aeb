"""The reference policies that come with the package."""

from importlib.resources import files
from pathlib import Path
from typing import Final

from agents.policies.errors import PolicyError

FOLDER: Final = Path(str(files("agents") / "reference_policies"))
"""Where they are, in a checkout as in an installed package."""


def names() -> list[str]:
    """Returns the names of the reference policies, each of which has a file a seed."""
    return sorted({path.name.rsplit("-seed", 1)[0] for path in FOLDER.glob("*-seed*.safetensors")})


def paths(name: str = "ppo") -> list[Path]:
    """Returns the files of a reference policy, in the order of their seeds.

    Raises:
        PolicyError: There is none of this name.
    """
    found = [path for path in FOLDER.glob("*-seed*.safetensors") if path.name.rsplit("-seed", 1)[0] == name]
    if not found:
        message = f"no reference policy `{name}`; available: {', '.join(names()) or 'none'}"
        raise PolicyError(message)
    return sorted(found, key=_seed)


def _seed(path: Path) -> tuple[int, str]:
    number = path.stem.rsplit("-seed", 1)[1]
    return (int(number) if number.isdigit() else -1, number)
