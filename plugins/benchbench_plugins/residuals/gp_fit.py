"""Gaussian processes are fitted to the samples of training flights."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Annotated

import numpy as np
from pydantic import Field

from benchbench.flight.controller import PERIOD
from benchbench.flight.reference import matrices
from benchbench.flight.residual import Sample
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench_plugins.residuals.gp_mean import AXES, GpMean

SMOOTH = 5
"""Samples over which labels are averaged: differences of a noisy velocity."""
SETTLING = 25
"""First samples of a flight that are left out, half a second."""
Points = Annotated[int, Field(ge=2)]


def enough(points: int, training: float) -> int:
    """Return the points; raises BadInput where so many s of training give fewer samples."""
    samples = int(training / PERIOD)
    if points > samples:
        problem = f"{points} points of {training:g} s of training, in which there are {samples} samples"
        raise BadInput("residual.points", problem, f"at most {samples}, or a longer residual.training")
    return points


def fit(flights: Sequence[Sequence[Sample]], points: int) -> GpMean:
    """Fit constant x squared exponential (a length per feature) + noise per body axis, by maximum likelihood.

    The mean of all samples is kept in the world: wind does not turn with the vehicle, and the paper's features have no heading.
    Labels are body accelerations of the rest; the means of `points` clusters are kept (k-means over all features).
    Raises BadInput where there are no samples.
    """
    from sklearn.cluster import KMeans
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    steady, features, labels = _data(flights)
    if len(labels) < points:
        raise BadInput(
            "residual", f"{len(labels)} samples were flown for {points} points", "a longer training flight"
        )
    scale = features.std(axis=0) + 1e-6
    found = KMeans(points, n_init=1, random_state=0).fit(features / scale).labels_
    groups = [found == k for k in range(points) if (found == k).any()]
    centres = np.array([features[group].mean(axis=0) for group in groups])
    means = np.array([labels[group].mean(axis=0) for group in groups])
    fitted, offsets = [], means.mean(axis=0)
    for axis in range(AXES):
        own = [0, 1, 2 + axis]
        lengths = RBF(2 * scale[own], np.outer(scale[own], [0.3, 1e3]).tolist())
        kernel = ConstantKernel(0.1, (1e-6, 1e3)) * lengths + WhiteKernel(0.01, (1e-6, 1.0))
        process = GaussianProcessRegressor(kernel, random_state=0)
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore", ConvergenceWarning
            )  # a feature that tells nothing has no longest length
            process.fit(centres[:, own], means[:, axis] - offsets[axis])
        product = process.kernel_.k1
        fitted.append((process.alpha_, product.k2.length_scale, product.k1.constant_value))
    weights, length_scales, sizes = (np.array(part) for part in zip(*fitted, strict=True))
    return GpMean(centres, weights, length_scales, sizes, offsets, steady)


def _data(flights: Sequence[Sequence[Sample]]) -> tuple[Array, Array, Array]:
    """Mean (3,) in the world, features (n, 5), height, arm and body velocity, and labels (n, 3), in the body, of the rest."""
    features, labels = [np.zeros((0, 5))], [np.zeros((0, AXES))]
    window = np.ones(SMOOTH) / SMOOTH
    used = [flight for flight in flights if len(flight) > SETTLING + SMOOTH]
    settled = [sample.acceleration for flight in used for sample in flight[SETTLING:]]
    steady = np.mean(settled, axis=0) if settled else np.zeros(AXES)
    for flight in used:
        state = np.array([sample.state for sample in flight])
        world = np.array([sample.acceleration for sample in flight]) - steady
        back = matrices(state[:, 3:7]).transpose(0, 2, 1)
        body = np.einsum("nij,nj->ni", back, world)
        speed = np.einsum("nij,nj->ni", back, state[:, 8:11])
        smooth = np.stack([np.convolve(column, window, "same") for column in body.T], axis=-1)
        features.append(np.hstack([state[:, [2, 7]], speed])[SETTLING:-SMOOTH])
        labels.append(smooth[SETTLING:-SMOOTH])
    return steady, np.vstack(features), np.vstack(labels)
