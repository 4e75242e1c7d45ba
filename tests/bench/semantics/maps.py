# SPDX-License-Identifier: BSD-3-Clause
"""Finished grid maps with hand-labelled rooms: what `annotate` finds on them, scored on a raster of 0.05 m."""
import json
import os
import shutil
import subprocess

import cv2
import numpy as np

CELL_M = 0.05
NEAR_LABELS_M = 1.0  # doors farther from labelled floor do not count
LEAST_CELLS = 100  # smaller regions of truth or result do not count


class Map:
    """Truth of one map: labels (rooms from 1, row 0 lowest y), door centres, and the folder with map.yaml."""

    def __init__(self, name, kind, folder, labels, origin, doors, objects=None):
        self.name, self.kind, self.folder, self.labels, self.origin, self.doors, self.objects = name, kind, folder, labels, np.array(origin, float), doors, objects

    def cells(self, points):
        return np.floor((np.asarray(points, float).reshape(-1, 2) - self.origin) / CELL_M).astype(int)

    def fill(self, image, rings, value):
        cv2.fillPoly(image, [np.round((np.asarray(r, float) - self.origin) / CELL_M - 0.5).astype(np.int32) for r in rings], value)


def first_channel(path):
    image = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    return image if image.ndim == 2 else image[:, :, 0]


def drawn_maps(data, work):
    """The grid maps, plain and furnished."""
    out = []
    folder = os.path.join(data, "maps")
    for file in sorted(os.listdir(folder)):
        if not file.endswith("_gt_segmentation.png"):
            continue
        name = file[:-len("_gt_segmentation.png")]
        truth = first_channel(os.path.join(folder, file))
        count, regions, stats, _ = cv2.connectedComponentsWithStats((truth >= 250).astype(np.uint8), connectivity=4)
        labels = np.zeros(truth.shape, np.int32)
        for k in range(1, count):
            if stats[k, 4] > LEAST_CELLS:
                labels[regions == k] = k
        plain = first_channel(os.path.join(folder, name + ".png"))
        for kind, suffix in (("plain", ""), ("furnished", "_furnitures")):
            picture = first_channel(os.path.join(folder, name + suffix + ".png"))
            target = os.path.join(work, "maps", name + "." + kind)
            os.makedirs(target, exist_ok=True)
            cv2.imwrite(os.path.join(target, "map.png"), picture)
            with open(os.path.join(target, "map.yaml"), "w") as f:
                f.write("image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.22\nfree_thresh: 0.1\n")
            objects = None
            if kind == "furnished":  # what is occupied now and was free: 1 object, 2 static, where it touches floor
                occupied, free = picture < 198, picture >= 230
                rim = occupied & (cv2.dilate(free.astype(np.uint8), np.ones((3, 3))) > 0)
                objects = np.where(rim, np.where(plain >= 230, 1, 2), 0)[::-1]
            out.append(Map(name, kind, target, labels[::-1], (0, 0), np.zeros((0, 2)), objects))
    return out


def robot_maps(data, work):
    """Maps of a real robot with hand-drawn rooms and doorways."""
    out = []
    folder = os.path.join(data, "robot_maps")
    for name in sorted(os.listdir(folder)):
        source, target = os.path.join(folder, name), os.path.join(work, "maps", name)
        os.makedirs(target, exist_ok=True)
        for file in ("map.png", "map.yaml"):
            shutil.copyfile(os.path.join(source, file), os.path.join(target, file))
        with open(os.path.join(source, "truth.json")) as f:
            truth = json.load(f)
        points = np.vstack([np.array(r["poly"]) for r in truth["rooms"]])
        origin = points.min(axis=0) - 3
        size = np.ceil((points.max(axis=0) + 3 - origin) / CELL_M).astype(int)
        found = Map(name, "robot", target, np.zeros((size[1], size[0]), np.int32), origin, np.array([d["c"] for d in truth["doors"]], float))
        for k, room in enumerate(truth["rooms"]):
            found.fill(found.labels, [room["poly"]], k + 1)
        out.append(found)
    return out


def annotate(m, binary, extra=()):
    out = os.path.join(m.folder, "out")
    house = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
    subprocess.run([os.path.join(binary, "modslam-annotate"), os.path.join(m.folder, "map.yaml"), "--out", out, *extra], check=True,
                   stdout=subprocess.DEVNULL, cwd=house)
    with open(os.path.join(out, "semantic.geojson")) as f:
        return json.load(f)["features"]


def ratio(part, whole):
    return part / whole if whole else 0.0


def f1(p, r):
    return 2 * p * r / (p + r) if p + r else 0.0


def room_scores(m, features):
    """One to one at half overlap (more than one half can only be one), and Bormann's shares of largest overlap."""
    found = np.zeros(m.labels.shape, np.int32)
    for k, f in enumerate(x for x in features if x["properties"]["kind"] == "room"):
        m.fill(found, f["geometry"]["coordinates"], k + 1)
    if m.kind == "robot":  # nothing is known of what was not labelled
        found[m.labels == 0] = 0
    truth_size = {k: n for k, n in zip(*np.unique(m.labels[m.labels > 0], return_counts=True))}
    found_size = {k: n for k, n in zip(*np.unique(found[found > 0], return_counts=True)) if n > LEAST_CELLS}
    pairs = {}
    both = (m.labels > 0) & (found > 0)
    for t, f in zip(m.labels[both], found[both]):
        pairs[t, f] = pairs.get((t, f), 0) + 1
    best = {t: 0.0 for t in truth_size}
    largest_of_truth, largest_of_found = dict.fromkeys(truth_size, 0), dict.fromkeys(found_size, 0)
    for (t, f), n in pairs.items():
        if f in found_size:
            best[t] = max(best[t], n / (truth_size[t] + found_size[f] - n))
            largest_of_truth[t] = max(largest_of_truth[t], n)
            largest_of_found[f] = max(largest_of_found[f], n)
    matched = sum(v >= 0.5 for v in best.values())
    p, r = ratio(matched, len(found_size)), ratio(matched, len(truth_size))
    return {"truth": len(truth_size), "found": len(found_size), "matched": matched, "precision": p, "recall": r, "f1": f1(p, r),
            "mean_iou": float(np.mean(list(best.values()))) if best else 0.0,
            "precision_by_area": ratio(sum(largest_of_found.values()), sum(found_size.values())),
            "recall_by_area": ratio(sum(largest_of_truth.values()), sum(truth_size.values()))}


def door_scores(m, features):
    """Centres within 0.5 m, one to one, nearest first; those far from labelled floor do not count."""
    near = cv2.distanceTransform((m.labels == 0).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) <= NEAR_LABELS_M / CELL_M
    centres = []
    for f in features:
        if f["properties"]["kind"] == "door":
            centre = np.mean(f["geometry"]["coordinates"], axis=0)
            x, y = m.cells(centre)[0]
            if 0 <= y < near.shape[0] and 0 <= x < near.shape[1] and near[y, x]:
                centres.append(centre)
    apart = sorted((float(np.linalg.norm(c - d)), i, j) for i, c in enumerate(centres) for j, d in enumerate(m.doors))
    used_found, used_truth = set(), set()
    for distance, i, j in apart:
        if distance <= 0.5 and i not in used_found and j not in used_truth:
            used_found.add(i)
            used_truth.add(j)
    p, r = ratio(len(used_found), len(centres)), ratio(len(used_truth), len(m.doors))
    return {"truth": len(m.doors), "found": len(centres), "matched": len(used_truth), "precision": p, "recall": r, "f1": f1(p, r)}


def object_scores(m, features):
    """Of occupied cells that touch floor: those near a found wall are called static, the others objects."""
    static = np.zeros(m.labels.shape, np.uint8)
    for f in features:
        if f["properties"]["kind"] == "wall":
            a, b = m.cells(f["geometry"]["coordinates"])
            cv2.line(static, tuple(map(int, a)), tuple(map(int, b)), 1, 5)
    is_object, is_static = m.objects == 1, m.objects == 2
    found_objects, found_static = ratio((is_object & (static == 0)).sum(), is_object.sum()), ratio((is_static & (static > 0)).sum(), is_static.sum())
    return {"object_recall": float(found_objects), "static_recall": float(found_static), "balanced_accuracy": float(found_objects + found_static) / 2}


def score(m, features):
    out = {"kind": m.kind, "rooms": room_scores(m, features)}
    if len(m.doors):
        out["doors"] = door_scores(m, features)
    if m.objects is not None:
        out["objects"] = object_scores(m, features)
    return out
