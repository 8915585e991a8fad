"""Every installed dynamics on every installed model against `checks.dynamics` and `checks.orders`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.dynamics import CHECKS
from benchbench.conformance.checks.orders import check_consistency, check_order, check_phases, energy_errors
from benchbench.ocp.model import Model
from benchbench.ocp.touching import TouchingModel
from benchbench.transcription.dynamics import Dynamics

Record = Callable[[str, object], None]
DYNAMICS = pytest.mark.parametrize("candidate", candidates("dynamics"), ids=lambda c: c.name)
MODELS = pytest.mark.parametrize("model", candidates("models"), ids=lambda c: c.name)


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@MODELS
@DYNAMICS
def test_dynamics(candidate: Configured, model: Configured, check: Callable[[Dynamics, Model], None]) -> None:
    """One check of one dynamics on one model."""
    check(*_both(candidate, model))


@MODELS
@DYNAMICS
def test_order(candidate: Configured, model: Configured, record_property: Record) -> None:
    """Measured order of convergence, on vehicles whose inputs are all given: forces of contact are not."""
    dynamics, vehicle = _both(candidate, model)
    if isinstance(vehicle, TouchingModel):
        pytest.skip(f"{model.name} finds some of its inputs itself")
    record_property("measured", f"{candidate.name} on {model.name}: {check_order(dynamics, vehicle)}")


@pytest.mark.parametrize("check", [check_phases, check_consistency], ids=lambda check: check.__name__)
@DYNAMICS
def test_order_on_the_pendulum(
    candidate: Configured, check: Callable[[Dynamics, Model], str], record_property: Record
) -> None:
    """Order over unequal phases, and of one step; forced and damped."""
    record_property("measured", f"{candidate.name} on pendulum: {check(candidate.build(), pendulum())}")


@DYNAMICS
def test_energy(candidate: Configured, record_property: Record) -> None:
    """Energy error of a free swing of the pendulum, in its first and second half: reported, must be finite."""
    first, second = energy_errors(candidate.build(), pendulum(damping=0.0))
    behaviour = "bounded" if second < 1.2 * first else "drifts"
    record_property(
        "measured", f"{candidate.name} energy of a free swing: {first:.1e}, {second:.1e} ({behaviour})"
    )
    assert np.isfinite(first) and np.isfinite(second)


def _both(candidate: Configured, model: Configured) -> tuple[Dynamics, Model]:
    """Dynamics and model, built once for all their checks, unless they cannot meet."""
    dynamics, vehicle = _built(candidate), _built(model)
    if not dynamics.accepts(vehicle):
        pytest.skip(f"{candidate.name} is not for {model.name}")
    return dynamics, vehicle


def _built(candidate: Configured) -> Any:
    """One of a kind and name, built when it is first asked for; a plugin keeps nothing from one check to the next."""
    key = (candidate.kind, candidate.name)
    if key not in _BUILT:
        _BUILT[key] = candidate.build()
    return _BUILT[key]


_BUILT: dict[tuple[type | None, str], Any] = {}


def pendulum(**changes: float) -> Model:
    """The built-in test model."""
    model: Model = next(c for c in candidates("models") if c.name == "pendulum").build(**changes)
    return model
