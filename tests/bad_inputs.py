"""Bad inputs of every command: the command line and the field that its one message names; `{d}` is a folder with these files."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

SCENARIOS = (
    "block_move, braking, cart_pole, circle, delivery, detour, double_integrator, "
    "first_robot, goddard, hardware_circle, hardware_circle_23, hardware_static, linear, mpcc_file, "
    "obstacle_car, pympcc, quadrotor_flip, race, random_delivery, random_handover, random_hardware, "
    "random_race, robot_arm, static, steering, transfer, turning, two_free, zermelo"
)
"""What a message lists."""

FLIGHT = "t,p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x,v_y,v_z,w_x,w_y,w_z,u_1,u_2,u_3,u_4"
STILL = ["0,0,1,1,0,0,0,0,0,0,0,0,0,4,4,4,4", "0,0,1,1,0,0,0,0,0,0,0,0,0,4,4,4,4"]


def files(folder: Path) -> None:
    """Write what the command lines name."""
    plan = "\n".join([FLIGHT, f"0,{STILL[0]}", f"1,{STILL[1]}"])
    texts = {
        "broken.json": "{", "deep.json": "[" * 100_000, "list.json": "[1]", "empty.json": "", "wrong.json": '{"w0": "x"}',
        "number.json": "9" * 5000, "gates.csv": "a,b\n1,2\n", "empty.csv": "", "nan.csv": "x,y,z\n1,nan,2\n",
        "short.csv": "x,y,z\n1,2\n", "none.yaml": "gates: 3\n", "deep.yaml": "[" * 100_000, "loop.yaml": "lap: &a [*a]\n",
        "tag.yaml": "lap: !!bool x\n", "huge.yaml": f"lap: [[{'9' * 400}, 0, 1]]\n", "many.yaml": "gates: 1000000\nlap: [[1,0,1]]\n",
        "colour.yaml": "lap: [[1,0,1]]\ncolour: red\n", "text.yaml": "hello\n", "path.csv": "t,x,y,z\n0,0,0,0\n",
        "back.csv": "t,x,y,z\n0,0,0,0\n2,0,0,0\n1,0,0,0\n", "words.csv": "t,x,y,z\na,b,c,d\n",
        "plan.csv": plan, "late.csv": plan.replace("\n0,", "\n0.5,"), "twice.csv": f"{plan}".replace("p_y", "p_x"),
        "half.csv": "\n".join(plan.splitlines()[:2]), "long.csv": plan + ",1,2", "column.csv": plan.replace("u_4", "u_5"),
        "turned.csv": plan.replace(",1,0,0,0,0", ",1,1,0,0,0"), "cell.csv": plan.replace("4,4", "4,x"),
        "note.mcap": "not a recording", "space.yaml": "space: {}\n", "odd.yaml": "space: {a: 1}\nsweet: 1\n",
        "tune.yaml": "space:\n  scenario.intervals: range(4,8)\nn_trials: 0\n", "bad.yaml": "a: [\n",
        "best.yaml": "- 1\n", "suite.yaml": "title: x\n",
    }  # fmt: skip
    for name, text in texts.items():
        (folder / name).write_text(text)
    (folder / "latin.csv").write_bytes(b"x,y,z\n\xff\xfe,1,2\n")
    (folder / "latin_plan.csv").write_bytes(b"t,\xff\n")
    (folder / "cut.json.gz").write_bytes(gzip.compress(b"{}" * 100)[:20])
    (folder / "file").write_text("")
    (folder / "nothing").mkdir()
    (folder / "broken" / "runs" / "a").mkdir(parents=True)
    (folder / "broken" / "runs" / "a" / "record.json").write_text("{")
    (folder / "plans").mkdir()
    (folder / "plans" / "plan.mcap").write_text("")
    (folder / "base").mkdir()
    (folder / "base" / "matrix.yaml").write_text("cases: {}\n")
    (folder / "base" / "baseline.json").write_text(json.dumps({}))


S, R, M = "+scenario=static", "+scenario=race", "+scenario=mpcc_file"
PATH = f"{S} ~scenario.target.position_m scenario.target._target_=benchbench_plugins.motions.Spline +scenario.target.csv"
RUNS = (
    (f"{S} scenario.intervals=1e9", "scenario.intervals"), (f"{S} scenario.intervals=99999999999999999999", "scenario.intervals"),
    (f"{S} scenario.intervals=-1", "scenario.intervals"), (f"{S} scenario.kappa_init=1000000", "scenario.kappa_init"),
    (f"{S} seed=1e30", "seed"), (f"{S} output=[a,b]", "output"), (f"{S} output=", "output"), (f"{S} output={{d}}/file", "output"),
    (f"{S} workers=1000000", "workers"), (f"{S} repeats=1000000000", "repeats"), (f"{S} --nonsense", "--nonsense"),
    (f"{S} guess=previous guess.path={{d}}/nothing", "guess.path"), (f"{S} strategy=multistart strategy.starts=1e12", "strategy.starts"),
    (f"{S} strategy=refine strategy.finest=1e9", "strategy.finest"), (f"{S} scenario.name=[", "'scenario.name=['"),
    (f"{S} strategy=peer", "peer"), (f"{S} peer=togt", "peer"), (f"{S} --config-dir {{d}}/nowhere", "--config-dir"), ("", "scenario"),
    (f"{R} scenario.gates=100000", "scenario.gates"), (f"{R} scenario.nodes_per_gate=1000000", "scenario.nodes_per_gate"),
    (f"{R} scenario.gates=2000 scenario.nodes_per_gate=2000", "scenario.nodes_per_gate"),
    *((f"{R} scenario.track={{d}}/{name}", "scenario.track") for name in (
        "gates.csv", "empty.csv", "nan.csv", "short.csv", "none.yaml", "deep.yaml", "loop.yaml", "tag.yaml", "huge.yaml",
        "colour.yaml", "text.yaml", "latin.csv", "nowhere.csv", "nothing", "file",
    )), (f"{R} scenario.track=/dev/zero", "scenario.track"), (f"{R} scenario.track={{d}}/many.yaml", "scenario.gates"),
    *((f"{M} scenario.path={{d}}/{name}", "scenario.path") for name in (
        "broken.json", "deep.json", "list.json", "empty.json", "wrong.json", "number.json", "cut.json.gz", "nowhere.json", "nothing",
    )), (f"{M} scenario.path=/dev/zero", "scenario.path"),
    *((f"{PATH}={{d}}/{name}", "scenario.target.csv") for name in (
        "path.csv", "back.csv", "words.csv", "gates.csv", "empty.csv", "latin.csv", "nowhere.csv",
    )), (f"{PATH}=/dev/zero", "scenario.target.csv"),
)  # fmt: skip
SWEEPS = (
    (f"-m {S} seed=range(1,0)", "seed"), (f"-m {S} seed=range(0,1000000000)", "seed"), (f"-m {S} seed=range(0,2000) time_limit=range(1,2000)", "time_limit"),
    (f"-m {S} output=[a,b]", "output"), (f"-m {S},triangle", "scenario"), (f"-m {S} hydra/launcher=dask", "hydra.launcher.scheduler"),
    (f"-m {S} hydra/sweeper=optuna", "hydra.sweeper"), (f"-m {S} hydra/sweeper=optuna scenario.intervals=range(5,4)", "scenario.intervals"),
    (f"-m {S} hydra/sweeper=optuna scenario.intervals=4,5 hydra.sweeper.n_trials=0", "hydra.sweeper.n_trials"),
    (f"-m {S} hydra/sweeper=optuna scenario.intervals=4,5 hydra.sweeper.objectives=[beauty]", "hydra.sweeper.objectives"),
    (f"-m {S} hydra.sweeper.max_batch_size=0 seed=1,2", "hydra.sweeper.max_batch_size"),
)  # fmt: skip
CERTIFY = (
    ("certify", "plan"), ("certify {d}/nowhere.csv --scenario static", "{d}/nowhere.csv"), ("certify {d}/plan.csv", "--scenario"),
    ("certify {d}/plan.csv --scenario triangle", "scenario"), ("certify {d}/plan.csv --scenario static +scenario=circle", "--scenario"),
    ("certify {d}/plan.csv --scenario static --interpolation cubic", "benchbench certify"),
    *((f"certify {{d}}/{name} --scenario static", f"{{d}}/{name}") for name in (
        "late.csv", "twice.csv", "half.csv", "long.csv", "column.csv", "turned.csv", "cell.csv", "latin_plan.csv", "empty.csv", "note.mcap",
    )),
)  # fmt: skip
OTHERS = (
    ("table {d}/nowhere", "{d}/nowhere"), ("table {d}/nothing --columns beauty", "--columns beauty"), ("table {d}/nothing --query selekt", "--query"),
    ("table {d}/nothing --output x.doc", "output"), ("table {d}/nothing --format xml", "benchbench table"),
    ("table {d}/nothing --output {d}/nothing/", "output"),
    ("table {d}/file", "{d}/file"), ("report {d}/nowhere", "{d}/nowhere"), ("report {d}/nothing", "{d}/nothing"), ("report {d}/nothing --plans -1", "--plans"),
    ("report {d}/nothing --rows x", "benchbench report"), ("report", "benchbench report"), ("best {d}/nothing", "{d}/nothing"),
    ("best {d}/nowhere", "{d}/nowhere"), ("best {d}/nothing --file {d}/best.yaml", "{d}/best.yaml"), ("best {d}/nothing --file {d}/bad.yaml", "{d}/bad.yaml"),
    ("draw", "benchbench draw"), ("draw {d}/nowhere", "{d}/nowhere"), ("draw {d}/nothing", "{d}/nothing"), ("draw {d}/plans", "{d}/plans"),
    ("export {d}/nothing --output x.csv", "{d}/nothing"), ("export {d}/nowhere --output x.csv", "{d}/nowhere"),
    ("export {d}/plans --output x.csv", "{d}/plans/plan.mcap"),
    ("export {d}/note.mcap --output x.csv", "{d}/note.mcap"), ("export {d}/plans --output x.doc", "--output"), ("export {d}/plans", "benchbench export"),
    ("export {d}/plans --output {d}/plans/plan.mcap", "--output"), ("runs {d}/nowhere", "{d}/nowhere"), ("runs {d}/nothing --remove x", "x"),
    ("runs {d}/nothing --status fine", "--status"), ("runs {d}/nothing --merge {d}/nowhere", "{d}/nowhere"), ("regress --baseline {d}/nowhere", "--baseline"),
    ("regress --baseline {d}/base", "{d}/base/matrix.yaml"), ("regress --baseline {d}/nothing", "--baseline"), ("suite nowhere", "suite"),
    ("suite {d}/suite.yaml", "{d}/suite.yaml"), ("suite {d}/bad.yaml", "{d}/bad.yaml"),
    ("tune {d}/nowhere.yaml", "{d}/nowhere.yaml"), ("tune {d}/bad.yaml", "{d}/bad.yaml"), ("tune {d}/space.yaml", "{d}/space.yaml: space"),
    ("tune {d}/odd.yaml", "{d}/odd.yaml: sweet"), ("tune {d}/tune.yaml +scenario=static", "hydra.sweeper.n_trials"), ("tune {d}/nothing", "{d}/nothing"),
    ("tune {d}/deep.yaml", "{d}/deep.yaml"), ("collection {d}/nothing", "{d}/nothing"), ("collection {d}/nowhere", "{d}/nowhere"),
    ("bundle", "benchbench bundle"), ("bundle {d}/nothing", "{d}/nothing"), ("table {d}/file", "{d}/file"),
    ("report {d}/broken.json --leaderboard", "{d}/broken.json"),
    ("plugins nonsense", "plugins"), ("robust", "scenario"), ("robust +scenario=circle flights=0", "flights"),
    ("robust +scenario=circle flights=-2", "flights"),
    ("robust +scenario=race", "scenario"), ("robust +scenario=pympcc", "scenario"), ("robust +scenario=circle target_success=2", "target_success"),
    ("show", "benchbench show"), ("show {d}/nowhere", "{d}/nowhere"), ("show {d}/nothing", "{d}/nothing"),
    ("draw {d}/plans --output x.doc", "--output"),
    ("draw {d}/plans {d}/plans --output x.pdf", "--output"), ("draw {d}/plans --fps 0", "--fps"), ("compare {d}/nothing", "benchbench compare"),
    ("compare {d}/nothing {d}/nowhere", "{d}/nowhere"), ("compare {d}/nothing {d}/nothing", "{d}/nothing"),
    ("compare {d}/nothing {d}/nothing --output x.doc", "--output"),
    ("tabel", "tabel"), ("completion", "benchbench completion"), ("completion csh", "benchbench completion"),
)  # fmt: skip
