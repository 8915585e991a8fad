"""What every residual model must do: learn from samples alone, never make it worse, give the gradient of what it predicts."""

from __future__ import annotations

import numpy as np

from benchbench.conformance.checks.require import require
from benchbench.flight.reference import matrices
from benchbench.flight.residual import NODE, Correction, Residual, Sample
from benchbench.flight.world import Truth
from benchbench.ground.arrays import Array

RATE = 50
"""Samples a second."""
FLAT = np.array([0.5, -0.3, 0.8])
"""m/s^2, a residual acceleration that is the same everywhere."""


def check_flat(residual: Residual) -> None:
    """Of a constant residual it predicts at least nothing, and what it predicts is no worse than nothing."""
    nodes, arm = _nodes(20)
    predicted, _ = _flown(residual, FLAT).predict(nodes, arm)
    require(
        predicted.shape == (20, 3) and bool(np.isfinite(predicted).all()), "it predicts no (n, 3) numbers"
    )
    off = float(np.linalg.norm(predicted - FLAT, axis=1).max())
    nothing = float(np.linalg.norm(FLAT))
    require(off <= 1.01 * nothing, f"it is {off:.3g} m/s^2 off, predicting nothing is {nothing:.3g} off")
    require(off < 0.3 * nothing or not predicted.any(), f"after a constant {FLAT} m/s^2 it is {off:.3g} off")


def check_gradient(residual: Residual) -> None:
    """The gradient is that of the prediction, by central differences; none means it does not depend on the state."""
    correction = _flown(residual, None)
    nodes, arm = _nodes(6)
    _, gradient = correction.predict(nodes, arm)
    step = 3e-5  # the mean is a sum of large numbers: rounding of 1e-10 over a smaller step would be seen
    for k in range(NODE):
        there, back = nodes.copy(), nodes.copy()
        there[:, k] += step
        back[:, k] -= step
        found = (correction.predict(there, arm)[0] - correction.predict(back, arm)[0]) / (2 * step)
        said = np.zeros_like(found) if gradient is None else gradient[:, :, k]
        gap = float(np.abs(found - said).max())
        require(
            gap < 1e-4 * (1 + float(np.abs(found).max())),
            f"the gradient by number {k} of the state is {gap:.3g} off",
        )


def check_only_samples(residual: Residual) -> None:
    """Equal samples give equal predictions, whatever is true beside them: nothing is read that is not sensed."""
    nodes, arm = _nodes(5)
    found = []
    for truth in (1.0, -1.0):
        beside = [Truth(0.02 * k, np.full(15, truth), np.full(6, truth), False, "") for k in range(50)]
        found.append(_flown(residual, FLAT, 40).predict(nodes, arm)[0])
        del beside
    require(np.allclose(found[0], found[1], atol=1e-9), "its predictions depend on more than the samples")


def check_fresh(residual: Residual) -> None:
    """What one flight observes is not known to the next."""
    learned = residual.learn(_training(residual, FLAT))
    nodes, arm = _nodes(3)
    before = learned().predict(nodes, arm)[0]
    first = learned()
    for sample in _samples(-3 * FLAT, 100, 9):
        first.observe(sample)
    after = learned().predict(nodes, arm)[0]
    require(np.allclose(before, after, atol=1e-12), "a flight knows what the one before it observed")


CHECKS = (check_flat, check_gradient, check_only_samples, check_fresh)


def _flown(residual: Residual, push: Array | None, count: int = 3 * RATE) -> Correction:
    """A correction after its training flights, and some seconds in the air."""
    correction = residual.learn(_training(residual, push))()
    for sample in _samples(push, count, 1):
        correction.observe(sample)
    return correction


def _training(residual: Residual, push: Array | None) -> list[list[Sample]]:
    count = round(residual.training * RATE)
    return [_samples(push, count, 2)] if count else []


def _samples(push: Array | None, count: int, seed: int) -> list[Sample]:
    """Samples along a way; push: (3,) in the world, None for drag along the body's axes that grows with the arm's angle."""
    nodes, arm = _nodes(count, seed)
    turn = matrices(nodes[:, 3:7])
    speed = np.einsum("nji,nj->ni", turn, nodes[:, 7:])
    own = np.einsum("nij,nj->ni", turn, -0.4 * speed * arm[:, None] + 0.2 * np.sin(3 * nodes[:, 2:3]))
    accelerations = own if push is None else np.tile(push, (count, 1))
    states = np.zeros((count, 15))
    states[:, :7], states[:, 7], states[:, 8:11] = nodes[:, :7], arm, nodes[:, 7:]
    return [Sample(k / RATE, s, a) for k, (s, a) in enumerate(zip(states, accelerations, strict=True))]


def _nodes(count: int, seed: int = 0) -> tuple[Array, Array]:
    """States (n, 10) and arm angles (n,) along a smooth way, nearly level."""
    time, draw = np.arange(count) / RATE, np.random.default_rng(seed)
    waves = [np.sin(draw.uniform(1, 3) * time + draw.uniform(0, 6)) for _ in range(9)]
    nodes = np.zeros((count, NODE))
    nodes[:, :3] = np.stack(waves[:3], axis=-1) * [1.0, 1.0, 0.3] + [0.0, 0.0, 1.0]
    half = 0.08 * np.stack(waves[3:6], axis=-1)
    nodes[:, 3], nodes[:, 4:7] = 1.0, half
    nodes[:, 3:7] /= np.linalg.norm(nodes[:, 3:7], axis=1, keepdims=True)
    nodes[:, 7:] = np.stack(waves[6:9], axis=-1)
    return nodes, 1.5 + 0.4 * np.sin(2.3 * time)
