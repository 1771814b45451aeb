"""Distribution of independent options, computed for all branches at once.

Stable-baselines3 keeps one distribution a branch: for eight branches of a few options that is a third of
a training's time. Sums over the options of a branch are products with constant matrices here, so that every
operation works on the whole row. Values are those of stable-baselines3 but for rounding.
"""

from collections.abc import Sequence
from typing import Any, Self

import numpy as np

from hp_gym import extras

with extras.needed("train"):
    import torch
    from sb3_contrib.common.maskable.distributions import MaskableMultiCategoricalDistribution
    from stable_baselines3.common.base_class import BaseAlgorithm
    from stable_baselines3.common.distributions import MultiCategoricalDistribution

# The exponential of more has no place in single precision.
_LARGEST_EXPONENT = 80.0


def install(model: BaseAlgorithm) -> None:
    """Lets a model with several discrete actions use these distributions; its files stay as they were."""
    policy: Any = model.policy
    given = getattr(policy, "action_dist", None)
    if isinstance(given, MaskableMultiCategoricalDistribution):
        policy.action_dist = MaskableBranches(given.action_dims)
    elif isinstance(given, MultiCategoricalDistribution):
        policy.action_dist = Branches(given.action_dims)


class _Rows:
    """Logits of all branches, one row a sample.

    Args:
        counts: Number of options of each branch.
    """

    def __init__(self, counts: Sequence[int]) -> None:
        member = np.repeat(np.arange(len(counts)), counts)
        same = member[:, None] == member[None, :]
        earlier = np.arange(len(member))[:, None] <= np.arange(len(member))[None, :]
        self.counts = list(counts)
        self._of_branch = _matrix(member[:, None] == np.arange(len(counts))[None, :])
        self._cumulative = _matrix(same & earlier)
        self._starts = torch.from_numpy(np.concatenate([[0], np.cumsum(counts)[:-1]]))
        self._last = self._starts + torch.tensor(self.counts) - 1
        self._sizes = torch.tensor(self.counts, dtype=torch.float32)
        self.log_probabilities = torch.empty(0)
        self.probabilities = torch.empty(0)

    def set(self, logits: torch.Tensor, masks: torch.Tensor | None = None) -> None:
        """Takes logits; options that are masked get no probability."""
        to_options = self._of_branch.T
        if masks is None:
            mean = logits @ self._of_branch / self._sizes
            centred = (logits - mean @ to_options).clamp(max=_LARGEST_EXPONENT)
            weights = torch.exp(centred)
        else:
            allowed = masks.to(logits.dtype)
            logits = logits * allowed
            mean = (logits @ self._of_branch) / (allowed @ self._of_branch)
            centred = (logits - mean @ to_options).clamp(max=_LARGEST_EXPONENT)
            weights = torch.exp(centred) * allowed
        totals = (weights @ self._of_branch) @ to_options
        self.probabilities = weights / totals
        self.log_probabilities = centred - torch.log(totals)

    def log_prob(self, actions: torch.Tensor) -> torch.Tensor:
        """Logarithm of the probability of actions (n, branches)."""
        places = actions.long() + self._starts
        return self.log_probabilities.gather(1, places).sum(dim=1)

    def entropy(self) -> torch.Tensor:
        """Entropy, the sum over branches."""
        return -(self.probabilities * self.log_probabilities).sum(dim=1)

    def sample(self) -> torch.Tensor:
        """Draws an option of each branch: the first whose cumulated probability passes a random number."""
        cumulated = self.probabilities @ self._cumulative
        # Measured by the branch's own sum, so that rounding never reaches an option without probability.
        drawn = torch.rand(len(cumulated), len(self.counts)) * cumulated[:, self._last]
        passed = (cumulated <= drawn @ self._of_branch.T).to(cumulated.dtype)
        return (passed @ self._of_branch).long()

    def mode(self) -> torch.Tensor:
        """The likeliest option of each branch."""
        branches = torch.split(self.probabilities, self.counts, dim=1)
        return torch.stack([branch.argmax(dim=1) for branch in branches], dim=1)


def _matrix(values: Any) -> torch.Tensor:
    return torch.from_numpy(values.astype(np.float32))


class Branches(MultiCategoricalDistribution):
    """`MultiCategoricalDistribution`, faster."""

    def __init__(self, action_dims: list[int]) -> None:
        super().__init__(action_dims)
        self._rows = _Rows(action_dims)

    def proba_distribution(self, action_logits: torch.Tensor) -> Self:
        """Takes the logits of all branches."""
        self._rows.set(action_logits)
        return self

    def log_prob(self, actions: torch.Tensor) -> torch.Tensor:
        """Returns the logarithm of the probability of actions."""
        return self._rows.log_prob(actions)

    def entropy(self) -> torch.Tensor:
        """Returns the entropy."""
        return self._rows.entropy()

    def sample(self) -> torch.Tensor:
        """Draws actions."""
        return self._rows.sample()

    def mode(self) -> torch.Tensor:
        """Returns the likeliest actions."""
        return self._rows.mode()


class MaskableBranches(MaskableMultiCategoricalDistribution):
    """`MaskableMultiCategoricalDistribution`, faster."""

    def __init__(self, action_dims: list[int]) -> None:
        super().__init__(action_dims)
        self._rows = _Rows(action_dims)
        self._logits = torch.empty(0)

    def proba_distribution(self, action_logits: torch.Tensor) -> Self:
        """Takes the logits of all branches."""
        self._logits = action_logits.view(-1, sum(self.action_dims))
        self._rows.set(self._logits)
        return self

    def apply_masking(self, masks: Any) -> None:
        """Takes masks, one row a sample; None for no masks."""
        if masks is None:
            self._rows.set(self._logits)
            return
        self._rows.set(self._logits, torch.as_tensor(masks).view(self._logits.shape))

    def log_prob(self, actions: torch.Tensor) -> torch.Tensor:
        """Returns the logarithm of the probability of actions."""
        return self._rows.log_prob(actions.view(-1, len(self.action_dims)))

    def entropy(self) -> torch.Tensor:
        """Returns the entropy."""
        return self._rows.entropy()

    def sample(self) -> torch.Tensor:
        """Draws actions."""
        return self._rows.sample()

    def mode(self) -> torch.Tensor:
        """Returns the likeliest actions."""
        return self._rows.mode()
