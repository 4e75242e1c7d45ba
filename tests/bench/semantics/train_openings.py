#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Learns how sure an opening parts two rooms (common/semantics/opening_trees.inc) from labelled maps and tours.

train_openings.py BUILD DATA OUT [--held-out]: OUT is what bench.py left (it drives the tours). Prints how well openings of each building are
told when the building is held out, then trains on all and writes the trees; build again afterwards. --held-out also builds `annotate` once per
building and scores the rooms of the maps it was not trained on."""
import argparse
import json
import math
import os
import subprocess
import sys

import numpy as np
from sklearn.ensemble import GradientBoostingClassifier
from sklearn.metrics import average_precision_score

HERE = os.path.dirname(os.path.abspath(__file__))
HOUSE = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
TREES = os.path.join(HOUSE, "common", "semantics", "opening_trees.inc")
sys.path.insert(0, HERE)
import maps  # noqa: E402

NUMBER_OF_TREES, DEPTH, RATE, SHARE, LEAST_LEAF, SEED = 60, 3, 0.15, 0.7, 25, 1


def building_of(m):
    """Maps of one building are held out together."""
    name = m.name
    for start in ("SKF", "Valleceppi", "battle_creekhs", "saarbruecken"):
        if name.startswith(start):
            return start if start != "saarbruecken" else start + ("A" if name[-1] in "12" else "B")
    return name


def tour_maps(out):
    """The map of each tour with the true rooms in its frame: the robot's first pose is the origin."""
    found = []
    folder = os.path.join(out, "tours")
    for name in sorted(os.listdir(folder)) if os.path.isdir(folder) else []:
        result = os.path.join(folder, name, "ground_truth")
        if not os.path.exists(os.path.join(result, "map.yaml")):
            continue
        with open(os.path.join(folder, name, "world.geojson")) as f:
            features = json.load(f)["features"]
        start = next(f for f in features if f["properties"]["kind"] == "start")
        heading = start["properties"]["heading"]
        turn = np.array([[math.cos(heading), math.sin(heading)], [-math.sin(heading), math.cos(heading)]])
        in_map = lambda ring: (np.array(ring, float) - start["geometry"]["coordinates"]) @ turn.T
        rooms = [[in_map(ring) for ring in f["geometry"]["coordinates"]] for f in features if f["properties"]["kind"] == "room"]
        doors = [in_map(f["geometry"]["coordinates"]).mean(axis=0) for f in features if f["properties"]["kind"] == "door"]
        points = np.vstack([r[0] for r in rooms])
        origin = points.min(axis=0) - 2
        size = np.ceil((points.max(axis=0) + 2 - origin) / maps.CELL_M).astype(int)
        m = maps.Map(name, "tour", result, np.zeros((size[1], size[0]), np.int32), origin, np.array(doors).reshape(-1, 2))
        for k, rings in enumerate(rooms):
            mask = np.zeros(m.labels.shape, np.uint8)
            m.fill(mask, rings, 1)
            m.labels[mask > 0] = k + 1
        found.append(m)
    return found


def label(m, openings):
    """1: parts two rooms, 0: does not, -1: the truth does not tell."""
    def rooms_at(points):
        c = m.cells(points)
        ok = (c >= 0).all(axis=1) & (c[:, 0] < m.labels.shape[1]) & (c[:, 1] < m.labels.shape[0])
        out = np.zeros(len(points), int)
        out[ok] = m.labels[c[ok, 1], c[ok, 0]]
        return out
    labels = np.full(len(openings), -1)
    for i, row in enumerate(openings):
        a, b = row[0:2], row[2:4]
        along = (b - a) / max(1e-9, np.linalg.norm(b - a))
        across = np.array([-along[1], along[0]])
        points = a + np.linspace(0.15, 0.85, 8)[:, None] * (b - a)
        parted, same = 0.0, 0.0
        for off in (0.15, 0.25, 0.4):
            left, right = rooms_at(points + off * across), rooms_at(points - off * across)
            parted = max(parted, np.mean((left != right) & (left > 0) & (right > 0)))
            same = max(same, np.mean((left == right) & (left > 0)))
        if parted >= 0.6:
            labels[i] = 1
        elif parted < 0.35 and same > 0.5:
            labels[i] = 0
        if len(m.doors) and 0.6 < np.linalg.norm(b - a) < 1.6 and np.linalg.norm(m.doors - (a + b) / 2, axis=1).min() < 0.35:
            labels[i] = 1
    return labels


def load(m, binary):
    maps.annotate(m, binary, ["--openings"])
    rows = np.loadtxt(os.path.join(m.folder, "out", "openings.csv"), delimiter=",", ndmin=2)
    labels = label(m, rows)
    known = labels >= 0
    return {"map": m, "building": building_of(m), "x": rows[known, 5:], "y": labels[known]}


def fit(sets):
    """Every map weighs as the root of its number of openings."""
    weights = np.concatenate([np.full(len(s["y"]), 1 / math.sqrt(max(1, len(s["y"])))) for s in sets])
    model = GradientBoostingClassifier(n_estimators=NUMBER_OF_TREES, max_depth=DEPTH, learning_rate=RATE, subsample=SHARE, min_samples_leaf=LEAST_LEAF,
                                       random_state=SEED)
    return model.fit(np.vstack([s["x"] for s in sets]), np.concatenate([s["y"] for s in sets]), sample_weight=weights / weights.mean())


def write_trees(model):
    def number(v):
        text = f"{v:.5g}"
        return text + ("f" if "." in text or "e" in text else ".0f")
    nodes, roots = [], []
    for tree in model.estimators_[:, 0]:
        t, base = tree.tree_, len(nodes)
        roots.append(base)
        for i in range(t.node_count):
            leaf = t.children_left[i] < 0
            nodes.append((-1, 0, 0, 0, model.learning_rate * t.value[i][0][0]) if leaf else
                         (t.feature[i], t.threshold[i], base + t.children_left[i], base + t.children_right[i], 0))
    share = model.init_.class_prior_[1]
    with open(TREES, "w") as f:
        f.write("// SPDX-License-Identifier: BSD-3-Clause\n// Made by ./run.sh train semantics; see opening_model.hpp.\n// clang-format off\n")
        f.write(f"constexpr double kBias = {math.log(share / (1 - share)):.5f};\nconstexpr int kRoots[] = {{{', '.join(map(str, roots))}}};\n")
        f.write("constexpr Node kNodes[] = {\n")
        for k in range(0, len(nodes), 4):
            f.write("  " + " ".join(f"{{{a}, {number(b)}, {c}, {d}, {number(v)}}}," for a, b, c, d, v in nodes[k:k + 4]) + "\n")
        f.write("};\n// clang-format on\n")


def build_annotate(build):
    subprocess.run(["ninja", "-C", build, "modslam-annotate"], check=True, stdout=subprocess.DEVNULL)


def main():
    parser = argparse.ArgumentParser(description="Learns the trees that judge openings.")
    parser.add_argument("build")
    parser.add_argument("data")
    parser.add_argument("out")
    parser.add_argument("--held-out", action="store_true", help="also score the rooms of each building with trees that never saw it")
    args = parser.parse_args()
    binary = os.path.join(os.path.abspath(args.build), "bin")
    sets = [load(m, binary) for m in maps.drawn_maps(args.data, args.out) + maps.robot_maps(args.data, args.out) + tour_maps(args.out)]
    print("Openings of buildings that were held out: average precision, and precision and recall at one half")
    scores, figures = {}, []
    for building in sorted({s["building"] for s in sets}):
        model = fit([s for s in sets if s["building"] != building])
        if args.held_out:
            write_trees(model)
            build_annotate(args.build)
        for s in (s for s in sets if s["building"] == building):
            m, y = s["map"], s["y"]
            p = model.predict_proba(s["x"])[:, 1]
            said = p > 0.5
            figures.append((average_precision_score(y, p), maps.ratio((said & (y == 1)).sum(), said.sum()), maps.ratio((said & (y == 1)).sum(), (y == 1).sum())))
            line = f"  {m.name + ' ' + m.kind:34s} {figures[-1][0]:.3f} {figures[-1][1]:.3f} {figures[-1][2]:.3f}"
            if args.held_out and m.kind != "tour":
                found = maps.score(m, maps.annotate(m, binary))
                scores.setdefault(m.kind, []).append(found)
                line += f"   rooms F1 {found['rooms']['f1']:.3f}"
            print(line, flush=True)
    print("  mean", *(f"{x:.3f}" for x in np.mean(figures, axis=0)))
    write_trees(fit(sets))
    for kind, found in scores.items():
        line = f"  {kind}, held out: rooms F1 {np.mean([f['rooms']['f1'] for f in found]):.3f}, mean IoU {np.mean([f['rooms']['mean_iou'] for f in found]):.3f}"
        if kind == "robot":
            line += f", doors F1 {np.mean([f['doors']['f1'] for f in found]):.3f}"
        print(line)
    print(f"{TREES} written; build again")


if __name__ == "__main__":
    main()
