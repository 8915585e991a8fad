"""Which kind of scenario a configuration means: a handover, a race, a transfer, or one that an installed package brings.

A kind comes from a folder of its own and one entry point in the group `benchbench.scenarios`. What it is posed as, bounded
by, checked for and drawn as, each room asks by a function that dispatches on the kind; the folder registers its answers.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from benchbench.ground import registry
from benchbench.ground.errors import BadInput
from benchbench.ocp.handover import Handover
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.transfer import Transfer
from benchbench.ocp.values import FIELD, marked

OWN: Mapping[str, type[Scenario]] = {"handover": Handover, "race": Race, "transfer": Transfer}
"""The kinds of the core; a configuration that says nothing means the first."""


def kinds() -> dict[str, type[Scenario]]:
    """Return all kinds by name: the core's own, then those of installed packages; what cannot be loaded is left out."""
    found = {plugin.name: plugin.kind for plugin in registry.installed("scenarios")}
    return {**OWN, **{n: k for n, k in found.items() if n not in OWN and k and issubclass(k, Scenario)}}


def kind_of(values: Mapping[str, Any]) -> type[Scenario]:
    """Return the kind of a configuration: the one it names, else the one whose mark it has, else a handover.

    Raises BadInput for a name that is not installed.
    """
    known = kinds()
    if (name := values.get(FIELD)) is not None:
        if name not in known:
            broken = {plugin.name: plugin.error for plugin in registry.installed("scenarios")}.get(name)
            problem = f"'{name}' cannot be loaded: {broken}" if broken else f"'{name}' is not installed"
            raise BadInput(f"scenario.{FIELD}", problem, ", ".join(sorted(known)))
        return known[name]
    return marked(values, known.values()) or Handover


def fields_of(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a configuration without the name of its kind, where it is of that kind all the same."""
    bare = {name: value for name, value in values.items() if name != FIELD}
    return bare if kind_of(bare) is kind_of(values) else dict(values)
