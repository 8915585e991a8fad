"""How much of each limit a certified plan uses: counted, said in words, in the summary, above the picture."""

from __future__ import annotations

import numpy as np
import pytest

from benchbench.certificate.certificate import Certificate, Measures
from benchbench.certificate.check import BEYOND, Check, at_least, at_most
from benchbench.report.caption import caption
from benchbench.run.summary import lines
from benchbench.storage.schema import make_record

CHECKS = (
    at_most("replay_rate", "rate of 'arm'", 1.0499, 1.05, "times its limit", " at t=1 s"),
    at_most("contact_position", "distance in contact", 0.012, 0.02, "m"),
    at_most("contact_position", "distance in contact at b", 0.016, 0.02, "m"),
    at_most("replay_position", "'z'", 0.004, 0.005, "m", "", BEYOND),
    at_most("residual", "violation", 1e-8, 1e-6, "1"),
    at_most("planned_input", "planned input 'm'", -0.3, 1e-6, "N", "", BEYOND),
    at_least("contact_steps", "the longest contact", 2.0, 2.0, "nodes"),
    Check("finite_time", 0.0, 0.0, "1", True),
)


def test_the_fullest_of_each_kind_is_told() -> None:
    found = Certificate(CHECKS, Measures(), None).record()
    assert found["limits_used"] == pytest.approx(
        {"replay_rate": 1.0499 / 1.05, "contact_position": 0.8, "replay_position": 0.8, "residual": 0.01}
    )
    assert found["limits_used_said"] == (
        "rate of 'arm' 1.0499 of 1.05 times its limit", "distance in contact at b 0.016 of 0.02 m",
        "'z' beyond its limits 0.004 of 0.005 m",
    )  # fmt: skip


def test_what_two_checks_ask_for_is_told_once() -> None:
    checks = [
        at_most(name, "speed of approach", value, 0.05, "m/s")
        for name, value in (("planned", 0.048), ("flown", 0.049))
    ]
    found = Certificate(tuple(checks), Measures(), None).record()
    assert found["limits_used_said"] == ("speed of approach 0.049 of 0.05 m/s",)
    assert set(found["limits_used"]) == {"planned", "flown"}


@pytest.mark.parametrize("value", [2.0, np.nan, np.inf, -np.inf])
def test_what_is_broken_or_no_number_uses_nothing(value: float) -> None:
    used = Certificate((at_most("a", "the way", value, 1.0, "m"),), Measures(), None).record()
    assert used["limits_used"] == {} and used["limits_used_said"] == ()


def test_summary_and_picture_say_it_of_certified_plans() -> None:
    said = {
        "scenario": "static",
        "dynamics": "verlet",
        "strategy": "phases",
        "intervals": 12,
        "iterations": 1,
    }
    record = make_record(
        **said, certified=True, limits_used_said=["rate of 'arm' 1.0499 of 1.05 times its limit"]
    )
    assert ("limits used", "rate of 'arm' 1.0499 of 1.05 times its limit") in lines(record)
    assert caption(record)[1] == "certified; closest to a limit: rate of 'arm' 1.0499 of 1.05 times its limit"
    assert caption(make_record(certified=True))[1] == "certified"
    broken = make_record(
        **said,
        certified=False,
        claimed_success=True,
        reasons=["x"],
        limits_used_said=["y"],
        status="uncertified",
    )
    assert "limits used" not in dict(lines(broken)) and caption(broken)[1] == "NOT certified: x"


def test_a_title_names_each_choice_once() -> None:
    named = {
        "scenario": "circle",
        "vehicle": "table1",
        "dynamics": "verlet",
        "intervals": 100,
        "solver": "ipopt",
        "strategy": "auto",
    }
    assert caption(make_record(**named))[0] == "circle, table1, verlet, N = 100, ipopt, auto"
    assert (
        caption(make_record(**named, relaxation="paper"))[0]
        == "circle, table1, verlet, N = 100, paper, ipopt, auto"
    )
