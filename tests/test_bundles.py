"""Bundles: what is packed comes out again, what was changed is refused, and a plan counts only when it is certified anew."""

from __future__ import annotations

import hashlib
import json
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from program import assert_refused, records, told
from sharing import Once
from test_report import RUNS, report_on_a_sweep
from test_table import row

from benchbench.certificate.limits import Limits
from benchbench.run import judged
from benchbench.run.recertify import ours, recertify
from benchbench.storage.bundle import FORMAT, MANIFEST, opened
from benchbench.storage.configuration import configuration
from benchbench.storage.files import write_record
from benchbench.storage.runs import merge

Files = dict[str, bytes]


@pytest.fixture(scope="module")
def shared(once: Once, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the runs of the report's sweep and a bundle of them, `laptop.zip`."""
    folder = tmp_path_factory.mktemp("bundles")
    shutil.copytree(once("report", report_on_a_sweep) / "results", folder / "results")
    done = told(folder, "bundle", "results", "--output", "laptop.zip", "--machine", "laptop")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{RUNS} runs, ") and "of 'laptop' in laptop.zip" in done.stdout
    assert "broken/record.json" in done.stderr
    return folder


def contents(path: Path) -> Files:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def written(path: Path, files: Files) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)


def listed_anew(files: Files) -> Files:
    """As somebody would who changes runs and packs them again: the hashes are right."""
    manifest = json.loads(files[MANIFEST])
    manifest["files"] = {
        name: {"sha256": hashlib.sha256(data).hexdigest(), "bytes": len(data)}
        for name, data in files.items()
        if name != MANIFEST
    }
    return {**files, MANIFEST: json.dumps(manifest).encode()}


def table(folder: Path, *arguments: str) -> pd.DataFrame:
    done = told(folder, "table", *arguments, "--output", "runs.parquet", "--columns", "all")
    assert done.returncode == 0, done.stderr
    return pd.read_parquet(folder / "runs.parquet")


def test_what_is_packed_comes_out_again(shared: Path) -> None:
    own = {record["run_id"]: record for record in records(shared / "results" / "sweeps")}
    with opened(shared / "laptop.zip", lambda _: None) as bundle:
        back = {record["run_id"]: record for record in records(bundle.folder)}
        assert own.items() <= back.items() and back.keys() - own.keys() == {"crash"}
        plans = {path.read_bytes() for path in bundle.folder.rglob("plan.mcap")}
        assert plans == {path.read_bytes() for path in (shared / "results").rglob("plan.mcap")}
        manifest = bundle.manifest
        assert manifest.machine == "laptop" and manifest.format == FORMAT and manifest.runs == RUNS
        assert manifest.environment["packages"]["casadi"] and manifest.environment["platform"]
    assert not bundle.folder.exists()


def test_the_table_names_machines_and_whose_word_it_is(shared: Path) -> None:
    """Of two machines: a bundle, whose plans are judged again with the same outcome, and a folder."""
    server = shared / "server"
    write_record(server / "runs" / "a", row("a", cpu="Fast 1", cpu_count=8))
    found = table(shared, "laptop.zip", "server")
    assert found.machine.value_counts().to_dict() == {"laptop": RUNS, "Fast 1, 8 CPUs": 1}
    own = {r["run_id"]: (r["certified"], r["travel_time_s"]) for r in records(shared / "results" / "sweeps")}
    here = found[found.run_id.isin(own)]
    assert len(here) == RUNS - 1 and {c for c, _ in own.values()} == {True, False}
    assert {r.run_id: (r.certified, r.travel_time_s) for r in here.itertuples()} == own
    says = {True: "certified anew by the limits of 'task'", False: "refused where it was made"}
    assert all(r.certificate == says[own[r.run_id][0]] for r in here.itertuples())
    assert found[found.run_id == "crash"].certificate.item().startswith("as recorded there; there is no plan")
    assert found[found.run_id == "a"].certificate.item() == "own record"
    done = told(shared, "table", "laptop.zip")
    assert done.stdout.startswith("| machine | certificate | scenario |")
    refused = sum(not certified for certified, _ in own.values())
    assert (
        f"{RUNS} runs judged again: {RUNS - 1 - refused} certified anew here, {refused} refused where"
        in done.stderr
    )
    word = told(shared, "table", "laptop.zip", "--as-recorded", "--columns", "certificate", "--format", "csv")
    assert {*word.stdout.split("\n")[1:-1]} == {'"as recorded there"'} and word.stderr == ""


def test_no_word_of_a_bundle_is_believed(shared: Path, tmp_path: Path) -> None:
    """Somebody calls a refused plan certified and faster than it is, loosens its limits, and packs it again."""
    files = contents(shared / "laptop.zip")
    name, record = next(
        (name, record)
        for name, data in files.items()
        if name.endswith("record.json") and (record := json.loads(data))["status"] == "uncertified"
    )
    config = name.replace("record.json", "config.yaml")
    lie = {"certified": True, "status": "certified", "reasons": [], "travel_time_s": 0.1}
    files[name] = json.dumps({**record, **lie}).encode()
    loose = (
        files[config]
        .replace(b"rate_ratio: 1.05", b"rate_ratio: 99.0")
        .replace(b"defect_position: 0.005", b"defect_position: 9.0")
    )
    assert loose != files[config]
    files[config] = loose
    written(tmp_path / "lie.zip", listed_anew(files))
    found = table(tmp_path, "lie.zip").set_index("run_id").loc[record["run_id"]]
    assert not found.certified and found.status == "uncertified" and list(found.reasons) == record["reasons"]
    assert found.travel_time_s == record["travel_time_s"]
    assert (
        "refused anew by the limits of 'task', instead of its own defect_position, rate_ratio"
        in found.certificate
    )


def test_limits_are_ours_whatever_comes_with_a_plan(shared: Path) -> None:
    folder = next(path.parent for path in (shared / "results" / "sweeps").rglob("plan.mcap"))
    tree = (configuration(folder) or {})["certificate"]
    assert ours(tree, Limits)[0] == "task" and ours(tree, Limits)[2] == ()
    assert ours({**tree, "node": 1.0}, Limits)[2] == ("node",)
    race = {**tree, "gate_position": 0.01, "defect_position": 1e-3, "defect_angle": 1e-2, "rate_ratio": 1.01}
    assert ours(race, Limits)[0] == "race"


def test_what_cannot_be_judged_is_said_not_raised(shared: Path, tmp_path: Path) -> None:
    assert recertify(None).certified is None
    folder = next(path.parent for path in (shared / "results" / "sweeps").rglob("plan.mcap"))
    broken = Path(shutil.copytree(folder, tmp_path / "run"))
    text = (broken / "config.yaml").read_text()
    for evil, says in (
        (text.replace("benchbench_plugins.models.aerial_manipulator.AerialManipulator", "os.system"), "installed plugin"),
        ("a: 1", "cannot be certified here"), ("- 1", "configuration is missing"),
    ):  # fmt: skip
        assert evil != text
        (broken / "config.yaml").write_text(evil)
        shutil.rmtree(broken / ".hydra", ignore_errors=True)
        found = recertify(broken)
        assert found.certified is None and says in found.said
    (broken / "config.yaml").write_text(text)
    (broken / "plan.mcap").write_bytes(b"none")
    assert "cannot be certified here" in recertify(broken).said


def test_what_was_judged_here_before_is_remembered_until_anything_changes(
    shared: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = next(path.parent for path in (shared / "results" / "sweeps").rglob("plan.mcap"))
    monkeypatch.setattr(judged, "_place", lambda: tmp_path / "judged.jsonl")
    first = recertify(folder)

    def fails(*_: object) -> None:
        raise ValueError("judged again")

    monkeypatch.setattr("benchbench.run.recertify.certify", fails)
    assert first.certified is not None and recertify(folder) == first
    judged._kept.cache_clear()  # as another process, from the file
    with (tmp_path / "judged.jsonl").open("a") as file:
        file.write('["cut')
    assert recertify(folder) == first
    other = Path(shutil.copytree(folder, tmp_path / "run"))
    config = (other / "config.yaml").read_text()
    (other / "config.yaml").write_text(config.replace("- 0.4\n", "- 0.41\n"))
    assert config != (other / "config.yaml").read_text() and "judged again" in recertify(other).said
    (other / "config.yaml").write_text(config)
    (other / "plan.mcap").write_bytes((folder / "plan.mcap").read_bytes() + b"x")
    assert recertify(other).certified is None
    judged._kept.cache_clear()


def test_solutions_are_judged_again_and_evaluated(tmp_path: Path) -> None:
    """A lie about the objective, then about the unknowns; a problem whose file may do anything is not read."""
    assert (
        told(tmp_path, "-m", "+scenario=double_integrator", "scenario.intervals=4,6", "workers=1").returncode
        == 0
    )
    assert told(tmp_path, "bundle", "results", "--output", "honest.zip").returncode == 0
    files = contents(tmp_path / "honest.zip")
    names = [name for name in sorted(files) if name.endswith("record.json")]
    for name in names:
        files[name] = json.dumps({**json.loads(files[name]), "objective": 0.5}).encode()
    solution = names[1].replace("record", "solution")
    files[solution] = json.dumps(
        {"w": [[0.9 * x for x in row] for row in json.loads(files[solution])["w"]]}
    ).encode()
    written(tmp_path / "lie.zip", listed_anew(files))
    found = table(tmp_path, "lie.zip").sort_values("certified", ascending=False)
    assert found.certified.tolist() == [True, False] and found.certificate.tolist() == [
        "certified anew by the limits of 'mpcc'", "refused anew by the limits of 'mpcc'",
    ]  # fmt: skip
    assert (
        found.objective.tolist()[0] == pytest.approx(2.0)
        and "original problem" in found.reasons.tolist()[1][0]
    )
    done = told(tmp_path, "report", "lie.zip", "--leaderboard")
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "leaderboard.html").read_text()
    assert page.count('class="best"') == 1 and "objective" in page
    (shown,) = (tmp_path / "leaderboard_plans").iterdir()
    assert shown.suffix == ".json" and shown.name in page


def test_a_stored_problem_is_read_only_where_nothing_can_happen(tmp_path: Path) -> None:
    target = "benchbench_plugins.collections.nosbench.MpccFile"
    (tmp_path / "solution.json").write_text('{"w": [[1.0]]}')
    for scenario, says in (
        (f"{{_target_: {target}, path: p.json, trust: true}}", "scenario.trust: stands in a stored configuration"),
        (f"{{_target_: {target}, path: /nowhere/p.json}}", "there is no such file"), ("{_target_: os.system}", "installed plugin"),
    ):  # fmt: skip
        (tmp_path / "config.yaml").write_text(f"scenario: {scenario}\ncertificate: {{residual: 1.0}}\n")
        found = recertify(tmp_path)
        assert found.certified is None and says in found.said


def grown(files: Files) -> Files:
    """A hostile archive: a file of a gigabyte, a thousandth as large when packed."""
    manifest = json.loads(files[MANIFEST])
    manifest["files"]["runs/00000/record.json"]["bytes"] = 1 << 40
    return {**files, MANIFEST: json.dumps(manifest).encode()}


def changed(name: str, **values: Any) -> Callable[[Files], Files]:
    def change(files: Files) -> Files:
        return {**files, name: json.dumps({**json.loads(files[name]), **values}).encode()}

    return change


PLAN = "runs/00001/plan.mcap"
DAMAGE: dict[str, tuple[Callable[[Files], Files], str]] = {
    "hash": (lambda f: {**f, PLAN: f[PLAN][:-1] + b"x"}, f"'{PLAN}' is not what was bundled"),
    "longer": (lambda f: {**f, PLAN: f[PLAN] + b"x"}, f"'{PLAN}' is not what was bundled"),
    "lost": (lambda f: {n: d for n, d in f.items() if n != PLAN}, f"'{PLAN}' is missing"),
    "more": (lambda f: {**f, "runs/00099/record.json": b"{}"}, "not in its list"),
    "foreign": (lambda _: {"hello.txt": b"hello"}, f"has no {MANIFEST}"),
    "other": (lambda f: {**f, "runs/00000/.bashrc": b""}, "no file of a run"),
    "up": (lambda f: listed_anew({**f, "runs/../../evil": b"x"}), "leaves its folder"),
    "root": (lambda f: listed_anew({**f, "/etc/evil": b"x"}), "leaves its folder"),
    "windows": (lambda f: listed_anew({**f, "C:\\evil": b"x"}), "leaves its folder"),
    "said up": (changed(MANIFEST, files={"../evil": {"sha256": "0" * 64, "bytes": 1}}), "leaves its folder"),
    "newer": (changed(MANIFEST, version=99), "version 99"),
    "kind": (changed(MANIFEST, format="other"), "'other'"),
    "no list": (lambda f: {**f, MANIFEST: b"[]"}, "valid dictionary"),
    "half a list": (lambda f: {**f, MANIFEST: f[MANIFEST][:50]}, "no bundle, or cut off"),
    "field": (changed(MANIFEST, runs="many"), "runs"),
    "bomb": (grown, "times its own size"),
}  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_bundle_that_was_changed_is_one_clear_message(damage: str, shared: Path, tmp_path: Path) -> None:
    change, says = DAMAGE[damage]
    written(tmp_path / "b.zip", change(contents(shared / "laptop.zip")))
    before = {*tmp_path.parent.iterdir()}
    done = told(tmp_path, "table", "b.zip")
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.startswith("benchbench: bad input\n  b.zip") and done.stderr.count("\n") == 2
    assert says in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["b.zip"] and before == {*tmp_path.parent.iterdir()}


@pytest.mark.parametrize("part", [0.0, 0.3, 0.999])
def test_a_bundle_that_is_cut_off_is_refused(part: float, shared: Path, tmp_path: Path) -> None:
    data = (shared / "laptop.zip").read_bytes()
    (tmp_path / "cut.zip").write_bytes(data[: int(part * len(data))])
    assert_refused(told(tmp_path, "report", "cut.zip"), "cut.zip", "cut off")


@pytest.mark.parametrize(
    ("arguments", "field", "says"),
    [
        (("bundle", "nowhere"), "nowhere", "no such folder"), (("bundle", "empty"), "empty", "no run was found"),
        (("bundle", "results", "--output", "a.tar"), "--output", ".zip"), (("table", "gone.zip"), "gone.zip", "no such file"),
        (("report", "laptop.zip", "--leaderboard", "--as-recorded"), "--as-recorded", "believes no record"),
    ],
)  # fmt: skip
def test_bad_calls(arguments: tuple[str, ...], field: str, says: str, shared: Path) -> None:
    (shared / "empty").mkdir(exist_ok=True)
    assert_refused(told(shared, *arguments), field, says)


def test_merged_runs_can_be_read(tmp_path: Path) -> None:
    """Numbers by name stay what they are."""
    write_record(tmp_path / "other" / "runs" / "a", row("a", contact_gaps={"position": 0.01}))
    (place,) = merge(tmp_path / "all", [tmp_path / "other"])
    assert records(place)[0]["contact_gaps"] == {"position": 0.01}
