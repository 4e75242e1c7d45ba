#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Scores the semantic map: tours of simulated worlds, finished grid maps, maps of a real robot.

bench.py BUILD DATA OUT [--quick]: DATA holds maps/, plans/ and robot_maps/; what is missing is left out and said. Writes OUT/semantics.json and
OUT/semantics.md, the section for docs/benchmarks.md."""
import argparse
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
HOUSE = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
sys.path.insert(0, HERE)
import maps  # noqa: E402


def run(*command):
    done = subprocess.run(command, cwd=HOUSE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode not in (0, 2):
        raise RuntimeError(f"{' '.join(command)}: {done.stdout[-500:]}")


def tour(binary, source, out, estimators):
    """Drives one world through all rooms and scores the map of each estimator."""
    name = os.path.splitext(os.path.basename(source))[0]
    folder = os.path.join(out, "tours", name)
    os.makedirs(folder, exist_ok=True)
    world, truth, log = (os.path.join(folder, f) for f in ("world.geojson", "truth.geojson", "drive.lcm"))
    if not os.path.exists(log):
        run(sys.executable, os.path.join(HERE, "toured_world.py"), source, world)
        run(f"{binary}/modslam-world-truth", world, truth)
        run(f"{binary}/modslam-simulate", log, "--set", f"simulator.world={world}", "--set", "simulator.route=tour")
    scores = {}
    for estimator in estimators:
        result = os.path.join(folder, estimator)
        scores[estimator] = tour_semantics(binary, folder, estimator, result)[1]
    return name, scores


def tour_semantics(binary, folder, estimator, result, options=()):
    """What one estimator and the semantic map make of a driven tour: the files of the run in `result`, and the scores."""
    os.makedirs(result, exist_ok=True)
    run(f"{binary}/modslam-offline", os.path.join(folder, "drive.lcm"), "--out", result, "--set", f"launch.estimator={estimator}", "--set",
        "semantics.publish_s=600", *options)
    run(f"{binary}/modslam-report", result)
    score = os.path.join(result, "scores.json")
    run(f"{binary}/modslam-evaluate", "--semantic", f"{result}/semantic.geojson", "--world-truth", os.path.join(folder, "truth.geojson"), "--log",
        f"{result}/run.lcm", "--json", score)
    with open(score) as f:
        return result, json.load(f)["semantics"]


TOUR_HEAD = ["walls P", "walls R", "doors P", "doors R", "right two rooms", "rooms F1", "rooms mean IoU"]
MAP_HEAD = ["rooms P", "rooms R", "rooms F1", "rooms mean IoU"]
KINDS = {"plain": ("Grid maps, plain", []), "furnished": ("Grid maps, furnished", ["objects or static, balanced"]),
         "robot": ("Maps of a real robot (scored inside the labelled rooms)", ["doors P", "doors R", "doors F1"])}


def tour_row(name, s):
    wall = next(w for w in s["walls"]["at"] if w["tolerance_m"] == 0.1)
    pairs = maps.ratio(s["doors"]["pairs_right"], s["doors"]["pairs_known"])
    return [name, wall["precision"], wall["recall"], s["doors"]["precision"], s["doors"]["recall"], pairs, s["rooms"]["f1"], s["rooms"]["mean_iou"]]


def map_row(name, kind, s):
    r = s["rooms"]
    row = [name, r["precision"], r["recall"], r["f1"], r["mean_iou"]]
    if kind == "furnished":
        row.append(s["objects"]["balanced_accuracy"])
    if kind == "robot":
        row += [s["doors"][k] for k in ("precision", "recall", "f1")]
    return row


def held_out_section(rows):
    """The means over each kind of map, by trees that never saw the building."""
    text = []
    for kind, found in sorted(rows.items()):
        words, head = ("Simulated tours, perfect localisation", TOUR_HEAD) if kind == "tour" else (KINDS[kind][0], MAP_HEAD + KINDS[kind][1])
        text += [f"{words}:", "", table(["map"] + head, found)[0], ""]
    return "\n".join(text)


def percent(x):
    return f"{100 * x:.1f}"


def table(head, rows):
    mean = ["**mean**"] + [float(np.mean(column)) for column in list(zip(*rows))[1:]]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for row in rows + [mean]:
        lines.append("| " + " | ".join([row[0]] + [percent(x) for x in row[1:]]) + " |")
    return "\n".join(lines), mean[1:]


def cost(binary, out):
    """CPU milliseconds against the size of generated buildings, as a table; "" where the program was not built."""
    program, figures = os.path.join(binary, "semantics-bench"), os.path.join(out, "cost.json")
    if not os.path.exists(program):
        print(f"{program}: not there; no cost measured")
        return ""
    run(program, "--json", figures)
    with open(figures) as f:
        rows = json.load(f)
    lines = ["Cost: generated buildings, CPU milliseconds on one core; median, 95th percentile. All corridors are alike. Update: the layers after each of the last 100 scans,",
             "from 60 rooms on in the same four corridors. Again: while the last corridor is driven four times more; what is seen is the same in every building.",
             "The row of 40 rooms is driven ten times, with as many nodes as our own runs have in so many rooms, or fewer; the last ones stand askew on the raster.", "",
             "| rooms | turned | nodes | rooms found, with corridors | scan insertion | update | again | after a loop moved a tenth | full render |", "|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        pair = lambda key: f"{r[key]['median']:.2g}, {r[key]['p95']:.2g}"
        lines.append(f"| {r['rooms']} | {r['turned_deg']:.0f}° | {r['nodes']} | {r['found_rooms']} | {pair('insert_ms')} | {pair('update_ms')} | {pair('again_ms')} | {r['after_loop_ms']:.0f} | {r['render_ms']:.0f} |")
    return "\n".join(lines) + "\n"


def objects_line(tours, estimator):
    """Of the buildings that are furnished. The classes' sizes were measured in these same worlds."""
    furnished = {name: s[estimator]["objects"] for name, s in tours if estimator in s and s[estimator]["objects"]["truth"]}
    words = [f"{name} {o['matched']} of {o['found']} lie on a true one, {o['named_right']} of {o['named']} named rightly" for name, o in furnished.items()]
    return "Objects, where footprints overlap by 0.3: " + "; ".join(words) + "."


def ends_line(tours, estimator):
    """Where walls end, over all buildings: ends on true faces, weighted by their number."""
    ends = [s[estimator]["wall_ends"] for _, s in tours if estimator in s]
    on_face = sum(e["on_face"] for e in ends)
    mean = lambda figure: sum(e["on_face"] * figure(e) for e in ends) / max(1, on_face)
    return (f"Ends of walls: {sum(e['told'] for e in ends)} told as seen, {on_face} of them on a true face; off along it by {100 * mean(lambda e: e['along_m']['median']):.1f} cm "
            f"(median), within two of the told standard deviations {percent(mean(lambda e: e['along_within']))} along, {percent(mean(lambda e: e['across_within']))} across.")


def section(tours, found):
    text = ["One parameter set; the trees that judge openings were trained on these buildings. All figures in per cent: rooms match at half overlap, doors within",
            "0.5 m, walls within 0.10 m by length.", ""]
    for estimator, words in (("ground_truth", "perfect localisation"), ("graph_optimizer", "our own SLAM")):
        rows = [tour_row(name, s[estimator]) for name, s in tours if estimator in s]
        if rows:
            text += [f"Simulated tours through every room, {words}:", "", table(["building"] + TOUR_HEAD, rows)[0], ""]
            lone = sum(s[estimator]["rooms"]["false_in_unseen"] for _, s in tours if estimator in s)
            text += [f"Rooms found where no beam ever crossed half of the floor: {lone}.", ""]
            text += [ends_line(tours, estimator), "", objects_line(tours, estimator), ""]
    for kind, (words, more) in KINDS.items():
        rows = [map_row(m["name"], kind, m) for m in found if m["kind"] == kind]
        if rows:
            text += [words + ":", "", table(["map"] + MAP_HEAD + more, rows)[0], ""]
    return "\n".join(text)


def main():
    parser = argparse.ArgumentParser(description="Scores the semantic map.")
    parser.add_argument("build")
    parser.add_argument("data")
    parser.add_argument("out")
    parser.add_argument("--quick", action="store_true", help="perfect localisation only")
    args = parser.parse_args()
    binary, out = os.path.join(os.path.abspath(args.build), "bin"), os.path.abspath(args.out)
    os.makedirs(out, exist_ok=True)
    sources = [os.path.join(HOUSE, "config", "worlds", f) for f in ("apartment.geojson", "compworld.geojson")]
    plans = os.path.join(args.data, "plans")
    if os.path.isdir(plans):
        sources += sorted(os.path.join(plans, f) for f in os.listdir(plans) if f.endswith(".json"))
    else:
        print(f"{plans}: not there; no floor plans driven")
    tours = []
    with ThreadPoolExecutor(2) as pool:
        estimators = ["ground_truth"] if args.quick else ["ground_truth", "graph_optimizer"]
        for source, job in [(s, pool.submit(tour, binary, s, out, estimators)) for s in sources]:
            try:
                tours.append(job.result())
                print(tours[-1][0], "driven", flush=True)
            except RuntimeError as error:  # a plan whose rooms no robot can enter
                print(f"{source}: left out: {str(error)[-200:]}")
    found = []
    if os.path.isdir(os.path.join(args.data, "maps")):
        for m in maps.drawn_maps(args.data, out) + maps.robot_maps(args.data, out):
            found.append({"name": m.name, **maps.score(m, maps.annotate(m, binary))})
            print(m.name, m.kind, "annotated", flush=True)
    else:
        print(f"{args.data}/maps: not there; no finished maps annotated")
    with open(os.path.join(out, "semantics.json"), "w") as f:
        json.dump({"tours": dict(tours), "maps": found}, f, indent=1, default=float)
    text = section(tours, found) + "\n" + cost(binary, out)
    with open(os.path.join(out, "semantics.md"), "w") as f:
        f.write(text)
    print(text)


if __name__ == "__main__":
    main()
