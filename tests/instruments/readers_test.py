#!/usr/bin/env python3
"""Point clouds read by the Point Cloud Library, beside the CSV of the same cloud. readers_test.py PANWRIGHT SOURCE_DIR"""

import math
import os
import shutil
import subprocess
import sys
import tempfile

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
TOOLS = {name: shutil.which(name) for name in ("pcl_convert_pcd_ascii_binary", "pcl_ply2pcd")}
if not all(TOOLS.values()):
    print("pcl-tools is not installed: skipped")
    sys.exit(77)


def expect(condition, what):
    if not condition:
        raise SystemExit(f"readers_test: {what}")


def run(*words):
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    expect(done.returncode == 0, f"{words}: {done.stdout}{done.stderr}")


def read_pcd(path):
    """Fields, size and rows of a PCD that PCL wrote, as text."""
    with open(path, encoding="ascii") as file:
        lines = file.read().splitlines()
    head = {line.split()[0]: line.split()[1:] for line in lines[:12] if line and line[0] != "#"}
    expect(head["DATA"] == ["ascii"], head)
    rows = [list(map(float, line.split())) for line in lines[lines.index("DATA ascii") + 1:]]
    return head["FIELDS"], (int(head["WIDTH"][0]), int(head["HEIGHT"][0])), rows


def scan(folder, lidar):
    files = {kind: os.path.join(folder, f"cloud.{kind}") for kind in ("csv", "pcd", "ply")}
    run(PROGRAM, "lidar", os.path.join(SOURCE, "examples/client/client.pxn"), "--lidar", lidar, "--camera", "0 -30 5", "--look-at", "0 0 0",
        *(word for file in files.values() for word in ("-o", file)))
    with open(files["csv"], encoding="ascii") as table:
        names, *rows = [line.split(",") for line in table.read().splitlines()]
    points = [dict(zip(names, (float(each) if each else math.nan for each in row))) for row in rows]
    expect(len(points) > 300, f"{len(points)} points")
    return files, points


def same(found, expected, digits):
    return math.isnan(found) and math.isnan(expected) or abs(found - expected) <= digits * max(1, abs(expected))


def check(points, fields, rows, what):
    expect(len(rows) == len(points), f"{what}: {len(rows)} of {len(points)} points")
    names = [("time" if name == "t" else name) for name in fields]
    expect({"x", "y", "z", "intensity", "range", "flags"} <= set(names), f"{what}: {fields}")
    worst = 0.0
    for point, row in zip(points, rows):
        for name, value in zip(names, row):
            expect(same(value, point[name], 2e-7), f"{what}: {name} is {value}, expected {point[name]}")
            worst = max(worst, abs(value - point[name]) / max(1, abs(point[name])) if not math.isnan(value) else 0)
    print(f"{what}: {len(rows)} points, {len(names)} fields, largest difference {worst:.1e}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        back = os.path.join(folder, "back.pcd")
        # several echoes a pulse: a list of points
        files, points = scan(folder, os.path.join(SOURCE, "examples/lidar/scanning_rvs.toml"))
        expect(any(point["echoes"] > 1 for point in points), "pulses of several echoes")
        run(TOOLS["pcl_convert_pcd_ascii_binary"], files["pcd"], back, "0", "9")
        fields, size, rows = read_pcd(back)
        expect(size == (len(points), 1), f"PCD: {size}")
        check(points, fields, rows, "PCD")
        run(TOOLS["pcl_ply2pcd"], "-format", "0", files["ply"], back)
        fields, size, rows = read_pcd(back)
        check(points, fields, rows, "PLY")
        # a grid: NaN where nothing answers
        files, points = scan(folder, os.path.join(SOURCE, "examples/lidar/flash_rvd.toml"))
        run(TOOLS["pcl_convert_pcd_ascii_binary"], files["pcd"], back, "0", "9")
        fields, size, rows = read_pcd(back)
        expect(size == (128, 128) and len(rows) == 128 * 128, f"an organised PCD: {size}")
        there = [row for row in rows if not math.isnan(row[0])]
        places = [k for k, row in enumerate(rows) if not math.isnan(row[0])]
        expect(places == [int(point["row"] * 128 + point["column"]) for point in points], "places of the grid")
        check(points, fields, there, "organised PCD")


main()
