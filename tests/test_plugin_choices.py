"""An entry point alone makes a choice: its fields, its errors, and which YAML is taken instead."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
import yaml
from omegaconf import OmegaConf
from packages import install

from benchbench.cli.application import start
from benchbench.ground import registry
from benchbench.ground.errors import BadInput
from benchbench.planning.case import Case
from benchbench.run import config
from benchbench.run.choices import GROUPS
from benchbench.run.plugin_choices import options

MODULE = '''
"""A stranger's relaxations and contact."""
from dataclasses import dataclass, field
import numpy as np
from benchbench import Contact, Cost, Relaxation, Relaxed

class Plain:
    def __init__(self, needed, share=0.5, names=("a", "b"), own=object(), _hidden=1, *rest, **more):
        pass

@dataclass(frozen=True)
class Theirs(Relaxation):
    schedule: tuple[float, ...] = (0.1, 0.01)
    table: dict = field(default_factory=lambda: {"a": [1, 2]})
    def relax(self, g, h, sigma, kind, gap):
        return Relaxed(g * h - sigma, (-np.inf,), (0.0,))

class Toll(Cost):
    noun = "toll"
    def __init__(self, weight):
        self.weight = weight
    def rate(self, model, q, v, u):
        raise NotImplementedError
    def spent(self, plant, q, v, u):
        raise NotImplementedError

class Ground(Contact):
    noun, aside, reach = "height", "above the ground", None
    def __init__(self, limit=0.2):
        self.limit = limit
    def condition(self, model, node, target):
        raise NotImplementedError
    def gap(self, plant, q, v, target_position, target_velocity):
        raise NotImplementedError

class Never(Ground):
    kept = "always"
'''
REGISTERED = {
    "benchbench.conf": {"strangers": "strangers_conf"},
    "benchbench.relaxations": {
        "theirs": "strangers_module:Theirs", "yaml": "strangers_module:Theirs", "broken": "strangers_broken:Theirs",
        "gone": "strangers_module:Gone", "number": "strangers_module:__name__", "twice": "strangers_module:Theirs",
    },
    "benchbench.contacts": {"ground": "strangers_module:Ground", "never": "strangers_module:Never"},
    "benchbench.costs": {"toll": "strangers_module:Toll"},
}  # fmt: skip


@pytest.fixture
def strangers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two installed distributions, as pip lays them out."""
    (tmp_path / "strangers_module.py").write_text(MODULE)
    (tmp_path / "strangers_broken.py").write_text("raise RuntimeError('no licence\\nsecond line')\n")
    choice(tmp_path / "strangers_conf", "yaml", 0.25)
    (tmp_path / "strangers_conf" / "__init__.py").touch()
    install(tmp_path, "strangers", REGISTERED)
    install(tmp_path, "others", {"benchbench.relaxations": {"twice": "strangers_module:Other"}})
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("strangers_module", "strangers_broken", "strangers_conf"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    return tmp_path


def choice(folder: Path, name: str, sigma: float) -> str:
    """A YAML file for the choice relaxation=NAME; returns the option that adds its folder."""
    (folder / "relaxation").mkdir(parents=True, exist_ok=True)
    text = f"_target_: benchbench_plugins.relaxations.scholtes.Scholtes\nschedule: [{sigma}]\n"
    (folder / "relaxation" / f"{name}.yaml").write_text(text)
    return f"hydra.searchpath=[file://{folder}]"


def compose(*overrides: str) -> Case:
    return config.compose("+scenario=static", *overrides)


def test_the_names_are_there_and_nothing_is_imported(strangers: Path) -> None:
    assert {"theirs", "broken", "twice", "scholtes", "elastic"} <= set(config.choices("relaxation"))
    assert not {"strangers_module", "strangers_broken"} & set(sys.modules)


def test_fields_and_defaults_come_from_the_class(strangers: Path) -> None:
    import strangers_module  # type: ignore[import-not-found]

    assert options(strangers_module.Plain) == {"needed": "???", "share": 0.5, "names": ("a", "b")}
    assert options(strangers_module.Theirs) == {"schedule": (0.1, 0.01), "table": {"a": [1, 2]}}
    assert compose("relaxation=theirs").relaxation.schedule == [0.1, 0.01]
    assert compose("relaxation=theirs", "relaxation.table.a=[3]").relaxation.table == {"a": [3]}


@pytest.mark.parametrize(
    ("overrides", "says"),
    [
        ("relaxation=theirs relaxation.shedule=[1]", "relaxation.shedule: does not exist, perhaps 'schedule' is meant"),
        ("relaxation=their", "relaxation: 'their' does not exist; allowed: augmented_lagrangian, broken, "),
        ("relaxation=broken", "relaxation._target_: 'strangers_broken.Theirs' cannot be loaded: .*no licence"),
        ("relaxation=broken relaxation.schedule=[1]", "relaxation._target_: .*cannot be loaded: .*no licence"),
        ("relaxation=gone", "relaxation._target_: 'strangers_module.Gone' cannot be loaded: "),
        ("relaxation=number", "relaxation._target_: 'strangers_module.__name__' cannot be loaded: "),
        ("relaxation=twice", "relaxation: 'twice' is registered for strangers_module:Other and strangers_module:Theirs"),
        ("+scenario/contact=groun", "scenario/contact: 'groun' does not exist; allowed: approach, floor, ground"),
        ("+scenario/contact=ground scenario.contacts.ground.limt=1", "scenario.contacts.ground.limt: .*'limit'"),
    ],
)  # fmt: skip
def test_mistakes_are_one_message(strangers: Path, overrides: str, says: str) -> None:
    with pytest.raises(BadInput, match=says) as caught:
        compose(*overrides.split())
    assert "\n" not in str(caught.value)


def test_yaml_of_the_same_name_wins_wherever_it_is(
    strangers: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own = choice(tmp_path / "own", "theirs", 0.5)
    choice(tmp_path / "own", "scholtes", 0.75)
    assert compose("relaxation=yaml").relaxation.schedule == (0.25,)
    assert compose("relaxation=theirs", own).relaxation.schedule == (0.5,)
    assert compose("relaxation=scholtes", own).relaxation.schedule == (0.75,)
    assert compose("relaxation=theirs").relaxation.schedule == [0.1, 0.01]
    asked = ["--config-dir", str(tmp_path / "own"), "+scenario=static", "relaxation=theirs", "--cfg", "job"]
    assert start(asked) == 0
    assert yaml.safe_load(capsys.readouterr().out)["relaxation"]["schedule"] == [0.5]


def test_a_contact_is_chosen_by_name(strangers: Path, tmp_path: Path) -> None:
    """On the command line and in the defaults of a scenario of one's own."""
    (tmp_path / "own" / "scenario").mkdir(parents=True)
    (tmp_path / "own" / "scenario" / "mine.yaml").write_text(
        "defaults: [static, contact: ground, _self_]\nname: mine\n"
    )
    asked = compose("+scenario/contact=ground", "scenario.contacts.ground.limit=0.3").scenario
    mine = config.compose(f"hydra.searchpath=[file://{tmp_path / 'own'}]", "+scenario=mine").scenario
    for scenario in (asked, mine):
        assert list(scenario.contacts) == ["position", "velocity", "heading", "ground"]
        assert type(scenario.contacts["ground"]).__name__ == "Ground"


def test_obstacles_and_costs_are_chosen_by_name_as_contacts_are(strangers: Path) -> None:
    asked = [
        "+scenario/obstacle=never",
        "scenario.obstacles.never.limit=0.3",
        "+scenario/cost=toll",
        "scenario.costs.toll.weight=2",
    ]
    scenario = compose(*asked).scenario
    assert list(scenario.obstacles) == ["never"] and scenario.obstacles["never"].limit == 0.3
    assert list(scenario.costs) == ["toll"] and scenario.costs["toll"].weight == 2
    with pytest.raises(BadInput, match=r"scenario\.costs\.toll\.weight: is not given and has no default"):
        compose("+scenario/cost=toll")
    with pytest.raises(
        BadInput,
        match=r"scenario\.obstacles\.ground: a Ground is kept in contact; allowed: a contact that is kept always",
    ):
        compose("+scenario/obstacle=ground")


@pytest.mark.parametrize("family", GROUPS)
def test_no_yaml_repeats_its_class(family: str) -> None:
    """What the entry point says by itself needs no file."""
    for name, (entry,) in registry.entries(family).items():
        file = Path(config.folder(), GROUPS[family], f"{name}.yaml")
        if file.is_file():
            said = OmegaConf.to_container(OmegaConf.load(file))
            alone = {"_target_": f"{entry.module}.{entry.attr}", **options(entry.load())}
            assert said != OmegaConf.to_container(OmegaConf.create(alone)), file
