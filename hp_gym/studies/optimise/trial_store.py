"""The trials of a search in an SQLite file, which several processes share; a killed one loses its batch."""

import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias

import optuna
from optuna.storages import RDBStorage
from sqlalchemy import event
from sqlalchemy.exc import SQLAlchemyError

from hp_gym import locks
from hp_gym.messages import InUseError, OneLineError

FILE: Final = "optimise.db"
DEFINITION: Final = "definition"
EXCESSES: Final = "excesses"
"""Attribute of a trial: by how much each constraint is broken."""

REFUSED: Final = "refused"
"""Attribute of a trial: why the plant does not accept its values."""

_NAME: Final = "hp-gym optimise"
_PROCESSES: Final = "processes"
_PATIENCE_S: Final = 30.0


Directions: TypeAlias = Sequence[Literal["minimize", "maximize"]]
"""Of each goal, as Optuna says it."""


class OptimiseError(OneLineError):
    """A search cannot be made as asked for; what was there before is intact."""


def excesses(trial: optuna.trial.FrozenTrial) -> list[float]:
    """By how much a trial breaks each constraint; 0 or less is allowed."""
    found: list[float] = trial.user_attrs[EXCESSES]
    return found


def note_excesses(trial: optuna.Trial, beyond: list[float]) -> None:
    """Notes by how much a trial breaks each constraint, for samplers too."""
    trial.set_user_attr(EXCESSES, beyond)
    if hasattr(trial, "set_constraint"):
        for place, excess in enumerate(beyond):
            trial.set_constraint(f"constraint {place}", excess)


def constraints_argument() -> dict[str, Any]:
    """Returns what samplers of an Optuna older than 5 are told about constraints."""
    return {} if hasattr(optuna.Trial, "set_constraint") else {"constraints_func": excesses}


def join(folder: Path, definition: Mapping[str, Any], directions: Directions) -> tuple[optuna.Study, int]:
    """Opens the search of a folder, or begins it.

    Returns:
        The search, and the number of this process among all that ever worked on it, from 0.

    Raises:
        OptimiseError: The folder holds another search, or a file that is none.
        OSError: The folder cannot be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    deadline_s = time.monotonic() + _PATIENCE_S
    while True:
        try:
            # Held for a moment only: from here on SQLite keeps the processes apart.
            with locks.lock(folder / FILE):
                return _joined(folder, definition, directions)
        except InUseError:
            if time.monotonic() > deadline_s:
                raise
            time.sleep(0.05)


def _joined(folder: Path, definition: Mapping[str, Any], directions: Directions) -> tuple[optuna.Study, int]:
    study = _open(folder, directions)
    wanted = json.loads(json.dumps(definition))
    there = study.user_attrs.get(DEFINITION)
    if there is None:
        study.set_user_attr(DEFINITION, wanted)
    elif there != wanted:
        key = next(key for key in wanted if there.get(key) != wanted[key])
        old, new = (json.dumps(each.get(key), ensure_ascii=False)[:150] for each in (there, wanted))
        raise OptimiseError(
            f"{folder}: holds another search: its `{key}` is {old}, here it is {new}; choose another folder"
        )
    number = int(study.user_attrs.get(_PROCESSES, 0))
    study.set_user_attr(_PROCESSES, number + 1)
    return study, number


def _open(folder: Path, directions: Directions) -> optuna.Study:
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    try:
        storage = RDBStorage(
            f"sqlite:///{(folder / FILE).resolve()}", engine_kwargs={"connect_args": {"timeout": 60}}
        )
        event.listen(storage.engine, "connect", _quick)
        storage.engine.dispose()
        names = [study.study_name for study in optuna.get_all_study_summaries(storage)]
        if _NAME in names:
            return optuna.load_study(study_name=_NAME, storage=storage)
        return optuna.create_study(study_name=_NAME, storage=storage, directions=directions)
    except (SQLAlchemyError, RuntimeError) as error:
        raise OptimiseError(f"{folder / FILE}: is no search of hp-gym optimise ({error})") from error


def _quick(connection: Any, _record: object) -> None:
    """Lets a trial survive a killed process, not a power cut: a search writes ten times a trial."""
    cursor = connection.cursor()
    cursor.execute("PRAGMA journal_mode=WAL")
    cursor.execute("PRAGMA synchronous=NORMAL")
    cursor.close()


def load(folder: Path) -> optuna.Study:
    """Opens the search of a folder to look at it.

    Raises:
        OptimiseError: There is none.
    """
    if not (folder / FILE).is_file():
        raise OptimiseError(f"{folder}: there is no search in this folder")
    return _open(folder, ["minimize"])
