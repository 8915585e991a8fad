"""The mean of fitted Gaussian processes and its gradient, in NumPy at all predicted nodes at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from benchbench.flight.reference import matrices
from benchbench.flight.residual import Correction, Sample
from benchbench.ground.arrays import Array
from benchbench_plugins.residuals.filtered import Filtered

AXES = 3


@dataclass(frozen=True)
class GpMean:
    """Mean of one process per body axis i over (height, arm angle, body velocity i).

    centres (m, 5) height, arm, body velocity; weights (3, m); lengths (3, 3) of the features; sizes (3,); offsets (3,) m/s^2;
    steady (3,) m/s^2, the same in the world wherever the nose points
    """

    centres: Array
    weights: Array
    lengths: Array
    sizes: Array
    offsets: Array
    steady: Array

    def at(self, features: Array) -> tuple[Array, Array]:
        """Mean (n, 3) m/s^2 at features (n, 5), and its gradient (n, 3, 3) with respect to each axis' own features."""
        own = np.stack([features[:, [0, 1, 2 + axis]] for axis in range(AXES)])
        theirs = np.stack([self.centres[:, [0, 1, 2 + axis]] for axis in range(AXES)])
        apart = (own[:, :, None] - theirs[:, None]) / self.lengths[:, None, None]
        kernel = self.sizes[:, None, None] * np.exp(-0.5 * np.einsum("anmf,anmf->anm", apart, apart))
        weighted = kernel * self.weights[:, None]
        mean = weighted.sum(axis=-1) + self.offsets[:, None]
        slope = -np.einsum("anm,anmf->anf", weighted, apart) / self.lengths[:, None]
        return mean.T, slope.transpose(1, 0, 2)


@final
class GpCorrection(Correction):
    """What the processes predict, and what a filter has seen beside them."""

    def __init__(self, mean: GpMean, rest: Filtered) -> None:
        """Keep both."""
        self.mean, self.rest = mean, rest

    def observe(self, sample: Sample) -> None:
        """Give the filter what the processes do not explain."""
        node = np.concatenate([sample.state[:7], sample.state[8:11]])[None]
        turn = matrices(node[:, 3:7])
        expected, _ = self.mean.at(_features(node, sample.state[7:8], turn))
        left = sample.acceleration - self.mean.steady - turn[0] @ expected[0]
        self.rest.observe(Sample(sample.time, sample.state, left))

    def predict(self, nodes: Array, arm: Array) -> tuple[Array, Array | None]:
        """World mean + R(q) mu(z, arm, R(q)^T v), with all of its derivatives by z, q and v."""
        turn = matrices(nodes[:, 3:7])
        mean, slope = self.mean.at(_features(nodes, arm, turn))
        steep = turn * slope[:, None, :, 2]  # R diag(d mu / d v_B)
        gradient = np.zeros((len(nodes), AXES, nodes.shape[1]))
        gradient[:, :, 2] = np.einsum("nij,nj->ni", turn, slope[:, :, 0])
        gradient[:, :, 7:] = steep @ turn.transpose(0, 2, 1)
        by_turn = _turn_derivative(nodes[:, 3:7])
        gradient[:, :, 3:7] = np.einsum("nijk,nj->nik", by_turn, mean)
        gradient[:, :, 3:7] += np.einsum("nij,nmjk,nm->nik", steep, by_turn, nodes[:, 7:])
        return np.einsum("nij,nj->ni", turn, mean) + self.mean.steady + self.rest.value, gradient


def _features(nodes: Array, arm: Array, turn: Array) -> Array:
    speed = np.einsum("nji,nj->ni", turn, nodes[:, 7:])
    return np.concatenate([nodes[:, 2:3], arm[:, None], speed], axis=1)


def _turn_derivative(q: Array) -> Array:
    """Return d R / d q, (n, 3, 3, 4), of `matrices`."""
    w, x, y, z = 2 * q.T
    o = np.zeros_like(w)
    by_w = [[o, -z, y], [z, o, -x], [-y, x, o]]
    by_x = [[o, y, z], [y, -2 * x, -w], [z, w, -2 * x]]
    by_y = [[-2 * y, x, w], [x, o, z], [-w, z, -2 * y]]
    by_z = [[-2 * z, -w, x], [w, -2 * z, y], [x, y, o]]
    return np.moveaxis(np.array([by_w, by_x, by_y, by_z]), (0, 3), (3, 0))
