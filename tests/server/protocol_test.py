#!/usr/bin/env python3
"""All requests of the protocol, by a client written from the tables of docs/server-protocol.md alone. protocol_test.py PANWRIGHT SOURCE_DIR

Each request is sent with its bytes as the table has them, and its reply is read to the last byte.
"""

import atexit
import json
import math
import os
import socket
import struct
import subprocess
import sys
import tempfile
import urllib.request

PROGRAM, SOURCE = sys.argv[1:3]
OPTIONS = ["--size", "24x16", "--fov", "40", "--engine", "reference", "--samples", "1"]
SCENE = """<pangu_model ver="1" units="m">
  <node name="slab"><box size="4 4 2"/></node>
  <joint name="slide" type="prismatic" axis="1 0 0" lower="0" upper="3"><box size="0.5 0.5 0.5" translate="5 0 0"/></joint>
  <frame name="mast" translate="0 0 5" forward="0 0 -1" up="0 1 0"/>
</pangu_model>
"""


def word(value):
    return struct.pack(">I", value & 0xFFFFFFFF)


def turned(bits, size, by):
    return (bits << by | bits >> (size - by)) & ((1 << size) - 1)


def f(*values):
    return b"".join(word(turned(struct.unpack(">I", struct.pack(">f", value))[0], 32, 9)) for value in values)


def d(*values):
    out = b""
    for value in values:
        bits = turned(struct.unpack(">Q", struct.pack(">d", value))[0], 64, 12)
        out += word(bits) + word(bits >> 32)
    return out


class Wire:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), 60)
        self.socket.sendall(word(0x114))
        expect(self.u() == 0, "the greeting")

    def send(self, number, *fields):
        self.socket.sendall(word(number) + b"".join(fields))

    def read(self, count):
        out = b""
        while len(out) < count:
            part = self.socket.recv(count - len(out))
            expect(part, "the connection ended")
            out += part
        return out

    def u(self):
        return struct.unpack(">I", self.read(4))[0]

    def b(self):
        return self.read(1)[0]

    def f(self):
        return struct.unpack(">f", word(turned(self.u(), 32, 23)))[0]

    def d(self):
        low, high = self.u(), self.u()
        return struct.unpack(">d", struct.pack(">Q", turned(high << 32 | low, 64, 52)))[0]

    def s(self):
        text = self.read(struct.unpack(">H", self.read(2))[0])
        expect(len(text) % 2 == 0 and text[-1] == 0, text)
        return text.rstrip(b"\0").decode()

    def reply(self, code):
        got = self.u()
        if got == 1:
            sys.exit(f"error {self.u()}: {self.s()}, expected reply {code}")
        expect(got == code, f"reply {got}, expected {code}")


def expect(condition, what):
    if not condition:
        raise SystemExit(f"protocol_test: {what}")


def close(a, b, tolerance=1e-6):
    return abs(a - b) <= tolerance * max(1, abs(b))


def check_vectors():
    """Bytes that outside notes give."""
    for value, floats, doubles in ((1, "0000007F", "000003FF00000000"), (30, "E0000083", "00000403E0000000"),
                                   (-2.5, "40000180", "00000C0040000000"), (.1, "99999A7B", "9999A3FB99999999")):
        expect(f(value) == bytes.fromhex(floats) and d(value) == bytes.fromhex(doubles), value)


def images(wire):
    size = 24 * 16 * 3
    down = f(0, 0, 11), f(0, -90, 0), f(0, 1, 0, 0)
    exact = d(0, 0, 11), d(0, -90, 0), d(0, -math.pi / 2, 0), d(0, 1, 0, 0)
    seen = set()
    for number, fields in ((11, down[0] + down[1]), (12, down[0] + down[2]), (16, exact[0] + exact[1]), (17, exact[0] + exact[3]),
                           (26, exact[0] + exact[2]), (1, b""), (30, word(1))):
        wire.send(number, fields)
        wire.reply(2)
        data = wire.read(wire.u())
        expect(data[:13] == b"P6\n24 16\n255\n" and len(data) == 13 + size, (number, data[:20]))
        seen.add(data)
    expect(len(seen) == 1, "the same viewpoint in several ways")
    for fields, count in ((word(0) + word(0), 13 + size), (word(0) + word(4), 0), (word(9) + word(0), 0)):
        wire.send(28, fields)
        wire.reply(2)
        expect(len(wire.read(wire.u())) == count, "an image of a frame")
    wire.send(10)
    wire.reply(2)
    texture = wire.read(wire.u())
    expect(texture[:14] == b"P6\n256 1\n255\n\0" and texture[-1] == 255, texture[:20])
    wire.send(9, f(5, 0.1))  # from 5 m to 15 m
    wire.reply(2)
    data = wire.read(wire.u())[13:]
    expect(data[3 * (8 * 24 + 12)] in (127, 128) and data[0] == 255, data[3 * (8 * 24 + 12)])
    wire.send(33)
    wire.reply(12)
    expect(wire.d() == 0 and wire.b() == 1, "the time of an image")


def look_ups(wire):
    wire.send(2)
    wire.reply(3)
    expect(close(wire.f(), 10) and wire.b() == 1, "the elevation of the camera")
    wire.send(3, word(2), f(0, 0, 3, 9, 9, 9))
    wire.reply(4)
    expect([wire.u(), wire.f(), wire.b(), wire.f(), wire.b()] == [2, 2, 1, 0, 0], "elevations")
    wire.send(4, f(.5, .5))
    wire.reply(5)
    expect(close(wire.f(), 0) and close(wire.f(), 0) and close(wire.f(), 1) and wire.b() == 1, "a point")
    wire.send(5, word(2), f(.5, .5, 0, 0))
    wire.reply(6)
    expect(wire.u() == 2 and len(wire.read(26)) == 26, "points")
    wire.send(6, f(0, 0, -2))
    wire.reply(5)
    expect(wire.read(13) == f(0, 0, 1) + b"\1", "a point along a direction")
    wire.send(7, word(1), f(0, 0, 1))
    wire.reply(6)
    expect(wire.u() == 1 and wire.read(13) == f(0, 0, 0) + b"\0", "nothing above the camera")
    wire.send(8, word(5), b"hello")
    wire.reply(8)
    expect(wire.read(9) == word(5) + b"hello", "an echo")
    wire.send(23, b"\1", f(5, 0))
    wire.reply(3)
    expect(wire.read(5) == f(.25) + b"\1", "a surface elevation")
    wire.send(24, b"\0", word(2), f(0, 0, 30, 0))
    wire.reply(4)
    expect(wire.read(14) == word(2) + f(1) + b"\1" + f(0) + b"\0", "surface elevations")
    wire.send(25, b"\0", f(0, 0), word(3), word(2), f(1, 0))
    wire.reply(4)
    expect(wire.read(34) == word(6) + (f(1) + b"\1") * 6, "a patch")
    wire.send(31, word(1), b"\0", word(2), word(1), f(1, 1, 12))
    wire.reply(4)
    expect(wire.read(14) == word(2) + (f(2) + b"\1") * 2, "a view as DEM")


def objects(wire):
    wire.send(18, word(0))
    wire.reply(14)
    expect([wire.u(), wire.u(), wire.s(), wire.u()] == [1, 0, "slide", 2], "joints")
    wire.send(18, word(5))
    wire.reply(14)
    expect(wire.u() == 0, "joints of no object")
    wire.send(272, word(0), word(0), word(9), *(d(1.5 if k == 0 else 0) + bytes([k == 0]) for k in range(9)))
    wire.reply(0)
    wire.send(19, word(0), word(0))
    wire.reply(13)
    expect(wire.u() == 9 and wire.read(81) == d(1.5) + b"\1" + (d(0) + b"\1") * 8, "values of a joint")
    wire.send(20, word(0))
    wire.reply(15)
    expect([wire.u(), wire.u(), wire.s()] == [1, 0, "mast"], "frames")
    wire.send(21, word(0), word(0))
    wire.reply(13)
    expect(wire.u() == 12, "a frame")
    values = [(wire.d(), wire.b())[0] for _ in range(12)]
    expect(all(close(a, b) for a, b in zip(values, (0, 0, -1, 0, 1, 0, 1, 0, 0, 0, 0, 5))), values)
    wire.send(22, word(0), word(0))
    wire.reply(13)
    expect(wire.u() == 6, "angles of a frame")
    values = [(wire.d(), wire.b())[0] for _ in range(6)]
    expect(all(close(a, b) for a, b in zip(values, (0, -math.pi / 2, 0, 0, 0, 5))), values)
    wire.send(29, word(0))
    wire.reply(16)
    expect([wire.u(), wire.u(), wire.u()] == [80, 24, 16], "a camera")
    values = [wire.d() for _ in range(9)]
    expect(close(values[0], math.radians(40)) and values[2:5] == [0, 0, 11] and close(abs(values[6]), 1), values)
    wire.send(29, word(77))
    wire.reply(16)
    expect(wire.u() == 0, "no camera")


def instruments(wire):
    wire.send(13, f(0, 0, 3, .3, 0, -.4))
    wire.reply(9)
    expect(close(wire.f(), 2.5) and close(wire.f(), .8), "a pulse")
    wire.send(265, f(8, 4), word(4), word(2), f(0, 0), word(2), word(1), word(0), word(15), f(*[0] * 10), bytes(48))
    wire.reply(0)
    wire.send(266, word(1), word(0), word(28), f(0, 0, 2, 0, 0, 1, .5))
    wire.reply(0)
    wire.send(267, f(1, 0, 0, 0), f(*[0] * 9))
    wire.reply(0)
    wire.send(295, word(1), word(0), word(56), d(0, 0, 2, 0, 0, 1, .5))
    wire.reply(0)
    pose = 0, 0, 11, 0, 1, 0, 0
    for number, numbers in ((14, f), (34, f), (32, d)):
        wire.send(number, numbers(*pose), numbers(*[0] * 18))
        wire.reply(10)
        expect(wire.read(32) == f(8, 4) + word(4) + word(2) + f(0, 0) + word(2) + word(1), "parameters of a scan")
        wire.read(96)
        expect(wire.u() == 4 * 8 * 16, "bytes of a scan")
        values = [wire.f() for _ in range(4 * 2 * 16)]
        expect(10 <= min(values[0:32:2]) < 10.02 and min(values[64:96:2]) >= 0, values[:8])
        expect(9 <= max(values[64:96:2]) < 9.02, "the corner cube at 9 m")
    wire.send(298, word(2), word(0), word(128), d(0, 1, 0, 0, 0, 0, 0, 0), d(1, 1, 0, 0, 0, 0, 0, 0))
    wire.reply(0)
    wire.send(265, f(8, 4), word(2), word(1), f(0, 0), word(1), word(1), word(7), word(9), f(*[0] * 10), bytes(48))
    wire.reply(0)
    wire.send(32, d(*pose), d(0, 0, -2), d(*[0] * 15))  # one second later 2 m lower
    wire.reply(10)
    wire.read(128)
    expect(wire.u() == 32, "bytes of a scan")
    expect([wire.f() for _ in range(8)] == [10, 1, 8, 1, 0, 0, 1, 0], "a scan while it moves")
    wire.send(35, word(0), d(*pose))
    wire.reply(17)
    expect([wire.u() for _ in range(5)] == [0, 0, 24, 16, 24 * 16 * 12], "a snapshot")
    pixels = struct.unpack(f">{24 * 16 * 3}f", wire.read(24 * 16 * 12))
    at = 3 * (8 * 24 + 12)
    expect(10 < pixels[at] < 10.02 and .99 < pixels[at + 1] < 1 and pixels[at + 2] == 1, pixels[at:at + 3])
    wire.send(15, word(0), word(100), word(5), word(3), f(0, 0, 0, 0), f(0, 0, 11), f(0, 0, -1), f(0, 1, 0, 0), f(5), bytes(52))
    wire.reply(11)
    expect(wire.u() == 0, "a RADAR response")
    values = [wire.f() for _ in range(10)]
    expect([wire.u() for _ in range(3)] == [5, 3, 100] and wire.read(40) == bytes(40), "bins of a RADAR")
    bins = [wire.f() for _ in range(15)]
    expect(close(sum(bins), values[1], 1e-5) and max(bins) == values[0], values)


def commands(wire):
    yes = b"\1"
    for number, fields in (
            (256, f(1, 2, 3, 4, 5, 6)), (257, f(1, 2, 3, 1, 0, 0, 0)), (258, f(0, 0, 0)), (259, f(1, 1, 1)), (260, word(0)), (261, f(40)),
            (262, f(1)), (263, word(0) + yes), (264, word(0) + yes + yes), (268, d(1, 2, 3, 4, 5, 6)), (269, d(0, 0, 11, 0, 1, 0, 0)),
            (270, word(0) + d(0, 0, 0, 1, 0, 0, 0)), (271, d(1.5e11, 10, 20)), (273, d(1, 0, 0, 0)), (274, d(6)), (275, d(1, 2, 3)),
            (276, d(1.25)), (277, word(0) + word(1)), (278, d(1, 2, 3, .4, .5, .6)), (279, f(math.radians(40))), (280, d(0, .1, .2)),
            (281, d(1, 2, 3)), (282, f(.1, .2, .3)), (283, f(.3, .3, .5)), (284, f(*[0] * 6)), (285, word(0)), (286, d(0, 0, 0, 1)),
            (287, word(0) * 3), (288, word(2)), (288, word(0)), (289, word(0) + word(0) + b"\0"), (290, word(0) + f(1, 1, 1, 30, 0) + bytes(40)),
            (291, word(0) + f(1, 1, 1, .5, 0) + bytes(40)), (292, word(0) + d(0, 0, 0, 0, 0, 1)), (293, word(0) + word(0)), (294, word(0)),
            (296, word(0) + word(1)), (296, word(0) + word(0)), (297, word(0) + d(5, 5)), (299, word(0) + d(*[0] * 18))):
        wire.send(number, fields)
        wire.reply(0)
    wire.send(1)
    wire.reply(2)
    wire.read(wire.u())
    wire.send(33)
    wire.reply(12)
    expect(wire.d() == 1.25e6 and wire.b() == 1, "the time of an image")


def start(folder, *words):
    process = subprocess.Popen([PROGRAM, "serve", os.path.join(folder, "craft.pxn"), *OPTIONS, "--port", "0", *words], stdout=subprocess.PIPE,
                               text=True, cwd=folder)
    atexit.register(process.kill)
    line = process.stdout.readline()
    expect(line.startswith("listening on 127.0.0.1:"), line)
    return process, int(line.rsplit(":", 1)[1])


def main():
    check_vectors()
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "craft.pxn"), "w", encoding="utf-8") as file:
            file.write(SCENE)
        process, port = start(folder, "--log", "log.jsonl")
        wire = Wire(port)
        images(wire)
        look_ups(wire)
        objects(wire)
        instruments(wire)
        commands(wire)
        other = Wire(port)  # a world of its own: the slide is where it was
        other.send(23, b"\0", f(5, 0))
        other.reply(3)
        expect(other.read(5) == f(.25) + b"\1", "another client's world")
        metrics = json.load(urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics"))
        expect(metrics["clients"] == 2 and metrics["errors"] == 0 and metrics["requests"]["GetImage"]["count"] == 2, metrics)
        other.send(0)
        expect(other.socket.recv(1) == b"", "goodbye ends the connection")
        wire.send(27)
        wire.reply(0)
        expect(process.wait(20) == 0, "quit ends the server")
        # the log repeats to the same bytes; with another lens it does not
        again = subprocess.run([PROGRAM, "serve", "craft.pxn", *OPTIONS, "--replay", "log.jsonl"], capture_output=True, text=True, cwd=folder)
        expect(again.returncode == 0 and "have the same reply" in again.stdout, again.stdout + again.stderr)
        with open(os.path.join(folder, "log.jsonl"), encoding="utf-8") as log:
            kinds = {json.loads(line).get("name") for line in log} - {None}
        covered = json.loads(subprocess.run([PROGRAM, "serve", "--coverage", "--json"], capture_output=True, text=True).stdout)["requests"]
        expect(kinds == {each["name"] for each in covered}, {each["name"] for each in covered} - kinds)
        wide = subprocess.run([PROGRAM, "serve", "craft.pxn", *OPTIONS, "--fov", "50", "--replay", "log.jsonl"], capture_output=True, text=True,
                              cwd=folder)
        expect(wide.returncode in (1, 2), wide.stdout + wide.stderr)
        # one world for all clients
        process, port = start(folder, "--shared")
        one, two = Wire(port), Wire(port)
        one.send(270, word(0), d(0, 0, 3, 1, 0, 0, 0))
        one.reply(0)
        two.send(23, b"\0", f(0, 0))
        two.reply(3)
        expect(two.read(5) == f(4) + b"\1", "a shared world")
        process.terminate()
        expect(process.wait(20) == 0, "a signal ends the server cleanly")
        expect(sorted(os.listdir(folder)) == ["craft.pxn", "log.jsonl"], "files beside")


main()
