#!/usr/bin/env python3
"""Hostile clients against a server, beside an honest one that is answered throughout. hostile_test.py PANWRIGHT SOURCE_DIR"""

import os
import random
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

PROGRAM = sys.argv[1]
FRAMES = 10_000
SCENE = '<pangu_model ver="1" units="m"><box size="4 4 2"/></pangu_model>'
# number: bytes of its fields without elements
FIXED = {0: 0, 1: 0, 2: 0, 3: 4, 4: 8, 5: 4, 6: 12, 7: 4, 8: 4, 9: 8, 10: 0, 11: 24, 12: 28, 13: 24, 14: 100, 15: 128, 16: 48, 17: 56, 18: 4, 19: 8,
         20: 4, 21: 8, 22: 8, 23: 9, 24: 5, 25: 25, 26: 48, 28: 8, 29: 4, 30: 4, 31: 25, 32: 200, 33: 0, 34: 100, 35: 60, 256: 24, 257: 28, 258: 12,
         259: 12, 260: 4, 261: 4, 262: 4, 263: 5, 264: 6, 265: 128, 266: 12, 267: 52, 268: 48, 269: 56, 270: 60, 271: 24, 272: 12, 273: 32, 274: 8,
         275: 24, 276: 8, 277: 8, 278: 48, 279: 4, 280: 24, 281: 24, 282: 12, 283: 12, 284: 24, 285: 4, 286: 32, 287: 12, 288: 4, 289: 9, 290: 64,
         291: 64, 292: 52, 293: 8, 294: 4, 295: 12, 296: 8, 297: 20, 298: 12, 299: 148}


def expect(condition, what):
    if not condition:
        raise SystemExit(f"hostile_test: {what}")


def word(value):
    return struct.pack(">I", value)


def connect(port, greet=True):
    """A client; while others that left are still being answered, it is refused and tries again."""
    for _ in range(400):
        out = socket.create_connection(("127.0.0.1", port), 20)
        if not greet:
            return out
        out.sendall(word(0x114))
        if exactly(out, 4) == word(0):
            return out
        out.close()
        time.sleep(0.05)
    raise SystemExit("hostile_test: no greeting")


def exactly(wire, count):
    out = b""
    while len(out) < count:
        part = wire.recv(count - len(out))
        if not part:
            return out
        out += part
    return out


def ended(wire, code):
    """The error reply that a hostile client gets before its connection ends."""
    head = exactly(wire, 8)
    expect(head == word(1) + word(code), (code, head))
    length, = struct.unpack(">H", exactly(wire, 2))
    text = exactly(wire, length)
    expect(text.rstrip(b"\0"), "an error has a text")
    expect(wire.recv(1) == b"", "the connection ends")


class Honest(threading.Thread):
    """Asks for an echo and the elevation, again and again, and keeps the longest time."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.wire = connect(port)
        self.count, self.longest, self.wrong, self.stops = 0, 0.0, None, False

    def run(self):
        while not self.stops:
            begin = time.monotonic()
            self.wire.sendall(word(8) + word(3) + b"abc" + word(23) + b"\0" + bytes(8))
            got = exactly(self.wire, 11 + 9)
            if got[:11] != word(8) + word(3) + b"abc" or got[11:15] != word(3) or got[19:] != b"\1":
                self.wrong = got
                return
            self.longest = max(self.longest, time.monotonic() - begin)
            self.count += 1
            time.sleep(0.002)


def memory(process):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS:"))


def fuzz(port, numbers):
    """Frames of random fields; most are whole, and a connection is opened again where the server ends it."""
    wire = None
    for _ in range(FRAMES):
        if wire is None:
            wire = connect(port)
            wire.settimeout(20)
        number = numbers.choice(list(FIXED)) if numbers.random() < 0.97 else numbers.getrandbits(32)
        fields = bytearray(numbers.randbytes(FIXED.get(number, 8)))
        if numbers.random() < 0.8:  # small numbers of elements, cameras, pixels
            for at in range(0, len(fields) - 3, 4):
                if numbers.random() < 0.7:
                    fields[at:at + 4] = word(numbers.choice((0, 0, 1, 2, 0x7F, 0x80000080)))
        frame = word(number) + bytes(fields)
        if number not in (0, 27) and numbers.random() < 0.05:
            frame = frame[:numbers.randrange(4, len(frame) + 1)]
        try:
            wire.sendall(frame)
            if numbers.random() < 0.02:
                wire.close()
                wire = None
                continue
            wire.setblocking(False)
            try:
                if wire.recv(1 << 20) == b"":
                    wire = None
            except BlockingIOError:
                pass
            if wire is not None:
                wire.settimeout(20)
        except OSError:
            wire = None


def attack(port, process):
    numbers = random.Random(44)
    # versions of other protocols
    for version in (0, 0x0014, 0x0214, 0xFFFFFFFF, 0x14010000):
        wire = connect(port, greet=False)
        wire.sendall(word(version))
        ended(wire, 16)
    # requests that are none, and counts of four billion
    wire = connect(port)
    wire.sendall(word(12345))
    ended(wire, 17)
    for number, place in ((3, 0), (5, 0), (7, 0), (8, 0), (24, 1), (266, 0), (272, 8), (295, 0), (298, 0)):
        wire = connect(port)
        wire.sendall(word(number) + bytes(place) + word(0xFFFFFFFF) + bytes(64))
        ended(wire, 18)
    # byte by byte
    wire = connect(port, greet=False)
    for byte in word(0x114) + word(8) + word(2) + b"xy":
        wire.sendall(bytes([byte]))
        time.sleep(0.01)
    expect(exactly(wire, 14) == word(0) + word(8) + word(2) + b"xy", "an echo byte by byte")
    wire.close()
    # connections that end in the middle, and many at once
    for _ in range(200):
        wire = connect(port, greet=False)
        wire.sendall(word(0x114)[:numbers.randrange(5)])
        wire.close()
    many = []
    for _ in range(200):
        try:
            many.append(socket.create_connection(("127.0.0.1", port), 5))
        except OSError:
            break
    for wire in many:
        try:
            wire.sendall(word(0x114))
        except OSError:
            pass
    refused = 0
    for wire in many:  # all stay open meanwhile: a client that leaves makes room for another
        try:
            refused += exactly(wire, 4) != word(0)
        except OSError:
            refused += 1
    for wire in many:
        wire.close()
    expect(refused >= 180, f"{refused} of 200 clients were refused")
    time.sleep(0.3)
    # a client that asks and never reads
    deaf = connect(port)
    deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    deaf.setblocking(False)
    try:
        while True:
            deaf.send(word(8) + word(60000) + bytes(60000))
    except BlockingIOError:
        pass
    # half of a request, which has a deadline
    half = connect(port)
    half.sendall(word(8) + word(100) + b"half")
    begin = time.monotonic()
    fuzz(port, numbers)
    before = memory(process)
    fuzz(port, random.Random(45))
    after = memory(process)
    while after >= before + 30_000 and time.monotonic() < begin + 60:  # a reply of up to 64 MB may still be under way
        time.sleep(0.1)
        after = memory(process)
    expect(after < before + 30_000, f"memory grew from {before} to {after} kB")
    while time.monotonic() < begin + 5.5:
        time.sleep(0.1)
    ended(half, 20)
    deaf.close()


def main():
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "box.pxn"), "w", encoding="utf-8") as file:
            file.write(SCENE)
        process = subprocess.Popen([PROGRAM, "serve", "box.pxn", "--size", "4x4", "--engine", "reference", "--samples", "1", "--port", "0",
                                    "--max-request", "1MB", "--request-seconds", "5"], stdout=subprocess.PIPE, text=True, cwd=folder)
        port = int(process.stdout.readline().rsplit(":", 1)[1])
        honest = Honest(port)
        honest.start()
        try:
            attack(port, process)
            honest.stops = True
            honest.join(30)
            expect(process.poll() is None, "the server ended")
            expect(honest.wrong is None and honest.count > 20, (honest.wrong, honest.count))
            expect(honest.longest < 30, f"the honest client waited {honest.longest} s")
            print(f"{honest.count} honest replies, the longest after {honest.longest:.3f} s")
            process.terminate()
            expect(process.wait(20) == 0, "the server ends cleanly")
            expect(os.listdir(folder) == ["box.pxn"], "nothing was written")
        finally:
            process.kill()


main()
