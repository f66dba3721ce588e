#!/usr/bin/env python3
"""Prints views of the made crater field: four heights of the Sun, and a descent of the servicer with its shadow on the ground.

    panwright dem crater.lbl -o crater.pan
    panwright compile ../servicer/servicer.pxn -o servicer.pan
    python3 descent.py | panwright render ground=crater.pan servicer=servicer.pan --views -

Positions are body-fixed, in metres: X east of the prime meridian, Z to the north pole.
"""
import json
import math

LATITUDE, LONGITUDE, RADIUS = math.radians(-87.61778), math.radians(56.83508), 1737400 + 430
up = (math.cos(LATITUDE) * math.cos(LONGITUDE), math.cos(LATITUDE) * math.sin(LONGITUDE), math.sin(LATITUDE))
east = (-math.sin(LONGITUDE), math.cos(LONGITUDE), 0)
north = tuple(up[i - 2] * east[i - 1] - up[i - 1] * east[i - 2] for i in range(3))


def direction(e, n, u):
    return [e * east[i] + n * north[i] + u * up[i] for i in range(3)]


def place(e, n, u):
    return [RADIUS * up[i] + d for i, d in enumerate(direction(e, n, u))]


def sun(elevation):
    a = math.radians(elevation)
    return direction(-math.cos(a) * 0.94, -math.cos(a) * 0.34, math.sin(a))


def main():
    common = {"look-at": place(0, 0, 0), "up": direction(0, 0, 1), "fov": 45, "size": [480, 270], "ev": "auto"}
    far_away = [*place(0, 0, 1e5), 1, 0, 0, 0]
    for elevation in (3, 10, 25, 60):
        print(json.dumps({**common, "output": f"sun_{elevation}.png", "camera": place(-200, -720, 330), "sun": sun(elevation),
                          "pose": {"servicer": far_away}}))
    for step, height in enumerate((160, 120, 80, 40)):
        print(json.dumps({**common, "output": f"descent_{step}.png", "camera": place(-10, -90, 50 + height), "sun": sun(35),
                          "look-at": place(20, 0, 0.4 * height), "pose": {"servicer": [*place(0, 0, height), 1, 0, 0, 0]}}))


if __name__ == "__main__":
    main()
