"""Families of tasks: pinned tasks, draws, what wins over them, and that a drawn task is an ordinary one."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import drawn_tasks
import hydra
import numpy as np
import pytest
import yaml
from omegaconf import DictConfig, OmegaConf

from benchbench.ground.errors import BadInput
from benchbench.ocp.motion import Motion, sample
from benchbench.ocp.task_family import Draws, TaskFamily, rounded
from benchbench.planning.case import Case
from benchbench.run import config
from benchbench.run.execution import config_hash, written
from benchbench.run.making import made

PINNED = yaml.safe_load(drawn_tasks.FILE.read_text())


@pytest.fixture(scope="module")
def families() -> dict[str, TaskFamily]:
    with hydra.initialize_config_dir(config.folder(), version_base="1.3"):
        composed = {n: hydra.compose("config", [f"+scenario={n}"]) for n in drawn_tasks.FAMILIES}
    for cfg in composed.values():
        OmegaConf.set_struct(cfg, False)
        del cfg.scenario.family["seed"]
    return {name: made(cfg, "scenario.family", TaskFamily) for name, cfg in composed.items()}


def tasks(
    families: dict[str, TaskFamily], name: str, seeds: Sequence[int] = range(200)
) -> list[dict[str, Any]]:
    return [families[name].draw(Draws(name, seed)) for seed in seeds]


def scenario(*overrides: str) -> DictConfig:
    return config.composed(*overrides)[0].scenario


@pytest.mark.parametrize("name", PINNED)
def test_a_task_is_the_one_that_was_published(name: str) -> None:
    family, _, seed = name.rpartition("_")
    assert drawn_tasks.task(family, int(seed)) == PINNED[name]


def test_three_tasks_of_every_family_are_pinned() -> None:
    assert len(PINNED) == 3 * len(drawn_tasks.FAMILIES)
    families = {n for n in config.choices("scenario") if n.startswith("random_")}
    assert families == set(drawn_tasks.FAMILIES)


def test_a_draw_is_the_first_bits_of_a_hash() -> None:
    digits = hashlib.sha256(b"random_handover\n7\ndistance").hexdigest()[:16]
    share = int(digits, 16) // 2**11 / 2**53
    assert Draws("random_handover", 7).share("distance") == share
    assert math.hypot(*(PINNED["random_handover_7"]["end"][axis] for axis in "xy")) == pytest.approx(
        1 + 5 * share, abs=2e-4
    )


def test_draws_are_uniform_and_independent() -> None:
    shares = np.array([[Draws("some", seed).share(name) for name in ("a", "b")] for seed in range(4000)])
    assert shares.min() >= 0 and shares.max() < 1
    counts = np.histogram2d(*shares.T, bins=4, range=[[0, 1]] * 2)[0]
    assert np.sum((counts - 250) ** 2 / 250) < 37.7  # chi^2, 15 degrees of freedom, 0.1 %
    whole = [Draws("some", seed).whole("n", (2, 5)) for seed in range(4000)]
    assert np.bincount(whole)[2:] == pytest.approx(1000, abs=120) and len(np.bincount(whole)) == 6
    named = [Draws("some", seed).one_of("k", {"b": 3, "a": 1, "none": 0}) for seed in range(4000)]
    assert named.count("a") == pytest.approx(1000, abs=120) and set(named) == {"a", "b"}


def test_what_is_drawn_lies_within_its_range_and_stands_in_yaml_as_it_is() -> None:
    for seed in range(500):
        value = Draws("some", seed).number("x", (0.00005, 0.00012))
        assert 0.00005 <= value <= 0.00012
        assert Draws("some", seed).number("y", (-1e-6, 1e-6)) == 0 and math.copysign(1, rounded(-1e-9)) == 1


def test_handovers_are_what_the_issue_asks_for(families: dict[str, TaskFamily]) -> None:
    drawn = tasks(families, "random_handover")
    far = [math.hypot(t["end"]["x"], t["end"]["y"]) for t in drawn]
    assert 1 <= min(far) < 1.2 and 5.8 < max(far) <= 6 + 1e-4
    assert {t["kappa_init"] for t in drawn} == set(range(1, 14))
    kinds = [t["target"]["_target_"].rpartition(".")[2] for t in drawn]
    assert {k: kinds.count(k) > 30 for k in set(kinds)} == dict.fromkeys(
        ("Fixed", "Linear", "Circle", "Braking"), True
    )
    assert all(0.5 <= t[end]["z"] <= 1.3 for t in drawn for end in ("start", "end"))


def test_targets_are_beside_the_way_when_the_vehicle_may_be_there(families: dict[str, TaskFamily]) -> None:
    for task in tasks(families, "random_handover", range(60)):
        end = np.array([task["end"][axis] for axis in "xy"])
        length = np.linalg.norm(end)
        motion: Motion = hydra.utils.instantiate(task["target"], _convert_="all")
        stands = getattr(motion, "stop_s", None)
        times = np.linspace(0, 0.8 * length / 0.8, 4001) if stands is None else np.array([stands, stands + 3])
        place, velocity = sample(motion, times)
        along, aside = place[:, :2] @ end / length, place[:, :2] @ [-end[1], end[0]] / length
        met = (np.abs(aside) <= 0.5 + 1e-3) & (along >= 0.2 * length - 1e-3) & (along <= 0.8 * length + 1e-3)
        met &= True if stands is not None else np.abs(along - 0.8 * times) < 0.01
        assert met.any()
        assert np.all(np.linalg.norm(velocity, axis=1) <= 0.5 + 1e-3)


def test_races_have_room_and_all_kinds_of_gates(families: dict[str, TaskFamily]) -> None:
    drawn = tasks(families, "random_race", range(100))
    counts = [len(t["track"]) for t in drawn]
    assert min(counts) == 2 and max(counts) == 30
    gates = [gate for t in drawn for gate in t["track"]]
    for field, share in (("width", 0.4), ("radius", 0.6), ("speed", 0.15), ("heading", 0.1)):
        assert sum(field in gate for gate in gates) / len(gates) == pytest.approx(share, abs=0.05)
    assert {t["end_velocity"] for t in drawn} == {"rest", "free"}
    for task in drawn:
        way = np.array([[p[axis] for axis in "xyz"] for p in (task["start"], *task["track"], task["end"])])
        legs = np.linalg.norm(np.diff(way, axis=0), axis=1)
        assert np.all((legs >= 2) & (legs <= 16))


def test_a_wider_range_of_one_number_leaves_the_others_alone() -> None:
    usual = scenario("+scenario=random_handover", "seed=7")
    other = scenario("+scenario=random_handover", "seed=7", "scenario.family.kappa_init=[20,20]")
    assert other.kappa_init == 20 and other.target == usual.target and other.end == usual.end


@pytest.mark.parametrize(
    ("typed", "field", "value"),
    [
        ("scenario.kappa_init=2", "kappa_init", 2),
        ("scenario.end.x=3.5", "end.x", 3.5),
        ("scenario.start.z=0.9", "start.z", 0.9),
        ("+scenario/motion=fixed scenario.target.position_m=[1,0,0.4]", "target.position_m", [1, 0, 0.4]),
        (
            "scenario.target={_target_:benchbench_plugins.motions.Fixed,position_m:[1,0,0.4]}",
            "target.position_m",
            [1, 0, 0.4],
        ),
        ("scenario.intervals=60", "intervals", 60),
    ],
)
def test_what_is_typed_wins(typed: str, field: str, value: Any) -> None:
    usual = scenario("+scenario=random_handover", "seed=7")
    given = scenario("+scenario=random_handover", "seed=7", *typed.split())
    assert OmegaConf.select(given, field) == value
    for place in ("end.y", "end.z"):
        assert OmegaConf.select(given, place) == OmegaConf.select(usual, place)


def flat(case: Case) -> tuple[Any, ...]:
    return case.task_hash, case.scenario, case.seed, case.names


def test_a_drawn_task_is_the_plain_one_with_the_same_numbers(tmp_path: Path) -> None:
    """A scenario that somebody writes by hand with the numbers of the draw."""
    cfg, _ = config.composed("+scenario=random_handover", "seed=7")
    numbers: Any = OmegaConf.to_container(cfg.scenario)
    (tmp_path / "scenario").mkdir()
    (tmp_path / "scenario" / "mine.yaml").write_text(yaml.safe_dump(numbers))
    place = f"hydra.searchpath=[file://{tmp_path}]"
    plain, _ = config.composed("+scenario=mine", place)
    assert flat(config.compose("+scenario=mine", place)) == flat(
        config.compose("+scenario=random_handover", "seed=7")
    )
    assert config_hash(plain) == config_hash(cfg)
    assert "drawn" not in written(cfg) and "family" not in written(cfg)


def test_the_key_of_resumption_follows_what_was_drawn() -> None:
    def key(*overrides: str) -> str:
        return config_hash(config.composed("+scenario=random_handover", *overrides)[0])

    keys = {key(f"seed={seed}") for seed in range(4)}
    assert len(keys) == 4 and key("seed=2") in keys
    assert key("seed=2", "scenario.kappa_init=2") not in keys


def test_the_seed_of_a_task_does_not_disturb_the_start() -> None:
    family = "+scenario=random_handover"
    assert config.compose(family, "seed=7").seed == 0
    both = config.compose(family, "scenario.family.seed=7", "seed=3")
    assert (both.seed, both.scenario.name) == (3, "random_handover_7")
    assert both.task_hash == config.compose(family, "seed=7").task_hash
    assert config.compose("+scenario=circle", "seed=7").seed == 7


def test_a_family_that_was_stored_is_made_of_plugins_only(tmp_path: Path) -> None:
    """Overrides that lie beside results: nothing else is even called."""
    file = tmp_path / "made"
    hostile = (
        "+scenario=random_handover",
        "~scenario.family",
        f"+scenario.family={{_target_:os.mkdir,path:{file}}}",
    )
    with pytest.raises(
        BadInput, match=r"scenario\.family\._target_: 'os\.mkdir' stands in a stored configuration"
    ):
        config.compose_any(*hostile, stored=True)
    assert not file.exists()
    assert (
        config.compose_any("+scenario=random_handover", "seed=7", stored=True).names["scenario"]
        == "random_handover_7"
    )


BAD = (
    ("random_handover", "scenario.family.way.distance_m=[6,1]", r"scenario\.family\.way\.distance_m: the first .* exceed"),
    ("random_handover", "scenario.family.way.distance_m=[nan,1]", r"scenario\.family\.way\.distance_m\.0: nan .*finite"),
    ("random_handover", "scenario.family.way.distance_m=[1,inf]", r"scenario\.family\.way\.distance_m\.1: inf .*finite"),
    ("random_handover", "scenario.family.way.distance_m=[-1,1]", r"distance_m\.0: -1 .*greater than or equal to 0"),
    ("random_handover", "scenario.family.way.distanc_m=[1,2]", r"way\.distanc_m: does not exist, perhaps 'distance_m'"),
    ("random_handover", "+scenario.family.alon=[0,1]", r"family\.alon: does not exist, perhaps 'along'"),
    ("random_handover", "+scenario.family.targets.kinds.car=1", r"targets\.kinds: there is no target 'car', only braking"),
    ("random_handover", "scenario.family.kappa_init=[0,3]", r"kappa_init\.0: 0 was given; allowed: a number greater"),
    ("random_handover", "scenario.end.arm=drawn", r"scenario\.end\.arm: is to be drawn, but this family does not"),
    ("random_handover", "seed=-1", r"seed: -1 was given"),
    ("random_handover", "scenario.family.seed=x", r"scenario\.family\.seed: 'x' was given"),
    ("random_handover", "scenario.family._target_=benchbench_plugins.motions.Fixed", r"scenario\.family"),
    ("random_race", "scenario.family.leg_m=[90,99]", r"scenario\.family\.leg_m: no place"),
    ("random_race", "scenario.family.rectangle=2", r"family\.rectangle: 2 was given"),
    ("random_delivery", "scenario.family.stops=[2,4]", r"family\.stops\.1: 4 was given"),
)  # fmt: skip


@pytest.mark.parametrize(("family", "typed", "message"), BAD)
def test_bad_input_is_one_message(family: str, typed: str, message: str) -> None:
    with pytest.raises(BadInput, match=message) as caught:
        config.compose(f"+scenario={family}", "seed=7", typed)
    assert "\n" not in str(caught.value)
