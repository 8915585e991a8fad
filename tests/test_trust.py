"""Commands that read results never run code from them: canaries that would leave a file behind."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import casadi as ca
import pyarrow as pa
import pytest
import yaml

from benchbench.cli.commands import best
from benchbench.cli.report_content import content
from benchbench.ground.errors import BadInput
from benchbench.mpcc.cache import cache_root, private
from benchbench.ocp.reading import DEEPEST
from benchbench.run import config, pipeline, trust
from benchbench.storage.collect import collect
from benchbench.storage.configuration import LARGEST, configuration, read
from benchbench.storage.formats import csv
from benchbench.storage.schema import make_record
from benchbench_plugins.collections.nosbench import MpccFile
from benchbench_plugins.collections.serialized import foreign

SMALL = ("+scenario=static", "scenario.intervals=12", "iteration_limit=1", "compile=never")
TARGETS = (
    "os.system", "os._exit", "builtins.eval", "builtins.exec", "subprocess.run", "subprocess.Popen", "pickle.loads",
    "pathlib.Path", "shutil.rmtree", "ctypes.CDLL", "runpy.run_path", "importlib.import_module", "hydra.utils.instantiate",
    "benchbench_plugins.peers.togt.shutil.copytree", "benchbench_plugins.motions.spline.Path", "benchbench.run.pipeline.run",
    "benchbench_plugins.strategies.peer.External", "casadi.external", "numpy.load", "", "os", "...", "benchbench_plugins",
)  # fmt: skip
"""What Hydra could make of a stored `_target_`; the last ones are no names at all."""


@pytest.fixture(scope="module")
def honest(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of results of one small run."""
    root = tmp_path_factory.mktemp("honest")
    done = pipeline.run(config.compose(*SMALL), labels={"run_id": "one"})
    folder = root / "runs" / "one"
    with config.hydra.initialize_config_dir(config.folder(), version_base="1.3"):
        composed = config.OmegaConf.to_yaml(
            config.hydra.compose("config", config.meant(SMALL)), resolve=False
        )
    pipeline.write(done, folder, root, composed)
    return root


@pytest.fixture
def theirs(honest: Path, tmp_path: Path) -> Path:
    """A copy from somebody else."""
    return Path(shutil.copytree(honest, tmp_path / "theirs"))


def change(results: Path, place: str, value: Any) -> None:
    file = results / "runs" / "one" / "config.yaml"
    tree = yaml.safe_load(file.read_text())
    node = tree
    *path, last = place.split(".")
    for key in path:
        node = node[key]
    node[last] = value
    file.write_text(yaml.safe_dump(tree))


def test_an_honest_folder_is_shown(theirs: Path) -> None:
    """Otherwise nothing below says anything."""
    found = content(collect([theirs]), [theirs], None, 1)
    assert len(found.plans) == 1, found.missing


@pytest.mark.parametrize("place", ["scenario.target", "scenario.contacts.position", "vehicle"])
@pytest.mark.parametrize("target", TARGETS)
def test_nothing_but_plugins_is_made_of_a_stored_configuration(
    theirs: Path, tmp_path: Path, target: str, place: str
) -> None:
    canary = tmp_path / "canary"
    change(theirs, place, {"_target_": target, "_args_": [f"touch {shlex.quote(str(canary))}"]})
    found = content(collect([theirs]), [theirs], None, 1)
    assert not canary.exists()
    assert not found.plans and "is no installed plugin" in found.missing[0], found.missing
    assert len(found.runs) == 1, "its row is still there"


def test_nor_of_what_stands_deeper_or_in_other_words(theirs: Path, tmp_path: Path) -> None:
    canary = tmp_path / "canary"
    evil = {"_target_": "pathlib.Path.touch", "self": {"_target_": "pathlib.Path", "_args_": [str(canary)]}}
    motion = "benchbench_plugins.motions.Fixed"
    for value in (
        {"_target_": motion, "position_m": [evil, 0, 0]},
        {"_target_": motion, "_partial_": True},
        {"_target_": motion, "_args_": [evil]},
        [[{"deep": evil}]],
    ):
        change(theirs, "scenario.target", value)
        assert not content(collect([theirs]), [theirs], None, 1).plans
        assert not canary.exists()


def test_variables_of_the_environment_are_not_told(theirs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CANARY", "a-secret-of-this-machine")
    for place in ("strategy.note", "scenario.name", "vehicle.name"):
        change(theirs, place, "${oc.env:CANARY}")
    found = content(collect([theirs]), [theirs], None, 1)
    assert not found.plans and "${oc.env:CANARY}" in found.missing[0]
    assert "a-secret-of-this-machine" not in str(found.settings) + str(found.missing)


@pytest.mark.parametrize(
    "override",
    ["scenario.target={_target_:os.system,command:'touch CANARY'}", "scenario.name=${oc.env:HOME}",
     "+on_step={_target_:os._exit,_args_:[0]}", "hydra.searchpath=[file:///elsewhere]"],
)  # fmt: skip
def test_stored_overrides_are_data(
    theirs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], override: str
) -> None:
    canary = tmp_path / "canary"
    folder = theirs / "runs" / "one"
    record = make_record(
        run_id="one", status="certified", certified=True, travel_time_s=1.0, task_hash="0123456789abcdef"
    )
    (folder / ".hydra").mkdir()
    said = ["+scenario=static", override.replace("CANARY", str(canary))]
    (folder / ".hydra" / "overrides.yaml").write_text(yaml.safe_dump(said))
    from benchbench.storage.files import write_record
    from benchbench.storage.table import append

    write_record(folder, record)
    append(record, theirs)
    assert best.run([str(theirs), "--file", str(tmp_path / "mine.yaml")]) == 0
    assert not canary.exists() and not (tmp_path / "mine.yaml").exists()
    assert "left out" in capsys.readouterr().err


def test_a_stored_configuration_is_plain_and_small(tmp_path: Path) -> None:
    def stored(text: str) -> Mapping[str, Any] | None:
        (tmp_path / "config.yaml").write_text(text)
        return configuration(tmp_path)

    assert stored("a: {b: [1, 2.5, x]}\nc: ${a.b}") == {"a": {"b": [1, 2.5, "x"]}, "c": "${a.b}"}
    assert stored("a: &a [1]\nb: [*a, *a]") == {"a": [1], "b": [[1], [1]]}
    for text in (
        "a: &a\n  b: *a",
        "a: !!python/object/apply:os.system [exit]",
        "[" * (DEEPEST + 5) + "]" * (DEEPEST + 5),
        "[" * 100_000,
        "\n".join([f"k{i}: &k{i} [{', '.join([f'*k{i - 1}'] * 9 if i else ['x'] * 9)}]" for i in range(12)]),
        "a: " + "x" * (LARGEST + 1),
        "a: \ud800".encode("utf-8", "surrogatepass").decode("latin-1"),
        "just text",
        "",
    ):
        assert stored(text) is None, text[:40]
    with pytest.raises(ValueError, match="refers to itself"):
        (tmp_path / "loop.yaml").write_text("a: &a\n  b: *a")
        read(tmp_path / "loop.yaml")


def test_every_built_in_choice_may_stand_in_a_stored_configuration() -> None:
    """The rule must not refuse what we wrote ourselves."""
    for overrides in (
        ("+scenario=circle",), ("+scenario=race", "scenario.gates=2"), ("+scenario=delivery",), ("+scenario=static", "vehicle=pendulum"),
        ("+scenario=race", "vehicle=race_ramp"), ("+scenario=circle", "+scenario/contact=floor"),
    ):  # fmt: skip
        with config.hydra.initialize_config_dir(config.folder(), version_base="1.3"):
            tree = config.OmegaConf.to_container(config.hydra.compose("config", config.meant(overrides)))
        trust.check(tree, "configuration")


@pytest.fixture(scope="module")
def functions(tmp_path_factory: pytest.TempPathFactory) -> dict[str, ca.Function]:
    """Functions that are plain, and those that load or compile something when they are read."""
    folder, here = tmp_path_factory.mktemp("functions"), Path.cwd()
    x, m = ca.SX.sym("x", 2), ca.MX.sym("m", 2)
    f = ca.Function("F", [x], [x**2], ["Xvar"], ["Yvar"])
    os.chdir(folder)
    try:
        f.generate("f.c")
        subprocess.run(["gcc", "-shared", "-fPIC", "f.c", "-o", "f.so"], check=True)
        theirs = ca.external("F", str(folder / "f.so"))
        jit = {"jit": True, "compiler": "shell", "jit_options": {"flags": "-O0"}}
        made = {
            way: ca.Function("F", [x], [x**2], jit | {"jit_serialize": way})
            for way in ("source", "link", "embed")
        }
    finally:
        os.chdir(here)
    return {
        "plain": f, "map": f.map(3), "mx": ca.Function("M", [m], [f(m)]),
        "call": ca.Function("S", [x], [f.call([x], False, True)[0]]), "switch": ca.Function.if_else("ie", f, f),
        "table": ca.interpolant("L", "linear", [[0, 1, 2]], [0, 1, 2]),
        "foreign external": theirs, "foreign in mx": ca.Function("M", [m], [theirs(m)]),
        "foreign in sx": ca.Function("S", [x], [theirs.call([x], False, True)[0]]),
        **{f"foreign jit {way}": function for way, function in made.items()},
        "foreign jit in mx": ca.Function("M", [m], [made["source"](m)]),
        "foreign nlpsol": ca.nlpsol("N", "ipopt", {"x": x, "f": ca.sumsqr(x)}),
        "foreign rootfinder": ca.rootfinder("R", "newton", ca.Function("g", [x], [x**2 - 1])),
    }  # fmt: skip


needs_gcc = pytest.mark.skipif(not shutil.which("gcc"), reason="needs gcc")


@needs_gcc
def test_functions_are_judged_before_they_are_read(functions: dict[str, ca.Function]) -> None:
    told = {name: foreign(function.serialize()) for name, function in functions.items()}
    assert {name for name, problem in told.items() if problem} == {n for n in told if n.startswith("foreign")}
    for nonsense in ("", "nonsense!", "abc", functions["plain"].serialize()[:40], "é" * 8):
        with pytest.raises(ValueError, match="no serialised"):
            foreign(nonsense)


@needs_gcc
@pytest.mark.parametrize("which", ["foreign external", "foreign jit source", "foreign in sx"])
def test_an_mpcc_file_loads_nothing_unless_it_is_trusted(
    functions: dict[str, ca.Function], tmp_path: Path, which: str
) -> None:
    import json

    x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 0)
    plain = {
        key: ca.Function(key, [x, p], [value])
        for key, value in (
            ("augmented_objective_fun", ca.sumsqr(x)), ("g_fun", x[0]), ("G_fun", x[0]), ("H_fun", x[1]),
        )
    }  # fmt: skip
    numbers = {"w0": [1, 1], "lbw": [0, 0], "ubw": [9, 9], "lbg": 0, "ubg": 9, "p0": []}
    told = {key: function.serialize() for key, function in plain.items()}
    file = tmp_path / "problem.json"
    file.write_text(json.dumps(told | numbers))
    assert MpccFile(file).mpcc().size == 2
    file.write_text(json.dumps(told | numbers | {"g_fun": functions[which].serialize()}))
    with pytest.raises(BadInput, match=r"scenario.path.*'g_fun' (contains|is compiled).*scenario.trust=true"):
        MpccFile(file).mpcc()
    with pytest.raises(BadInput, match="is no MPCC"):  # it was read, and does not fit
        MpccFile(file, trust=True).mpcc()


def test_a_cache_that_others_can_write_to_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    mine, shared = tmp_path / "mine", tmp_path / "shared"
    monkeypatch.setenv("BENCHBENCH_CACHE", str(mine))
    assert cache_root() == mine and private(mine)
    shared.mkdir()
    for mode in (0o777, 0o775, 0o1777):
        shared.chmod(mode)
        monkeypatch.setenv("BENCHBENCH_CACHE", str(shared))
        assert cache_root() != shared
    assert "somebody else" in caplog.text and "chmod 700" in caplog.text
    shared.chmod(0o700)
    assert cache_root() == shared
    if os.getuid() == 0:
        os.chown(shared, 12345, 12345)
        assert cache_root() != shared


def test_cells_are_no_formulas() -> None:
    texts = ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(1)", "\t=1", "a=b", "", None]
    table = pa.table({"reason": pa.array(texts, pa.string()), "n": pa.array([-1.0] * 8)})
    lines = csv(table).decode().splitlines()[1:]
    assert [line.rpartition(",")[0].strip('"') for line in lines] == [
        "'=1+1", "'+cmd|' /C calc'!A0", "'-2+3", "'@SUM(1)", "'\t=1", "a=b", "", "",
    ]  # fmt: skip
    assert all(line.endswith(",-1") for line in lines), "numbers stay numbers"
