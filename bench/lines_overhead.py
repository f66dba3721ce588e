#!/usr/bin/env python3
"""Time of an image by `serve --json-lines` beyond `render --views -`, which writes it to memory (/dev/shm). lines_overhead.py PANWRIGHT MODEL [ROUNDS]

Prints a CSV row for each way: medians of interleaved rounds, milliseconds of processors and of the wall; and whether the images have the same bytes.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

PROGRAM, MODEL = map(os.path.abspath, sys.argv[1:3])
ROUNDS = int(sys.argv[3]) if len(sys.argv) > 3 else 21
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server", "clients"))
from panwright_lines import Lines  # noqa: E402

OPTIONS = ["--size", "1024x1024", "--fov", "40", "--samples", "1", "--sun", "1 -0.7 0.6"]
HEADER = 128  # bytes of a .npy file before its numbers


def processor_seconds(process):
    with open(f"/proc/{process.pid}/schedstat", encoding="ascii"):
        pass
    total = 0
    for task in os.listdir(f"/proc/{process.pid}/task"):
        try:
            with open(f"/proc/{process.pid}/task/{task}/schedstat", encoding="ascii") as file:
                total += int(file.read().split()[0])
        except OSError:
            pass  # a thread that ended: threads of pools stay
    return total * 1e-9


def main():
    with tempfile.TemporaryDirectory(dir="/dev/shm") as folder:
        frame = os.path.join(folder, "frame.npy")
        views = subprocess.Popen([PROGRAM, "render", MODEL, *OPTIONS, "--views", "-"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        server = subprocess.Popen([PROGRAM, "serve", MODEL, *OPTIONS, "--json-lines", "--socket", os.path.join(folder, "wire")],
                                  stdout=subprocess.PIPE, text=True)
        server.stdout.readline()
        client = Lines(path=os.path.join(folder, "wire"))

        def by_file(view):
            views.stdin.write(json.dumps({**view, "output": frame}) + "\n")
            views.stdin.flush()
            answer = json.loads(views.stdout.readline())
            assert answer["ok"], answer
            return lambda: open(frame, "rb").read()[HEADER:]

        ways = {"render --views -": (views, by_file),
                "shared": (server, lambda view: client.image(view, "shared")["radiance"].tobytes),
                "inline": (server, lambda view: client.image(view, "inline")["radiance"].tobytes)}
        times, same = {name: [] for name in ways}, {name: True for name in ways}
        for k in range(ROUNDS + 2):
            view = {"camera": [9, -9, 8 + 0.001 * k]}
            images = {}
            for name, (process, draw) in ways.items():
                begin, processor = time.perf_counter(), processor_seconds(process)
                pixels = draw(view)
                wall, processor = time.perf_counter() - begin, processor_seconds(process) - processor
                images[name] = pixels()
                if k >= 2:
                    times[name].append((1e3 * processor, 1e3 * wall))
            for name in ways:
                same[name] &= images[name] == images["render --views -"]
        base = [statistics.median(column) for column in zip(*times["render --views -"])]
        print("way,processor_ms,wall_ms,processor_ms_beyond,wall_ms_beyond,same_bytes")
        for name, rows in times.items():
            own = [statistics.median(column) for column in zip(*rows)]
            # of pairs: both were measured in the same round
            beyond = [statistics.median(a - b for a, b in zip(x, y)) for x, y in zip(zip(*rows), zip(*times["render --views -"]))]
            print(f"{name},{own[0]:.2f},{own[1]:.2f},{beyond[0]:.2f},{beyond[1]:.2f},{'yes' if same[name] else 'no'}")
        assert base
        client.close()
        views.stdin.close()
        views.wait(30)
        server.terminate()
        server.wait(30)


main()
