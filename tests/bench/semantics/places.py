#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Drives every plan and world with a tour through all its rooms and learns places from them.

places.py BUILD DATA OUT [--model FILE]: DATA holds plans/ (left out and said when missing). Scores each building with classifiers that never
saw it: OUT/places.json and OUT/places.md. --model also writes the classifiers learned from all of them."""
import argparse
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
HOUSE = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
# Editions and floors of one building are held out together.
BUILDINGS = ("SKF", "Valleceppi", "battle_creekhs")


def building_of(name):
    return next((b for b in BUILDINGS if name.startswith(b)), name)


def sources(data):
    found = [os.path.join(HOUSE, "config", "worlds", f) for f in ("apartment.geojson", "compworld.geojson")]
    plans = os.path.join(data, "plans")
    if not os.path.isdir(plans):
        print(f"{plans}: not there; learning from the two worlds of the repository and made-up offices only")
        return found
    return found + sorted(os.path.join(plans, f) for f in os.listdir(plans) if f.endswith(".json"))


def toured(source, out):
    """BUILDING=WORLD of a source with a tour, or nothing where no robot can enter a room."""
    name = os.path.splitext(os.path.basename(source))[0]
    world = os.path.join(out, name + ".geojson")
    if not os.path.exists(world):
        done = subprocess.run([sys.executable, os.path.join(HERE, "toured_world.py"), source, world], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, check=False)
        if done.returncode:
            print(f"{source}: left out: {done.stdout.strip()[-200:]}")
            return None
    return f"{building_of(name)}={world}"


def main():
    parser = argparse.ArgumentParser(description="Learns and scores places.")
    parser.add_argument("build")
    parser.add_argument("data")
    parser.add_argument("out")
    parser.add_argument("--model", help="write the classifiers here")
    args = parser.parse_args()
    os.makedirs(args.out, exist_ok=True)
    worlds = [w for w in (toured(s, args.out) for s in sources(args.data)) if w]
    command = [os.path.join(args.build, "bin", "modslam-learn-places"), *worlds, "--held-out", "--markdown", os.path.join(args.out, "places.md"),
               "--json", os.path.join(args.out, "places.json")]
    if args.model:
        command += ["--out", args.model]
    sys.exit(subprocess.run(command, check=False).returncode)


if __name__ == "__main__":
    main()
