#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Learns how sure an opening parts two rooms from labelled maps and tours: in maps of a robot (common/semantics/opening_trees.inc) and, with made-up plans
and labelled maps turned, in finished ones (finished_opening_trees.inc).

train_openings.py BUILD DATA OUT [--held-out] [--seed N]: OUT is what bench.py left (it drives the tours). Prints how well openings of each building are
told when the building is held out, then trains on all and writes the trees; build again afterwards. --held-out also scores every map and tour with trees
that never saw its building."""
import argparse
import json
import math
import os
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from sklearn.ensemble import GradientBoostingClassifier
from sklearn.metrics import average_precision_score

HERE = os.path.dirname(os.path.abspath(__file__))
HOUSE = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
sys.path.insert(0, HERE)
import bench  # noqa: E402
import made_up  # noqa: E402
import maps  # noqa: E402

MADE_UP_PLANS, TURNS, LESS = 32, 2, 0.5  # what is not real weighs less


class Kind:
    """Trees for one kind of map."""

    def __init__(self, file, **settings):
        self.file, self.settings = os.path.join(HOUSE, "common", "semantics", file), settings

    def fit(self, sets, seed):
        """Every map weighs as the root of its number of openings."""
        weights = np.concatenate([np.full(len(s["y"]), s["weight"] / math.sqrt(max(1, len(s["y"])))) for s in sets])
        model = GradientBoostingClassifier(subsample=0.7, random_state=seed, **self.settings)
        return model.fit(np.vstack([s["x"] for s in sets]), np.concatenate([s["y"] for s in sets]), sample_weight=weights / weights.mean())


SENSED = Kind("opening_trees.inc", n_estimators=60, max_depth=3, learning_rate=0.15, min_samples_leaf=25)
FINISHED = Kind("finished_opening_trees.inc", n_estimators=100, max_depth=4, learning_rate=0.12, min_samples_leaf=40, max_features=0.3)


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


def load(m, binary, weight=1.0):
    maps.annotate(m, binary, ["--openings"])
    rows = np.loadtxt(os.path.join(m.folder, "out", "openings.csv"), delimiter=",", ndmin=2)
    labels = label(m, rows)
    known = labels >= 0
    return {"map": m, "building": building_of(m), "x": rows[known, 5:], "y": labels[known], "weight": weight}


def kind_of(m):
    return FINISHED if m.kind in ("plain", "furnished") else SENSED


def nodes_of(model):
    """Bias, roots and nodes (feature, bound, left, right, value) of all trees in one list; a leaf has feature -1."""
    nodes, roots = [], []
    for tree in model.estimators_[:, 0]:
        t, base = tree.tree_, len(nodes)
        roots.append(base)
        for i in range(t.node_count):
            leaf = t.children_left[i] < 0
            nodes.append((-1, 0, 0, 0, model.learning_rate * t.value[i][0][0]) if leaf else
                         (t.feature[i], t.threshold[i], base + t.children_left[i], base + t.children_right[i], 0))
    share = model.init_.class_prior_[1]
    return math.log(share / (1 - share)), roots, nodes


def write_trees(model, path):
    """The built-in trees, as C++."""
    def number(v):
        text = f"{v:.5g}"
        return text + ("f" if "." in text or "e" in text else ".0f")
    bias, roots, nodes = nodes_of(model)
    with open(path, "w") as f:
        f.write("// SPDX-License-Identifier: BSD-3-Clause\n// Made by ./run.sh train semantics; see opening_model.hpp.\n// clang-format off\n")
        f.write(f"constexpr double kBias = {bias:.5f};\nconstexpr int kRoots[] = {{{', '.join(map(str, roots))}}};\n")
        f.write("constexpr Node kNodes[] = {\n")
        for k in range(0, len(nodes), 4):
            f.write("  " + " ".join(f"{{{a}, {number(b)}, {c}, {d}, {number(v)}}}," for a, b, c, d, v in nodes[k:k + 4]) + "\n")
        f.write("};\n// clang-format on\n")


def write_tree_file(model, path):
    """As semantics.opening_trees reads them."""
    bias, roots, nodes = nodes_of(model)
    with open(path, "w") as f:
        f.write(f"bias {bias:.5f}\n" + "".join(f"root {r}\n" for r in roots))
        f.write("".join(f"node {a} {b:.5g} {c} {d} {v:.5g}\n" for a, b, c, d, v in nodes))


def score_held_out(sets, files, binary, args):
    """Scores every map and tour with the trees that never saw its building, and prints means."""
    rows = {}
    for s in sets:
        m = s["map"]
        options = ["--set", f"semantics.opening_trees={files[s['building'], kind_of(m)]}"]
        if m.kind == "tour":
            _, found = bench.tour_semantics(binary, os.path.join(args.out, "tours", m.name), "ground_truth", os.path.join(args.out, "held_out", m.name), options)
            row = bench.tour_row(m.name, found)
        else:
            row = bench.map_row(m.name, m.kind, maps.score(m, maps.annotate(m, binary, options)))
        rows.setdefault(m.kind, []).append(row)
        print(f"  {m.name + ' ' + m.kind:34s}", " ".join(bench.percent(x) for x in row[1:]), flush=True)
    return rows


def main():
    parser = argparse.ArgumentParser(description="Learns the trees that judge openings.")
    parser.add_argument("build")
    parser.add_argument("data")
    parser.add_argument("out")
    parser.add_argument("--held-out", action="store_true", help="also score the rooms of each building with trees that never saw it")
    parser.add_argument("--seed", type=int, default=1, help="of the training; the shipped trees have 1")
    args = parser.parse_args()
    binary = os.path.join(os.path.abspath(args.build), "bin")
    drawn = maps.drawn_maps(args.data, args.out)
    more = made_up.made_up_maps(MADE_UP_PLANS, args.out) + [made_up.turned(m, seed, args.out) for m in drawn for seed in range(TURNS)]
    with ThreadPoolExecutor() as pool:
        sets = list(pool.map(lambda m: load(m, binary), drawn + maps.robot_maps(args.data, args.out) + tour_maps(args.out)))
        not_real = list(pool.map(lambda m: load(m, binary, LESS), more))
    lessons = {SENSED: sets, FINISHED: sets + not_real}
    print("Openings of buildings that were held out: average precision, and precision and recall at one half")
    figures, files = [], {}
    os.makedirs(os.path.join(args.out, "held_out"), exist_ok=True)
    for building in sorted({s["building"] for s in sets}):
        own = [s for s in sets if s["building"] == building]
        for kind in {kind_of(s["map"]) for s in own}:
            model = kind.fit([s for s in lessons[kind] if s["building"] != building], args.seed)
            files[building, kind] = os.path.join(os.path.abspath(args.out), "held_out", f"{building}.{os.path.basename(kind.file)}")
            write_tree_file(model, files[building, kind])
            for s in (s for s in own if kind_of(s["map"]) is kind):
                m, y = s["map"], s["y"]
                p = model.predict_proba(s["x"])[:, 1]
                said = p > 0.5
                figures.append((average_precision_score(y, p), maps.ratio((said & (y == 1)).sum(), said.sum()), maps.ratio((said & (y == 1)).sum(), (y == 1).sum())))
                print(f"  {m.name + ' ' + m.kind:34s}", *(f"{x:.3f}" for x in figures[-1]), flush=True)
    print("  mean", *(f"{x:.3f}" for x in np.mean(figures, axis=0)))
    for kind, these in lessons.items():
        write_trees(kind.fit(these, args.seed), kind.file)
        print(f"{kind.file} written; build again")
    if args.held_out:
        text = bench.held_out_section(score_held_out(sets, files, binary, args))
        with open(os.path.join(args.out, "held_out.md"), "w") as f:
            f.write(text)
        print(text)


if __name__ == "__main__":
    main()
