#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a world file with a route `tour` through every room that a robot can reach.

toured_world.py FILE OUT.geojson, FILE: a world (GeoJSON) or an exact floor plan
(JSON: walls [[x1, y1, x2, y2]], rooms [{id, label, poly}], doors [{c, width, rooms}], metres). In a plan the doors between
two rooms are cut open; all others stay wall."""
import heapq
import json
import math
import sys

import cv2
import numpy as np

CELL_M, ROBOT_M, SPEED = 0.1, 0.27, 0.8
PLAN_WALL_M = 0.04   # thickness of a wall that a plan draws as a line
VIEW_M = 5.0         # every bit of a room's floor comes this near to the tour


# Plans ------------------------------------------------------------------------------------------

def merge_collinear(segments):
    """Plans repeat walls, whole or in pieces; here each straight wall is one piece."""
    lines = {}
    for x1, y1, x2, y2 in segments:
        length = math.hypot(x2 - x1, y2 - y1)
        if length < 0.02:
            continue
        angle = math.atan2(y2 - y1, x2 - x1) % math.pi
        if angle > math.pi - 1e-3:
            angle -= math.pi
        u = (math.cos(angle), math.sin(angle))
        key = (round(angle / 0.005), round((-u[1] * x1 + u[0] * y1) / 0.02))
        ends = sorted((u[0] * x + u[1] * y for x, y in ((x1, y1), (x2, y2))))
        lines.setdefault(key, []).append((ends[0], ends[1], u, -u[1] * x1 + u[0] * y1))
    walls = []
    for pieces in lines.values():
        pieces.sort(key=lambda p: p[0])
        low, high, u, off = pieces[0]
        for piece in pieces[1:] + [(math.inf, math.inf, None, 0)]:
            if piece[0] <= high + 0.02:
                high = max(high, piece[1])
                continue
            n = (-u[1], u[0])
            walls.append(np.array([[low * u[0] + off * n[0], low * u[1] + off * n[1]],
                                   [high * u[0] + off * n[0], high * u[1] + off * n[1]]]))
            low, high, u, off = piece
    return walls


def cut_door(walls, centre, width):
    """Opens the walls near the door; returns its jambs, or None where no wall is long enough."""
    def place(wall):
        d = wall[1] - wall[0]
        length = np.linalg.norm(d)
        u = d / length
        t = float(np.dot(centre - wall[0], u))
        return length, u, t, np.linalg.norm(wall[0] + np.clip(t, 0, length) * u - centre)
    long_enough = [w for w in walls if np.linalg.norm(w[1] - w[0]) > width + 0.1 and place(w)[3] < 0.3]
    if not long_enough:
        return None
    nearest = min(long_enough, key=lambda w: place(w)[3])
    length, u, t, _ = place(nearest)
    t = float(np.clip(t, width / 2 + 0.05, length - width / 2 - 0.05))  # a door in the corner stands off it
    centre = nearest[0] + t * u
    jambs, kept = [], []
    for wall in walls:
        length, v, t, off = place(wall)
        reach = abs(t - np.clip(t, 0, length))
        if abs(np.dot(u, v)) < 0.99 or np.linalg.norm(centre - wall[0] - np.dot(centre - wall[0], v) * v) > 0.35 or reach > width / 2:
            kept.append(wall)
            continue
        t = float(np.dot(centre - wall[0], v))
        if t - width / 2 > 0.02:
            kept.append(np.array([wall[0], wall[0] + (t - width / 2) * v]))
        if length - t - width / 2 > 0.02:
            kept.append(np.array([wall[0] + (t + width / 2) * v, wall[1]]))
        mid = wall[0] + t * v
        jambs.append((mid - width / 2 * u, mid + width / 2 * u))
    walls[:] = kept
    return np.mean([j[0] for j in jambs], axis=0), np.mean([j[1] for j in jambs], axis=0)


def feature(kind, geometry, coordinates, **properties):
    return {"type": "Feature", "properties": {"kind": kind, **properties}, "geometry": {"type": geometry, "coordinates": coordinates}}


def rounded(points):
    return [[round(float(x), 4), round(float(y), 4)] for x, y in points]


def world_of_plan(plan):
    walls = merge_collinear(plan["walls"])
    doors = []
    for k, door in enumerate(plan["doors"]):
        if len([r for r in door.get("rooms") or [] if r]) < 2:
            continue
        jambs = cut_door(walls, np.array(door["c"], float), door["width"])
        if jambs is not None:
            doors.append(feature("door", "LineString", rounded(jambs), id=f"d{k}", width=door["width"], state="open"))
    features = [feature("wall", "LineString", rounded(w), id=f"w{k}", thickness=PLAN_WALL_M) for k, w in enumerate(walls)]
    rooms = []
    for room in (r for r in plan["rooms"] if len(r["poly"]) > 2):
        category = "corridor" if room.get("label") in ("CORRIDOR", "HALL") else "room"
        ring = rounded(room["poly"])
        rooms.append(feature("room", "Polygon", [ring + ring[:1]], id=room["id"], category=category, name=room.get("label") or "room"))
    return {"type": "FeatureCollection", "name": plan["name"], "features": features + doors + rooms}


# Tours ------------------------------------------------------------------------------------------

class Floor:
    """The world as a raster: what is solid and how far each cell is from it."""

    def __init__(self, world):
        shapes = [f for f in world["features"] if f["properties"]["kind"] in ("wall", "object", "door")]
        points = np.vstack([np.array(f["geometry"]["coordinates"] if f["geometry"]["type"] == "LineString" else f["geometry"]["coordinates"][0], float)
                            for f in shapes])
        self.origin = points.min(axis=0) - 1
        size = np.ceil((points.max(axis=0) + 1 - self.origin) / CELL_M).astype(int)
        fine = 4
        image = np.zeros((size[1] * fine, size[0] * fine), np.uint8)
        to_px = lambda p: np.round((np.array(p, float) - self.origin) / CELL_M * fine).astype(np.int32)
        for f in shapes:
            p, c = f["properties"], f["geometry"]["coordinates"]
            if p["kind"] == "wall" or (p["kind"] == "door" and p.get("state") == "closed"):
                cv2.polylines(image, [to_px(c)], False, 255, max(1, round(p.get("thickness", 0.05) / CELL_M * fine)))
            elif p["kind"] == "object":
                cv2.fillPoly(image, [to_px(c[0])], 255)
        free = cv2.distanceTransform(255 - image, cv2.DIST_L2, 5) * CELL_M / fine
        self.clearance = free[fine // 2::fine, fine // 2::fine]

    def cell(self, p):
        c = ((np.array(p) - self.origin) / CELL_M).astype(int)
        return int(c[1]), int(c[0])

    def point(self, cell):
        return self.origin + (np.array([cell[1], cell[0]]) + 0.5) * CELL_M

    def way_to_nearest(self, start, goals):
        """Dijkstra over cells where the robot fits, dear near walls: cells from start to the first of the goals; [] if there is no way."""
        need, goals = ROBOT_M + 0.08, set(goals)
        cost, before, queue = {start: 0.0}, {}, [(0.0, start)]
        rows, cols = self.clearance.shape
        while queue:
            c, at = heapq.heappop(queue)
            if c > cost[at]:
                continue
            if at in goals:
                way = [at]
                while way[-1] != start:
                    way.append(before[way[-1]])
                return way[::-1]
            for dy, dx, step in ((0, 1, 1), (1, 0, 1), (0, -1, 1), (-1, 0, 1), (1, 1, 1.414), (1, -1, 1.414), (-1, 1, 1.414), (-1, -1, 1.414)):
                to = (at[0] + dy, at[1] + dx)
                if not (0 <= to[0] < rows and 0 <= to[1] < cols) or self.clearance[to] < need:
                    continue
                price = c + step * CELL_M * (1 + 3 * max(0.0, 0.8 - self.clearance[to]))
                if price < cost.get(to, math.inf):
                    cost[to] = price
                    before[to] = at
                    heapq.heappush(queue, (price, to))
        return []

    def clear_line(self, a, b):
        n = int(np.hypot(*(np.array(b) - a)) * 2) + 1
        least = min(self.clearance[a], self.clearance[b], 0.55) - 0.02
        return all(self.clearance[int(round(a[0] + (b[0] - a[0]) * k / n)), int(round(a[1] + (b[1] - a[1]) * k / n))] >= least for k in range(n + 1))


def inside_mask(floor, ring):
    mask = np.zeros(floor.clearance.shape, np.uint8)
    cv2.fillPoly(mask, [np.round((np.array(ring, float) - floor.origin) / CELL_M - 0.5).astype(np.int32)], 1)
    return mask > 0


def stops_of(floor, ring, reachable):
    """Places such that every bit of the room is within VIEW_M of one: the roomiest place first."""
    mask = inside_mask(floor, ring)
    left, stops = mask & (floor.clearance > 0), []
    yy, xx = np.mgrid[:mask.shape[0], :mask.shape[1]]
    candidates = mask & reachable
    while candidates.any() and left.sum() > 0.15 * mask.sum() and len(stops) < 12:
        gain = np.where(candidates & left, floor.clearance + 1e-3, 0)
        if gain.max() == 0:
            break
        stop = np.unravel_index(int(gain.argmax()), gain.shape)
        stops.append((int(stop[0]), int(stop[1])))
        left &= (yy - stop[0]) ** 2 + (xx - stop[1]) ** 2 > (VIEW_M / CELL_M) ** 2
    return stops


def simplify(floor, path):
    out, k = [path[0]], 0
    while k < len(path) - 1:
        j = len(path) - 1
        while j > k + 1 and not floor.clear_line(path[k], path[j]):
            j = k + (j - k) // 2 if j - k > 8 else j - 1
        out.append(path[j])
        k = j
    return out


def tour_of(world):
    floor = Floor(world)
    rooms = [f for f in world["features"] if f["properties"]["kind"] == "room"]
    starts = [f for f in world["features"] if f["properties"]["kind"] == "start"]
    fits = (floor.clearance >= ROBOT_M + 0.08).astype(np.uint8)
    _, parts = cv2.connectedComponents(fits, connectivity=8)
    if starts:
        start = floor.cell(starts[0]["geometry"]["coordinates"])
        part = parts[start]
    else:  # where most floor of rooms hangs together
        union = np.zeros(fits.shape, bool)
        for room in rooms:
            union |= inside_mask(floor, room["geometry"]["coordinates"][0])
        counts = np.bincount(parts[union & (fits > 0)])
        part = int(counts[1:].argmax()) + 1 if len(counts) > 1 else 1
        start = None
    reachable = parts == part
    stops = [s for room in rooms for s in stops_of(floor, room["geometry"]["coordinates"][0], reachable)]
    if not stops:
        sys.exit("no room of this plan can be entered")
    if start is None:
        start = stops[0]
    way = [start]
    while stops:
        leg = floor.way_to_nearest(way[-1], stops)
        if not leg:
            break
        way += simplify(floor, leg)[1:]
        stops = [s for s in stops if s != leg[-1]]
    points = [floor.point(c) for c in way]
    thinned = [points[0]]
    for p in points[1:]:
        if np.linalg.norm(p - thinned[-1]) > 0.05:
            thinned.append(p)
    world["features"] = [f for f in world["features"] if f["properties"]["kind"] not in ("route", "start", "person")]
    heading = math.atan2(*(thinned[1] - thinned[0])[::-1]) if len(thinned) > 1 else 0
    world["features"].append(feature("start", "Point", rounded([thinned[0]])[0], heading=round(heading, 4)))
    world["features"].append(feature("route", "LineString", rounded(thinned), id="tour", speed=SPEED, corner_radius=0.3, turn="in_place"))
    return sum(np.linalg.norm(b - a) for a, b in zip(thinned, thinned[1:]))


def main():
    with open(sys.argv[1]) as f:
        source = json.load(f)
    world = source if source.get("type") == "FeatureCollection" else world_of_plan(source)
    metres = tour_of(world)
    head = {k: v for k, v in world.items() if k != "features"}
    with open(sys.argv[2], "w") as f:
        f.write(json.dumps(head)[:-1] + ', "features": [\n' + ",\n".join(json.dumps(x) for x in world["features"]) + "\n]}\n")
    print(f"{sys.argv[2]}: a tour of {metres:.0f} m")


if __name__ == "__main__":
    main()
