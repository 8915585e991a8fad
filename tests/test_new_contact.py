"""A contact of one's own touches its own file: bounds, certificate, record, tables and pictures ask it what it is."""

from __future__ import annotations

import ast
import io
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar, final

import casadi as ca
import numpy as np
import pytest
from pydantic.dataclasses import dataclass
from rich.console import Console
from test_certificate import LIMITS, MODEL, claimed, crossing_plan, task

from benchbench.certificate.bound import lower_bound
from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify
from benchbench.conformance.checks import contacts
from benchbench.ground import registry
from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Condition, Contact, Target, in_words
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node
from benchbench.report.html.tables import run_table
from benchbench.report.limits_panel import contact_panels
from benchbench.run import summary
from benchbench.storage.schema import make_record
from benchbench.storage.table import append, read
from benchbench_plugins.contacts.position import Position

CORE = Path(__file__).parents[1] / "benchbench"
STIFFNESS = 500.0
"""N/m"""


@final
@dataclass(frozen=True)
class Rubber(Contact):
    """A rubber band from end effector to target pulls with at most `limit` N."""

    noun: ClassVar[str] = "pull"
    aside: ClassVar[str] = "of pull"
    limit: float = 10.0
    unit: str = "N"

    @property
    def reach(self) -> float:
        """Where it pulls that much."""
        return self.limit / STIFFNESS

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        offset = model.tool(node.configuration) - target.position
        return Condition(ca.sumsqr(offset) * (STIFFNESS / self.limit) ** 2 - 1, self.unit, (self.limit,))

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        return STIFFNESS * np.linalg.norm(plant.tool(q, v)[0] - target_position, axis=-1)


def judged(limit: float) -> Certificate:
    plan = crossing_plan()
    return certify(plan, task(plan, contacts={"band": Rubber(limit)}), MODEL, LIMITS)


@pytest.mark.parametrize("check", contacts.CHECKS, ids=lambda check: check.__name__)
def test_it_is_a_contact(check: Callable[[Contact, Model], None]) -> None:
    check(Rubber(10.0), MODEL)


def test_the_bound_knows_how_near_it_must_be() -> None:
    plan = crossing_plan()
    bands = {"band": Rubber(10.0), "looser": Rubber(30.0)}
    found = [
        lower_bound(task(plan, contacts=c), MODEL, MODEL.plant()) for c in (bands, {"p": Position(0.02)})
    ]
    assert found[0] == found[1]


def test_the_certificate_speaks_of_it() -> None:
    worst = float(judged(10.0).record()["contact_gaps"]["band"])
    assert 0 < worst < 0.5
    (check,) = (c for c in judged(worst / 2).checks if c.name == "contact_band")
    assert check.reason.startswith("pull in contact reaches ") and check.unit == "N" and not check.ok
    plan = crossing_plan()
    far = certify(claimed(plan, 9, 10, 14), task(plan, contacts={"band": Rubber()}), MODEL, LIMITS)
    assert far.reasons[0].startswith("node 14 claims contact with epsilon 1 but its pull is ")
    assert far.reasons[0].endswith(" N, allowed 10 N")


def test_record_tables_summary_and_picture_show_it(tmp_path: Path) -> None:
    certificate = judged(10.0)
    told = {"status": "certified", "claimed_success": True, "intervals": 20, "travel_time_s": 1.6}
    record = make_record(run_id="a", **certificate.record(), **told)
    worst = record["contact_gaps"]["band"]
    assert record["contact_gaps_said"] == [f"{worst:.3g} N of pull"]
    said = io.StringIO()
    summary.show(record, {}, Console(file=said, width=100))
    assert f"at worst {worst:.3g} N of pull" in said.getvalue()
    append(record, tmp_path)
    append(make_record(run_id="b", contact_gaps={"position": 0.01}), tmp_path)
    rows = read(tmp_path)
    assert rows.contact_gaps.tolist() == [{"band": worst}, {"position": 0.01}]
    shown = run_table(rows)
    at = [head.name for head in shown.heads].index("contact_gaps band")
    assert [row[at].key for row in shown.rows] == [repr(worst), ""]
    plan = crossing_plan()
    (panel,) = contact_panels(plan, task(plan, contacts={"band": Rubber()}), MODEL, certificate.flight)
    assert (panel.title, panel.unit) == ("Pull", "N")


@pytest.mark.parametrize(
    ("unit", "gap", "words"), [("m", 0.01934, "19.3 mm"), ("rad/s", 0.5, "500 mrad/s"), ("1", 0.25, "0.25")]
)
def test_words_of_a_gap(unit: str, gap: float, words: str) -> None:
    assert in_words(Rubber(unit=unit), gap) == f"{words} of pull"


STATE = {"position", "velocity"}
"""Names of contacts that are words for parts of a state, too: they count where a statement is about contacts."""
ELSEWHERE = {
    "formulation/handover.py": {"approach"},  # the phase before a contact
    "ocp/track_file.py": {"heading"},  # of a gate
    "storage/flight_csv.py": {"position", "velocity"},  # columns of a flight, beside that of contacts
    "storage/upgrade.py": {
        "position",
        "velocity",
        "heading",
    },  # what records said when these were all there were
}


def named_in(source: str, words: set[str]) -> set[str]:
    """Which of these words stand as texts in a module, in statements that are about contacts if they need be."""
    found = set()
    for statement in (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.stmt)):
        inner = [n for n in ast.iter_child_nodes(statement) if not isinstance(n, ast.stmt)]
        texts = {n.value for part in inner for n in ast.walk(part) if isinstance(n, ast.Constant)}
        said = words & {text for text in texts if isinstance(text, str)}
        about = any("contact" in ast.unparse(part).lower() for part in inner)
        found |= said if about else said - STATE
    return found


def test_no_file_of_the_core_knows_a_contact_by_name() -> None:
    kinds = {plugin.name: plugin.kind for plugin in registry.installed("contacts")}
    words = {*kinds, *(kind.noun for kind in kinds.values() if kind is not None)}
    assert {"position", "velocity", "heading", "floor", "relative speed"} <= words
    known = {}
    for path in CORE.rglob("*.py"):
        place = path.relative_to(CORE).as_posix()
        found = named_in(path.read_text(), words) - ELSEWHERE.get(place, set())
        if found and not place.startswith("conformance/"):
            known[place] = found
    assert known == {}, "the core names a contact; where the word means something else, ELSEWHERE says so"


@pytest.mark.parametrize(
    "line",
    [
        'SPOKEN = {"position": "distance"}',
        'if "position" in stop.contacts:\n    pass',
        'MEASURED = (("velocity", "contact_speed"),)',
        'gap = found["heading"]',
    ],
)
def test_it_would_be_seen(line: str) -> None:
    assert named_in(line, {"position", "distance", "velocity", "heading"})
    assert not named_in('rows = table["position"]\nx = "angle"', {"position"})
