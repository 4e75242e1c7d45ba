#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Searches the thresholds of [semantics] on labelled maps and on the maps of simulated runs.

search.py BUILD DATA TOURS --out OUT [--candidates N] [--seed S] [--jobs J]: TOURS is what bench.py left. Draws N settings from the ranges below
(number 0: config/modslam.toml as it is), annotates every map with each and scores it. GNU parallel spreads the jobs: over the cores of this
machine, or over those of MODSLAM_SSH (its sshlogin, e.g. ":,other"; all need the same folders). What is done stays in OUT and is not done again.
Prints how well the settings do that the other buildings chose, and writes OUT/best.json."""
import argparse
import json
import os
import pickle
import random
import shutil
import subprocess
import sys
import tempfile

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
HOUSE = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
sys.path.insert(0, HERE)
import maps  # noqa: E402

RANGES = {"opening_probability": (0.3, 0.7), "room_enclosed": (0.4, 0.8), "room_explored": (0.3, 0.7), "room_min_m2": (1.0, 2.5), "wall_min_m": (0.4, 1.0),
          "line_min_m": (0.3, 0.8), "door_max_m": (1.4, 2.0), "object_max_m2": (8.0, 20.0)}
FOLDS = 4


def draw(count, seed):
    """Number 0 is what is in force."""
    stream = random.Random(seed)
    return [{}] + [{k: round(stream.uniform(*r), 3) for k, r in RANGES.items()} for _ in range(count - 1)]


def prepare(args):
    """Every map with its truth as a file of its own; their names."""
    import train_openings  # slow to load: not for every job
    folder = os.path.join(args.out, "items")
    os.makedirs(folder, exist_ok=True)
    found = []
    if os.path.isdir(os.path.join(args.data, "maps")):
        found += maps.drawn_maps(args.data, args.out) + maps.robot_maps(args.data, args.out)
    for m in found + train_openings.tour_maps(args.tours):
        with open(os.path.join(folder, f"{m.name}.{m.kind}"), "wb") as f:
            pickle.dump({"map": m, "building": train_openings.building_of(m)}, f)
    return sorted(os.listdir(folder))


def value(scores):
    """One number for a map: the mean of what its truth can judge."""
    parts = [scores["rooms"]["f1"], scores["rooms"]["mean_iou"]]
    parts += [scores["doors"]["f1"]] if "doors" in scores else []
    parts += [scores["objects"]["balanced_accuracy"]] if "objects" in scores else []
    return float(np.mean(parts))


def one(args):
    """A job of its own process: says one line."""
    number, item = args.one
    with open(os.path.join(args.out, "items", item), "rb") as f:
        entry = pickle.load(f)
    m = entry["map"]
    sets = [w for k, v in draw(args.candidates, args.seed)[int(number)].items() for w in ("--set", f"semantics.{k}={v}")]
    with tempfile.TemporaryDirectory() as folder:
        for name in ("map.yaml", "map.png"):
            shutil.copy(os.path.join(m.folder, name), folder)
        m.folder = folder
        scores = maps.score(m, maps.annotate(m, os.path.join(args.build, "bin"), sets))
    print(json.dumps({"candidate": int(number), "item": item, "building": entry["building"], "value": value(scores), "rooms": scores["rooms"]["f1"]}))


def run_jobs(args, items):
    """Those that are not in the log yet; a line of GNU parallel's tells how far it is."""
    login = os.environ.get("MODSLAM_SSH")
    command = ["parallel", "--joblog", os.path.join(args.out, "jobs.log"), "--resume-failed", "--jobs", str(args.jobs), "--workdir", HOUSE]
    command += ["--bar"] if sys.stderr.isatty() else []
    command += ["--sshlogin", login] if login else []
    command += [sys.executable, os.path.abspath(__file__), args.build, args.data, args.tours, "--out", args.out, "--candidates", str(args.candidates),
                "--seed", str(args.seed), "--one", "{1}", "{2}", ":::", *map(str, range(args.candidates)), ":::", *items]
    print(f"{args.candidates} settings on {len(items)} maps; {args.out}/jobs.log grows by a line a job", flush=True)
    with open(os.path.join(args.out, "scores.jsonl"), "a") as lines:
        failed = subprocess.run(command, stdout=lines, check=False).returncode
    if failed:
        print(f"{failed} jobs failed; {args.out}/jobs.log names them", file=sys.stderr)


def read(args):
    """values[candidate][item], and the building of each item."""
    values, buildings = {}, {}
    with open(os.path.join(args.out, "scores.jsonl")) as f:
        for line in map(json.loads, f):
            values.setdefault(line["candidate"], {})[line["item"]] = line["value"]
            buildings[line["item"]] = line["building"]
    return values, buildings


def mean_on(values, candidate, items):
    return float(np.mean([values[candidate][i] for i in items]))


def judge(values, buildings):
    """The setting that the other buildings choose, on each fold of buildings; then the one that all choose."""
    items = sorted(set.intersection(*(set(v) for v in values.values())))
    names = sorted({buildings[i] for i in items})
    fold_of = {name: k % FOLDS for k, name in enumerate(names)}
    before, after = [], []
    for fold in range(FOLDS):
        held_out = [i for i in items if fold_of[buildings[i]] == fold]
        others = [i for i in items if fold_of[buildings[i]] != fold]
        if not held_out or not others:
            continue
        best = max(sorted(values), key=lambda c: mean_on(values, c, others))
        before += [values[0][i] for i in held_out]
        after += [values[best][i] for i in held_out]
        print(f"  fold {fold + 1}: {len(held_out)} maps, in force {mean_on(values, 0, held_out):.4f}, chosen by the others (number {best}) {mean_on(values, best, held_out):.4f}")
    best = max(sorted(values), key=lambda c: mean_on(values, c, items))
    return {"maps": len(items), "held_out_before": float(np.mean(before)), "held_out_after": float(np.mean(after)), "best": best,
            "all_before": mean_on(values, 0, items), "all_after": mean_on(values, best, items)}


def main():
    parser = argparse.ArgumentParser(description="Searches the thresholds of [semantics].")
    parser.add_argument("build")
    parser.add_argument("data")
    parser.add_argument("tours")
    parser.add_argument("--out", required=True)
    parser.add_argument("--candidates", type=int, default=24)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", default="100%")
    parser.add_argument("--one", nargs=2, metavar=("NUMBER", "ITEM"), help="score one setting on one map and say it")
    args = parser.parse_args()
    args.build, args.data, args.tours, args.out = (os.path.abspath(p) for p in (args.build, args.data, args.tours, args.out))
    if args.one:
        one(args)
        return
    args.out = os.path.join(args.out, f"seed{args.seed}-of{args.candidates}")  # jobs are known by their number
    items = prepare(args)
    if not items:
        sys.exit(f"{args.data}, {args.tours}: no maps to search on")
    run_jobs(args, items)
    result = judge(*read(args))
    settings = draw(args.candidates, args.seed)[result["best"]]
    print(f"Buildings held out: {result['held_out_before']:.4f} before, {result['held_out_after']:.4f} after; all: {result['all_before']:.4f}, {result['all_after']:.4f}")
    print("Best setting: " + (" ".join(f"--set semantics.{k}={v}" for k, v in settings.items()) or "the one in force"))
    with open(os.path.join(args.out, "best.json"), "w") as f:
        json.dump({**result, "settings": settings}, f, indent=1)


if __name__ == "__main__":
    main()
