"""JSON that every reader takes: a number that JSON does not have becomes null."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def plain(data: Any) -> Any:
    """Returns data as JSON can hold it."""
    if isinstance(data, np.generic | np.ndarray):
        return plain(data.tolist())
    if isinstance(data, float) and not math.isfinite(data):
        return None
    if isinstance(data, Mapping):
        return {str(key): plain(value) for key, value in data.items()}
    if isinstance(data, Sequence) and not isinstance(data, str):
        return [plain(value) for value in data]
    return data


def dumps(data: Any) -> str:
    """Returns data as indented JSON."""
    return json.dumps(plain(data), indent=2, ensure_ascii=False, allow_nan=False)
