# SPDX-License-Identifier: BSD-3-Clause
"""Made-up floor plans as finished grid maps with their rooms, to learn from: seeded, plain or furnished; and labelled maps turned and drawn larger or smaller."""
import math
import os

import cv2
import maps
import numpy as np

WALL, FREE, UNKNOWN = 0, 254, 205
MAP_YAML = "image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.22\nfree_thresh: 0.1\n"


class Plan:
    """Rooms are cut out of solid; what no room reaches is unknown in the end."""

    def __init__(self, seed):
        self.random = np.random.default_rng(seed)
        self.wall_m = self.between(0.05, 0.15) if self.random.random() < 0.6 else self.between(0.15, 0.6)
        self.labels = np.zeros((1, 1), np.int32)
        self.rooms = 0

    def between(self, low, high):
        return float(self.random.uniform(low, high))

    def seldom_large(self, low, high):
        return low + (high - low) * float(self.random.random()) ** 2

    def box(self, x0, y0, x1, y1):
        return tuple(slice(max(0, round(min(a, b) / maps.CELL_M)), max(0, round(max(a, b) / maps.CELL_M))) for a, b in ((y0, y1), (x0, x1)))

    def room(self, x0, y0, x1, y1):
        self.rooms += 1
        self.labels[self.box(x0, y0, x1, y1)] = self.rooms
        return self.rooms

    def door(self, x, y, across_x):
        """An opening through the wall around (x, y); `across_x`: one goes through it along x."""
        kind = self.random.random()
        width = self.between(0.7, 1.3) if kind < 0.8 else self.between(1.3, 2.4)
        half = (0.5 * self.wall_m + 0.05, width / 2) if across_x else (width / 2, 0.5 * self.wall_m + 0.05)
        window = self.box(x - half[0], y - half[1], x + half[0], y + half[1])
        self.open[window] = True

    def parts(self, length, low, high):
        """Borders that part a length into pieces of at least `low`."""
        at = [0.0]
        while at[-1] < length - 1e-9:
            step = self.seldom_large(low, high)
            at.append(length if length - at[-1] - step < low else at[-1] + step)
        return at

    def row(self, x0, y_near, x1, depth, doors_to_row):
        """Rooms side by side from y_near on (depth may be negative), each with a door to there."""
        half, side = 0.5 * self.wall_m, math.copysign(1, depth)
        borders = self.parts(x1 - x0, 2.2, 9)
        for a, b in zip(borders, borders[1:]):
            self.room(x0 + a + half, y_near + side * half, x0 + b - half, y_near + depth - side * half)
            if doors_to_row:
                self.door(self.between(x0 + a + half + 0.8, x0 + b - half - 0.8), y_near, False)
            if b < borders[-1] and self.random.random() < 0.15:  # and one to the next room
                self.door(x0 + b, y_near + depth * self.between(0.25, 0.75), True)

    def cubicles(self, x0, y0, x1, y1):
        """Stalls back to back in a hall: walls that stand free, each stall open to one side."""
        size, hall = self.between(1.8, 3.2), self.room(x0, y0, x1, y1)
        t, y = max(0.05, min(self.wall_m, 0.15)), y0 + self.between(1.2, 2.5)
        while y + 2 * size + 1.2 < y1:
            x = x0 + self.between(1.2, 2.5)
            while x + size + 1.2 < x1:
                for low, mouth in ((y, y), (y + size, y + 2 * size)):
                    self.labels[self.box(x, low, x + size, low + size)] = 0
                    self.room(x + t / 2, low + t / 2, x + size - t / 2, low + size - t / 2)
                    gap, at = self.between(0.7, 1.5), self.between(0.1, 0.9)
                    left = x + 0.15 + at * max(0, size - 0.3 - gap)
                    self.open[self.box(left, mouth - t / 2 - 0.03, left + min(gap, size - 0.3), mouth + t / 2 + 0.03)] = True
                x += size
                if self.random.random() < 0.2:
                    x += self.between(1.2, 2)
            y += 2 * size + self.between(1.2, 2.5)
        return hall

    def make(self):
        width, half = self.between(14, 40), 0.5 * self.wall_m
        levels = int(self.random.integers(1, 4))
        corridors = [self.seldom_large(1.5, 4) for _ in range(levels)]
        depths = [self.seldom_large(2.6, 8) for _ in range(levels + 1)]
        if self.random.random() < 0.35:
            depths[0] = self.between(9, 16)  # a hall of stalls
        margin, height = 1.0, sum(corridors) + sum(depths)
        shape = (int((height + 2 * margin) / maps.CELL_M), int((width + 2 * margin) / maps.CELL_M))
        self.labels, self.open = np.zeros(shape, np.int32), np.zeros(shape, bool)
        y, x0, x1, below = margin, margin, margin + width, None
        for k, depth in enumerate(depths):
            if depth > 9:
                self.cubicles(x0 + half, y + half, x1 - half, y + depth - half)
                for _ in range(2):
                    self.door(self.between(x0 + 1.5, x1 - 1.5), y + depth, False)
            elif k == 0:
                self.row(x0, y + depth, x1, -depth, True)
            elif k == levels:
                self.row(x0, y, x1, depth, True)
            elif depth > 5:  # rooms back to back
                self.row(x0, y, x1, depth / 2, True)
                self.row(x0, y + depth, x1, -depth / 2, True)
            else:
                self.row(x0, y, x1, depth, True)
            y += depth
            if k < levels:
                self.room(x0 + half, y + half, x1 - half, y + corridors[k] - half)
                y += corridors[k]
                below = y
        if levels > 1 and self.random.random() < 0.8:  # a corridor across, open to the others
            x = x0 if self.random.random() < 0.5 else self.between(x0 + 3, x1 - 5)
            across = self.seldom_large(1.5, 3)
            inner = self.box(x + half, margin + depths[0] + half, x + across - half, below - half)
            self.labels[self.box(x - half, margin + depths[0] + corridors[0], x + across + half, below - corridors[-1])] = 0
            corridor = set(np.unique(self.labels[inner])) - {0}  # all that it meets is one
            self.labels[inner] = min(corridor)
            self.labels[np.isin(self.labels, list(corridor))] = min(corridor)
        return self

    def furnish(self, free):
        """Boxes and round things in rooms, half of them along walls."""
        distance = cv2.distanceTransform(free.astype(np.uint8), cv2.DIST_L2, 5) * maps.CELL_M
        rows, columns = np.nonzero(distance > 0.3)
        for _ in range(int(free.sum() * maps.CELL_M ** 2 / self.between(4, 12))):
            k = self.random.integers(len(rows))
            centre, size = np.array([columns[k], rows[k]]), np.array([self.between(0.3, 1.9), self.between(0.3, 0.9)]) / maps.CELL_M
            at_wall = distance[centre[1], centre[0]] < 0.9
            angle = self.random.choice([0.0, math.pi / 2]) if at_wall or self.random.random() < 0.7 else self.between(0, math.pi)
            thing = np.zeros(free.shape, np.uint8)
            cv2.fillPoly(thing, [cv2.boxPoints((tuple(map(float, centre)), tuple(map(float, size)), math.degrees(angle))).astype(np.int32)], 1)
            if (self.open & (cv2.dilate(thing, np.ones((17, 17))) > 0)).any():
                continue  # doors stay free
            free[thing > 0] = False

    def write(self, folder, name, furnished):
        free = (self.labels > 0) | self.open
        if furnished:
            self.furnish(free)
        wall = (cv2.dilate(free.astype(np.uint8), np.ones((3, 3))) > 0) & ~free
        if furnished:
            wall |= (self.labels > 0) & ~free
        if self.random.random() < 0.5:  # walls drawn as thick as they are
            wall |= (cv2.dilate(free.astype(np.uint8), np.ones((2 * round(self.wall_m / maps.CELL_M / 2) + 3,) * 2)) > 0) & ~free
        picture = np.where(free, FREE, np.where(wall, WALL, UNKNOWN)).astype(np.uint8)
        return written(picture, self.labels, folder, name)


def written(picture, labels, folder, name):
    os.makedirs(folder, exist_ok=True)
    cv2.imwrite(os.path.join(folder, "map.png"), picture[::-1])
    with open(os.path.join(folder, "map.yaml"), "w") as f:
        f.write(MAP_YAML)
    return maps.Map(name, "made up", folder, labels, (0, 0), np.zeros((0, 2)))


def made_up_maps(count, work):
    return [Plan(seed).make().write(os.path.join(work, "made_up", str(seed)), f"made up {seed}", seed % 2 == 1) for seed in range(count)]


def turned(m, seed, work):
    """The same map, turned and drawn 0.8 to 1.25 times as large."""
    random = np.random.default_rng(seed)
    picture = maps.first_channel(os.path.join(m.folder, "map.png"))[::-1]
    angle, scale, (rows, columns) = random.uniform(0, 360), math.exp(random.uniform(math.log(0.8), math.log(1.25))), picture.shape
    size = int(math.ceil(math.hypot(rows, columns) * scale)) + 4
    T = cv2.getRotationMatrix2D((columns / 2, rows / 2), angle, scale)
    T[:, 2] += size / 2 - np.array([columns, rows]) / 2
    warp = lambda image, value: cv2.warpAffine(image, T, (size, size), flags=cv2.INTER_NEAREST, borderValue=value)
    around = int(picture[0, 0])
    return written(warp(np.ascontiguousarray(picture), around), warp(np.ascontiguousarray(m.labels, dtype=np.float32), 0).astype(np.int32),
                   os.path.join(work, "turned", f"{m.name}.{m.kind}.{seed}"), m.name)
