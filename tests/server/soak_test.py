#!/usr/bin/env python3
"""Servers under random requests for hours: no growth, no hang, the same replies at the end as at the begin. soak_test.py PANWRIGHT SOURCE_DIR SECONDS

Three clients of each protocol ask, leave and come back. Memory, descriptors and threads are compared with those after a tenth of the time.
"""

import atexit
import os
import random
import struct
import subprocess
import sys
import tempfile
import threading
import time

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
SECONDS = float(sys.argv[3])
sys.path.insert(0, os.path.join(SOURCE, "server", "clients"))
from panwright_client import Client, pack_double, pack_float  # noqa: E402
from panwright_lines import Lines, TornImage  # noqa: E402

OPTIONS = ["--engine", "reference", "--samples", "1", "--size", "32x24", "--fov", "40"]
MODEL = os.path.join(SOURCE, "examples", "client", "client.pxn")
LONGEST = 60  # seconds of one request
MOST_GROWTH = 30_000  # kB
STEPS = 20  # requests of a visit, on average


def word(*values):
    return struct.pack(f">{len(values)}I", *values)


def f(*values):
    return b"".join(map(pack_float, values))


def d(*values):
    return b"".join(map(pack_double, values))


class Server:
    def __init__(self, *words):
        self.process = subprocess.Popen([PROGRAM, "serve", MODEL, *OPTIONS, "--port", "0", "--clients", "64", *words], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
        atexit.register(self.process.kill)
        self.port = int(self.process.stdout.readline().rsplit(":", 1)[1])

    def use(self):
        """kB of memory of its own, descriptors, threads."""
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as file:
            lines = dict(line.split(":", 1) for line in file)
        return int(lines["RssAnon"].split()[0]), len(os.listdir(f"/proc/{self.process.pid}/fd")), int(lines["Threads"])


def ask_pangu(client, numbers):
    """One request of many kinds; most change the state or look at it."""
    u = lambda a, b: numbers.uniform(a, b)  # noqa: E731
    place = [u(-20, 20) for _ in range(3)]
    quaternion = [u(-1, 1) for _ in range(4)]
    commands = ((269, d(*place, *quaternion)), (279, f(u(0.1, 2))), (280, d(1.5e11, u(-3, 3), u(-1.5, 1.5))), (258, f(u(0, 1), 0.1, 0.1)),
                (260, word(numbers.randrange(10))), (282, f(0.1, u(0, 1), 0.3)), (285, word(numbers.randrange(4))), (286, d(0, u(0, 0.1), 1, 50)),
                (270, word(0), d(*[x / 10 for x in place], *quaternion)), (289, word(0, 0), bytes([numbers.randrange(2)])),
                (290, word(0), f(u(0, 9), 1, 1, u(1, 80), 0), bytes(40)), (299, word(0), d(*[u(-1, 1) for _ in range(18)])),
                (265, f(8, 4), word(8, 4), f(0, 0), word(1, 1, 0, 15), f(*[0] * 10), bytes(48)), (293, word(0, 0)), (294, word(0)))
    kind = numbers.random()
    if kind < 0.5:
        number, *fields = numbers.choice(commands)
        client._send(number, *fields)
        client._expect(0)
    elif kind < 0.7:
        client.image()
    elif kind < 0.85:
        client.points([(numbers.random(), numbers.random()) for _ in range(numbers.randrange(1, 300))])
    elif kind < 0.95:
        client.pulse(place, [u(-1, 1), u(-1, 1), 1.5])
    else:
        client.joints(0)


def ask_lines(client, numbers):
    view = {"camera": [numbers.uniform(-20, 20), numbers.uniform(-20, 20), 9], "fov": numbers.uniform(5, 60), "sun": [1, numbers.uniform(-1, 1), 0.4]}
    if numbers.random() < 0.1:
        view["size"] = [numbers.randrange(8, 64), numbers.randrange(8, 64)]
    kind = numbers.random()
    if kind < 0.1:
        answer = client.ask({"fof": 3, "image": "inline"})
        if answer["ok"]:
            raise RuntimeError(f"a wrong view is right: {answer}")
    elif kind < 0.5:
        client.image(view, "inline")
    else:
        layers = client.image(view)
        for layer in layers.values():
            sum(bytes(layer)[:100])
        if not client.shared.is_whole(client.shared.newest()):
            raise TornImage()


class Visitor(threading.Thread):
    def __init__(self, connect, ask, seed, end):
        super().__init__(daemon=True)
        self.connect, self.ask, self.numbers, self.end_time = connect, ask, random.Random(seed), end
        self.count, self.longest, self.problem, self.begun = 0, 0.0, None, time.monotonic()

    def run(self):
        try:
            while time.monotonic() < self.end_time:
                with self.connect() as client:
                    while time.monotonic() < self.end_time and self.numbers.random() > 1 / STEPS:
                        self.begun = time.monotonic()
                        self.ask(client, self.numbers)
                        self.longest = max(self.longest, time.monotonic() - self.begun)
                        self.count += 1
        except Exception as problem:  # noqa: BLE001 the main thread reports it
            self.problem = f"{type(problem).__name__}: {problem}"


def reference_replies(pangu, lines):
    with Client(port=pangu.port) as client:
        client.set_viewpoint((0, -12, 3), (0.7071, -0.7071, 0, 0))
        image, points = client.image(), client.points([(0.5, 0.5), (0.4, 0.6)])
    with Lines(port=lines.port) as client:
        view = client.image({"camera": [0, -12, 3]}, "inline")["radiance"].tobytes()
    return image, points, view


def main():
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pangu, lines = Server(), Server("--json-lines")
        before = reference_replies(pangu, lines)
        visitors = [Visitor(lambda: Client(port=pangu.port), ask_pangu, k, begin + SECONDS) for k in range(3)]
        visitors += [Visitor(lambda: Lines(port=lines.port), ask_lines, k, begin + SECONDS) for k in range(3)]
        for visitor in visitors:
            visitor.start()
        warm = None
        while time.monotonic() < begin + SECONDS:
            time.sleep(min(1, SECONDS / 50))
            if warm is None and time.monotonic() > begin + SECONDS / 10:
                warm = pangu.use(), lines.use()
            for visitor in visitors:
                if visitor.problem:
                    sys.exit(f"soak_test: {visitor.problem}")
                if visitor.is_alive() and time.monotonic() - visitor.begun > LONGEST:
                    sys.exit(f"soak_test: a request hangs for {LONGEST} s")
        for visitor in visitors:
            visitor.join(LONGEST)
            if visitor.is_alive() or visitor.problem:
                sys.exit(f"soak_test: {visitor.problem or 'a client hangs'}")
        time.sleep(1.5)  # connections that end
        end = pangu.use(), lines.use()
        total = sum(visitor.count for visitor in visitors)
        print(f"{total} requests in {SECONDS:.0f} s, the longest {max(visitor.longest for visitor in visitors):.2f} s; "
              f"kB, descriptors, threads after a tenth {warm}, at the end {end}")
        for old, new in zip(warm, end):
            if new[0] > old[0] + MOST_GROWTH or new[1] > old[1] + 8 or new[2] > old[2] + 4:
                sys.exit(f"soak_test: grown from {old} to {new}")
        if min(visitor.count for visitor in visitors) < 20:
            sys.exit("soak_test: a client was hardly answered")
        if reference_replies(pangu, lines) != before:
            sys.exit("soak_test: replies are others than at the begin")
        for server in (pangu, lines):
            server.process.terminate()
            if server.process.wait(30) != 0:
                sys.exit("soak_test: the server does not end cleanly")
        os.chdir("/")


main()
