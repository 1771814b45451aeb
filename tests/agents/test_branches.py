"""The fast distribution of options agrees with those of stable-baselines3 and sb3-contrib."""

from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from sb3_contrib.common.maskable.distributions import MaskableMultiCategoricalDistribution
from stable_baselines3.common.distributions import MultiCategoricalDistribution

from hp_gym.agents.training.branches import Branches, MaskableBranches

COUNTS = [3, 2, 2, 3, 3, 3, 2, 11]


def rows(seed: int, spread: float, count: int = 16) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Logits, actions that the masks allow, masks."""
    generator = np.random.default_rng(seed)
    logits = generator.normal(scale=spread, size=(count, sum(COUNTS))) + generator.normal(scale=10 * spread)
    masks = generator.random((count, sum(COUNTS))) < 0.6
    actions = np.stack([generator.integers(n, size=count) for n in COUNTS], axis=1)
    starts = np.cumsum([0, *COUNTS[:-1]])
    np.put_along_axis(masks, actions + starts, values=True, axis=1)
    return torch.from_numpy(logits.astype(np.float32)), torch.from_numpy(actions), torch.from_numpy(masks)


def agree(fast: Any, theirs: Any, actions: torch.Tensor, spread: float) -> None:
    tolerance: dict[str, float] = {"rtol": 1e-5, "atol": 1e-5 * max(1.0, spread)}
    torch.testing.assert_close(fast.log_prob(actions), theirs.log_prob(actions), **tolerance)
    torch.testing.assert_close(fast.entropy(), theirs.entropy(), **tolerance)
    assert torch.equal(fast.mode(), theirs.mode())


@settings(max_examples=30)
@given(st.integers(0, 2**31), st.floats(0.01, 20.0))
def test_probabilities_entropy_and_mode_are_those_of_the_library(seed: int, spread: float) -> None:
    logits, actions, masks = rows(seed, spread)
    agree(
        Branches(COUNTS).proba_distribution(logits),
        MultiCategoricalDistribution(COUNTS).proba_distribution(logits),
        actions,
        spread,
    )
    fast = MaskableBranches(COUNTS).proba_distribution(logits)
    theirs = MaskableMultiCategoricalDistribution(COUNTS).proba_distribution(logits)
    agree(fast, theirs, actions, spread)
    fast.apply_masking(masks)
    theirs.apply_masking(masks.numpy())
    agree(fast, theirs, actions, spread)
    fast.apply_masking(None)
    theirs.apply_masking(None)
    agree(fast, theirs, actions, spread)


def test_gradients_are_those_of_the_library() -> None:
    logits, actions, masks = rows(0, 1.0)
    gradients = []
    for kind in (MaskableBranches, MaskableMultiCategoricalDistribution):
        given = logits.clone().requires_grad_()
        distribution = kind(COUNTS).proba_distribution(given)
        distribution.apply_masking(masks.numpy())
        loss = (distribution.log_prob(actions) + 0.3 * distribution.entropy()).sum()
        loss.backward()
        gradients.append(given.grad)
    torch.testing.assert_close(gradients[0], gradients[1], rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("masked", [False, True])
def test_options_are_drawn_as_often_as_they_are_likely(masked: bool) -> None:
    torch.manual_seed(0)
    logits, _, masks = rows(1, 1.0, count=1)
    many = 100_000
    distribution = MaskableBranches(COUNTS).proba_distribution(logits.expand(many, -1))
    if masked:
        distribution.apply_masking(masks.expand(many, -1))
    drawn = distribution.sample()
    theirs = MaskableMultiCategoricalDistribution(COUNTS).proba_distribution(logits)
    theirs.apply_masking(masks.numpy() if masked else None)
    for branch, expected in enumerate(theirs.distributions):
        share = torch.bincount(drawn[:, branch], minlength=COUNTS[branch]) / many
        likely = expected.probs[0]
        # Five standard deviations.
        assert ((share - likely).abs() <= 5.0 * torch.sqrt(likely * (1.0 - likely) / many) + 1e-7).all()
        assert (share[likely == 0.0] == 0.0).all()


def test_a_very_unlikely_option_is_no_infinity() -> None:
    logits = torch.zeros(1, sum(COUNTS))
    logits[0, 3], logits[0, 4] = 300.0, -300.0
    distribution = Branches(COUNTS).proba_distribution(logits)
    actions = torch.zeros(1, len(COUNTS), dtype=torch.int64)
    others = sum(np.log(count) for count in COUNTS) - np.log(COUNTS[1])
    torch.testing.assert_close(distribution.log_prob(actions), torch.tensor([-others], dtype=torch.float32))
    assert torch.isfinite(distribution.entropy()).all()
    actions[0, 1] = 1
    likelihood = distribution.log_prob(actions)
    assert torch.isfinite(likelihood).all()
    assert likelihood < -300.0
