"""Proof that an exported policy decides as the policy it comes from."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from hp_gym import extras
from hp_gym.agents.policies.errors import PolicyError
from hp_gym.agents.policies.saved_policy import SavedPolicy
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

with extras.needed("export"):
    import onnx

TOLERANCE: Final = 1e-5
"""Largest difference of network outputs that single precision explains."""

_ENVIRONMENTS: Final = 16
_STEPS: Final = 800

Decide = Callable[[NDArray[np.float32], NDArray[np.bool_] | None], NDArray[Any]]


@dataclass(frozen=True)
class Recording:
    """Observations and, for options, masks of driven trips, one row each."""

    observations: NDArray[np.float32]
    masks: NDArray[np.bool_] | None


@dataclass(frozen=True)
class Equality:
    """What the comparison found.

    Attributes:
        observations: Number of observations compared.
        trips: Number of trips that they come from.
        largest_output_difference: Of the network's outputs, anywhere.
        differing_actions: Actions that differ; each is a tie of two options within `TOLERANCE`.
    """

    observations: int
    trips: int
    largest_output_difference: float
    differing_actions: int


def record(policy: SavedPolicy, seed: int = 0) -> tuple[Recording, int]:
    """Drives trips of the training distribution, half of them by the policy and half at random.

    Returns:
        What was observed, and the number of trips.
    """
    envs = EVHeatPumpVectorEnv(_ENVIRONMENTS, autoreset_mode=AutoresetMode.SAME_STEP, **policy.environment)
    envs.action_space.seed(seed)
    observations, _ = envs.reset(seed=seed)
    seen, granted, trips = [], [], _ENVIRONMENTS
    options = bool(policy.metadata.option_counts)
    for _ in range(_STEPS):
        masks = envs.action_masks() if options else None
        seen.append(observations)
        if masks is not None:
            granted.append(masks)
        actions = policy.predict(observations, masks)
        actions[::2] = envs.action_space.sample()[::2]
        observations, _, terminated, truncated, _ = envs.step(actions)
        trips += int((terminated | truncated).sum())
    envs.close()
    return Recording(np.concatenate(seen), np.concatenate(granted) if options else None), trips


def compare(model: onnx.ModelProto, policy: SavedPolicy, original: Decide | None = None) -> Equality:
    """Runs an exported graph and the policy on recorded observations.

    Args:
        model: The graph.
        policy: What it was made of.
        original: The model that the policy was converted from, compared as well.

    Raises:
        PolicyError: They differ by more than rounding.
    """
    with extras.needed("export"):
        import onnxruntime

    recording, trips = record(policy)
    session = onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])
    fed: dict[str, NDArray[Any]] = {"observations": recording.observations}
    if policy.needs_masks and recording.masks is not None:
        fed["masks"] = recording.masks
    actions, outputs = session.run(["actions", "outputs"], fed)
    expected = policy.outputs(recording.observations)
    # Outputs of a well-trained network are of the order of ten.
    scale = max(1.0, float(np.abs(expected).max()))
    largest = float(np.abs(outputs - expected).max())
    if not largest <= TOLERANCE * scale:
        message = f"the exported network differs by {largest:.3g}, more than rounding explains"
        raise PolicyError(message)
    differing = 0
    masks = recording.masks if policy.needs_masks else None
    references = [policy.predict(recording.observations, recording.masks)]
    if original is not None:
        references.append(original(recording.observations, masks))
    for reference in references:
        if not policy.metadata.option_counts:
            _require_close(actions, reference)
        else:
            differing += _count_ties(actions, reference, policy, expected, TOLERANCE * scale)
    return Equality(len(actions), trips, largest, differing)


def _require_close(actions: NDArray[Any], reference: NDArray[Any]) -> None:
    largest = float(np.abs(actions - reference).max())
    if not largest <= TOLERANCE:
        message = f"exported actions differ by {largest:.3g}, more than rounding explains"
        raise PolicyError(message)


def _count_ties(
    actions: NDArray[Any],
    reference: NDArray[Any],
    policy: SavedPolicy,
    outputs: NDArray[np.float32],
    margin: float,
) -> int:
    starts = np.concatenate([[0], np.cumsum(policy.metadata.option_counts)[:-1]])
    rows, branches = np.nonzero(actions != reference)
    first = outputs[rows, starts[branches] + actions[rows, branches]]
    second = outputs[rows, starts[branches] + reference[rows, branches]]
    wrong = int((np.abs(first - second) > margin).sum())
    if wrong:
        message = f"{wrong} of {actions.size} exported actions differ"
        raise PolicyError(message)
    return len(rows)
