"""Tries patches on logs that the diagnosis never saw, and prints the page.

    python tests/second_flight.py AIRBALL FOLDER      the folder that `scripts/second-flight` filled

Each rig of kind `outside` is diagnosed as it is; each of kind `single` with its own effect left out of the search. The patch is
tried on the second flight of the same rig:

    share = (E² of the belief − E² with the patch) / (E² of the belief − F²)     E, F: error at 1 s, and by noise alone, mm

F is that of the patched model, at most its error. A rig whose belief errs by less than 5 % more than noise alone has no gap, and
no share. The last row leaves out effects of time, of chance and of the scatter.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

WORSE = 1.02  # a patch whose error at 1 s is larger by more than 2 % counts as harm; chosen, not derived
NO_GAP = 1.05  # ratio of the believed error to that by noise alone: a misfit below 5 % of the floor is no gap, as in `diagnose`


# Effects that depend on time or on chance, and those that change the scatter of the readings and not the path.
NOT_OF_THE_STATE = {
    "gusts", "late_writes", "limit_cycle", "mount_slip", "stuck_driver", "supply_ripple",
    "gain_drift", "hover_drift", "sensor_noise", "sensor_outliers", "sensor_quantisation", "stale_samples", "turbulence",
}  # fmt: skip

ONE_THREAD = os.environ | {"RAYON_NUM_THREADS": "1"}


def run(*command):
    command = [str(part) for part in command]
    return subprocess.run(command, check=True, capture_output=True, text=True, env=ONE_THREAD).stdout


def tried(airball, folder, kind, case):
    """The diagnosis of the first flight, and the errors at 1 s on the second one."""
    name, effect = case["case"], case["effects"][0]["name"]
    files = [(0, "toml"), (0, "csv"), (1, "csv")]
    config, first, second = (folder / f"{kind}-{flight}" / f"{name}.{end}" for flight, end in files)
    without = ["--without", effect] if kind == "single" else []
    answer = run_diagnosis(airball, config, first, without)
    replay = ["replay", "--config", config, "--json", second]
    believed = json.loads(run(airball, *replay))
    if not answer.get("config_patch"):
        return row(kind, name, effect, answer, believed, believed)
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as patch:
        patch.write(answer["config_patch"])
        patch.flush()
        return row(kind, name, effect, answer, believed, json.loads(run(airball, *replay, "--patch", patch.name)))


def run_diagnosis(airball, config, log, without):
    """The diagnosis; one that cannot answer ends with status 3 and has no patch."""
    command = [str(part) for part in [airball, "diagnose", "--config", config, "--json", *without, log]]
    done = subprocess.run(command, capture_output=True, text=True, env=ONE_THREAD)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{' '.join(command)}: {done.stderr}")
    return json.loads(done.stdout)


def row(kind, name, effect, answer, believed, patched):
    before, after = believed["error_mm"][2], patched["error_mm"][2]
    floor = min(patched["floor_mm"][2], after)
    has_gap = before > NO_GAP * floor
    closed = (answer["gap"].get("closed") or {}).get("value")
    return {
        "kind": kind,
        "case": name,
        "effect": effect,
        "verdict": answer["verdict"],
        "named": " ".join(one["name"] for one in answer["effects"]),
        "formula": sum(step["step"] == "formula" for step in answer["ladder"]),
        "before": before,
        "after": after,
        "floor": floor,
        "share": (before**2 - after**2) / (before**2 - floor**2) if has_gap else None,
        "claimed": closed,
        "worse": after > WORSE * before,
    }


def summary(what, rows):
    shares = [one["share"] for one in rows if one["share"] is not None]
    off = [abs(one["share"] - one["claimed"]) for one in rows if one["share"] is not None and one["claimed"] is not None]
    median = f"{statistics.median(shares):.2f}" if shares else "–"
    wrong = f"{statistics.median(off):.3f}" if off else "–"
    return f"| {what} | {len(rows)} | {len(shares)} | {median} | {wrong} | {sum(one['worse'] for one in rows)} |"


def page(rows):
    of = {kind: [one for one in rows if one["kind"] == kind] for kind in ("outside", "single")}
    print("# Proof on a second flight\n")
    print("Made by `scripts/second-flight`; do not edit. Rigs are drawn by `world`; `outside` rigs have an effect that the catalogue lacks, and")
    print("for `left out` ones their effect is left out of the search. `shapes` is the number of terms of the formula. A rig is diagnosed from one log, and its patch is tried on a second log")
    print("with other setpoints and noise. Share: of the mean square error at 1 s beyond noise alone, what the patch closes on the second log.")
    print("The last row leaves out effects that depend on time or on chance, and those that change the scatter of the readings and not the path.\n")
    print("| rigs | number | with a gap | median share closed | median distance from the claimed share | worse by over 2 % |")
    print("|------|--------|------------|---------------------|----------------------------------------|-------------------|")
    print(summary("outside", of["outside"]))
    print(summary("left out", of["single"]))
    print(summary("both", rows))
    print(summary("both, where the path follows from the state", [one for one in rows if one["effect"] not in NOT_OF_THE_STATE]))
    print("\n| kind | effect | verdict | named | shapes | believed, mm | patched, mm | noise, mm | share | claimed |")
    print("|------|--------|---------|-------|--------|--------------|-------------|-----------|-------|---------|")
    for one in rows:
        number = lambda value: "–" if value is None else f"{value:.2f}"
        cells = [one["kind"], one["effect"], one["verdict"], one["named"], str(one["formula"])]
        cells += [number(one[key]) for key in ("before", "after", "floor", "share", "claimed")]
        print("| " + " | ".join(cells) + " |")


def main(airball, folder):
    folder, jobs = Path(folder), []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for kind in ("outside", "single"):
            cases = json.loads((folder / f"{kind}.json").read_text())["cases"]
            jobs += [pool.submit(tried, airball, folder, kind, case) for case in cases]
    page([job.result() for job in jobs])


if __name__ == "__main__":
    main(*sys.argv[1:])
