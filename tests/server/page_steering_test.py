#!/usr/bin/env python3
"""`serve --web --web-control`, and the page of `--json-lines`. page_steering_test.py PANWRIGHT SOURCE_DIR [CHROMIUM]"""

import atexit
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
import time

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
sys.path.insert(0, os.path.join(SOURCE, "server", "clients"))
from panwright_client import Client, pack_double  # noqa: E402
from panwright_lines import Lines  # noqa: E402
from web_sockets import Chromium, message, opened, send, wait_for  # noqa: E402

WIDTH, HEIGHT = 96, 64
QUAT = (math.sqrt(0.5), -math.sqrt(0.5), 0, 0)
DRAW = struct.pack(">II", 30, 0)  # GetViewpointByCamera
STEER = "panwright-steer, panwright"


def expect(condition, what):
    if not condition:
        raise SystemExit(f"page_steering_test: {what}")


def near(a, b, tolerance=1e-9):
    return all(abs(x - y) <= tolerance for x, y in zip(a, b))


def doubles(number, *values):
    return struct.pack(">I", number) + b"".join(pack_double(value) for value in values)


class Server:
    """Its process, and the ports of its page and of its clients."""

    def __init__(self, *options):
        self.process = subprocess.Popen(self.words(*options), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)
        self.web = int(re.search(r":(\d+)/$", self.process.stdout.readline().strip())[1])
        self.port = int(self.process.stdout.readline().rsplit(":", 1)[1])

    @staticmethod
    def words(*options):
        return [PROGRAM, "serve", os.path.join(SOURCE, "examples/servicer/servicer.pxn"), "--size", f"{WIDTH}x{HEIGHT}", "--fov", "40", "--sun",
                "1 -2 2", "--camera", "0 -14 0", "--engine", "reference", "--samples", "1", "--port", "0", "--web", "0", *options]

    def viewer(self, protocol=STEER):
        connection, head = opened(self.web, origin=f"http://127.0.0.1:{self.web}", protocol=protocol)
        expect(connection, head)
        return connection, "panwright-steer" in head

    def end(self):
        self.process.terminate()
        expect(self.process.wait(60) == 0, f"the server ends cleanly: {self.process.stderr.read()}")


def shown(viewer, what, good):
    """The first image that is as it should be."""
    for _ in range(50):
        text, _ = message(viewer)
        if good(text):
            return text
    return expect(False, what)


def check_requests(folder):
    """A page moves what it shows, a client sees it, and the log repeats it."""
    log = os.path.join(folder, "log.jsonl")
    server = Server("--web-control", "--log", log)
    viewer, steers = server.viewer()
    expect(steers, "the server says that pages may steer")
    send(viewer, DRAW)
    text = shown(viewer, "a page without clients", lambda text: text["images"] == 1)
    expect(near(text["camera"]["position"], [0, -14, 0], 1e-12) and text["client"] >= 1 << 32, "it sees a world of its own")
    send(viewer, doubles(269, 1, -12, 2, *QUAT))
    send(viewer, DRAW)
    text = shown(viewer, "the camera moves", lambda text: near(text["camera"]["position"], [1, -12, 2], 1e-12))
    with Client(port=server.port) as client:
        first = client.image()
        text = shown(viewer, "the client's image is shown", lambda text: text["client"] == 1)
        expect(near(text["camera"]["position"], [0, -14, 0], 1e-12), "the client's world is its own")
        joint = text["objects"][0]["joints"][0]
        send(viewer, doubles(271, 0, 30, 60))
        send(viewer, struct.pack(">III", 272, text["objects"][0]["number"], joint["index"]) + struct.pack(">I", 1) + pack_double(0.5) + b"\1")
        send(viewer, DRAW)
        text = shown(viewer, "Sun and joint move", lambda text: text["objects"][0]["joints"][0]["values"][0] == 0.5)
        # residual: 1e-16
        expect(near(text["sun"]["direction"], [0.25 * math.sqrt(3), 0.25, 0.5 * math.sqrt(3)], 1e-15), "the Sun")
        expect(client.image() != first, "the client sees what the page moved")
        # numbers that are none, and names of nothing, leave the world as it is
        before = shown(viewer, "its image", lambda text: text["client"] == 1)
        for wrong in (doubles(269, math.nan, 0, 0, *QUAT), doubles(269, 0, 0, 0, 0, 0, 0, 0), doubles(269, 1e300, 0, 0, *QUAT),
                      doubles(271, 0, math.inf, 0), struct.pack(">IIII", 272, 99, 0, 0)):
            send(viewer, wrong)
        send(viewer, DRAW)
        after = shown(viewer, "an image after them", lambda text: text["images"] > before["images"])
        expect(all(after[key] == before[key] for key in ("camera", "sun", "objects")), "wrong numbers change nothing")
    server.end()
    repeated = subprocess.run([*Server.words()[:-2], "--replay", log], capture_output=True, text=True, timeout=300, check=False)
    expect(repeated.returncode == 0, f"the log repeats what the page did: {repeated.stdout}{repeated.stderr}")
    return open(log, encoding="utf-8").read()


def closes(connection):
    """The server ends the connection."""
    connection.settimeout(60)
    try:
        while connection.recv(1 << 16):
            pass
    except ConnectionError:
        pass
    return True


def check_hostile(server):
    """Messages that a page may not send end its connection alone."""
    whole = doubles(269, 0, -14, 0, *QUAT)
    for name, say in {
            "a request of clients": lambda to: send(to, struct.pack(">I", 27)),  # Quit
            "an image of the client's turn": lambda to: send(to, struct.pack(">I", 1)),
            "an unknown request": lambda to: send(to, struct.pack(">I", 9999)),
            "half a request": lambda to: send(to, whole[:-1]),
            "more than one": lambda to: send(to, whole + DRAW),
            "nothing": lambda to: send(to, b""),
            "three bytes": lambda to: send(to, b"\0\0\1"),
            "text": lambda to: send(to, DRAW, 1),
            "fragments": lambda to: (send(to, whole[:8], 2, False), send(to, whole[8:], 0)),
            "a long message": lambda to: send(to, bytes(100000)),
            "a count of 4 GiB": lambda to: send(to, struct.pack(">IIII", 272, 0, 0, 0xFFFFFFFF)),
            "a length of 4 GiB": lambda to: to.sendall(bytes([0x82, 0xFF]) + struct.pack(">Q", 1 << 32) + bytes(4096))}.items():
        viewer, _ = server.viewer()
        try:
            say(viewer)
        except ConnectionError:
            pass
        expect(closes(viewer), name)
        viewer.close()
    plain, steers = server.viewer("panwright")
    expect(not steers, "a page that does not ask to steer")
    flood, _ = server.viewer()
    with Client(port=server.port) as client:
        began = time.monotonic()
        try:
            for _ in range(3000):
                flood.sendall(bytes([0x82, 0x80 | len(DRAW)]) + bytes(4) + DRAW)
        except ConnectionError:
            pass
        for _ in range(20):
            client.image()
        print(f"20 images beside a page that floods: {50 * (time.monotonic() - began):.1f} ms each")
    for each in (plain, flood):
        each.close()


def check_read_only():
    server = Server()
    viewer, steers = server.viewer()
    expect(not steers, "a page steers when asked alone")
    send(viewer, DRAW)
    expect(closes(viewer), "else what it says ends its connection")
    server.end()


def check_lines(folder):
    """The page of JSON Lines shows each image, however it goes to its client."""
    server = Server("--json-lines", "--folder", folder)
    viewer, steers = server.viewer()
    expect(not steers, "views say all there is: a page has nothing to move")
    with Lines(port=server.port) as client:
        for k, way in enumerate(({"image": "inline"}, {"image": "shared"}, {"output": "a.npy"})):
            answer = client.ask({"camera": [0, -12 - k, 0], "look-at": [0, 0, 0], "sun": [0, -1, 0], **way})
            expect(answer["ok"], answer)
            text, pixels = message(viewer)
            expect(text["images"] == k + 1 and near(text["camera"]["position"], [0, -12 - k, 0]), f"the image of {way}")
            expect(near(text["sun"]["direction"], [0, -1, 0]) and text["objects"][0]["name"] == "servicer", "and what it shows")
            expect(len(pixels) == 3 * WIDTH * HEIGHT and max(pixels) > 60, "its pixels")
    server.end()
    for words, what in ((Server.words("--web-control", "--json-lines"), "cannot be combined with --json-lines"),
                        ([*Server.words()[:-2], "--web-control"], "requires --web")):
        done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
        expect(done.returncode == 2 and what in done.stderr, done.stderr)


def check_chromium(program, server):
    """Drags, the wheel and inputs of a real browser."""
    browser = Chromium(program, f"http://127.0.0.1:{server.web}/")
    state = lambda: browser.evaluate("typeof camera === 'undefined' || camera === null ? null : {p: camera.position, q: camera.quat, busy: busy !== null || waiting.size > 0}")
    settled = lambda: (lambda now: now if now and not now["busy"] else None)(state())
    begin = wait_for(settled, "the page shows an image")
    expect(near(begin["p"], [0, -14, 0]), f"of a world of its own: {begin}")
    x, y, width = browser.evaluate("(r => [Math.round(r.left + r.width / 2), Math.round(r.top + r.height / 2), at('image').clientWidth])"
                                   "(at('image').getBoundingClientRect())")
    expect(width == WIDTH, f"the image has its own size: {width}")
    browser.mouse("mousePressed", x, y, button="left", clickCount=1)
    for k in range(1, 5):
        browser.mouse("mouseMoved", x + k * width // 16, y, button="left", buttons=1)
    browser.mouse("mouseReleased", x + width // 4, y, button="left", clickCount=1)
    # a quarter of the width is 45 degrees to the left, about the object in the origin; residual: 2e-15 m
    around = [-14 * math.sqrt(0.5), -14 * math.sqrt(0.5), 0]
    after = wait_for(lambda: (lambda now: now if now and near(now["p"], around, 1e-9) else None)(settled()), "a drag goes around the object")
    browser.mouse("mouseWheel", x, y, deltaX=0, deltaY=-250)
    closer = wait_for(lambda: (lambda now: now if now and near([math.hypot(*now["p"])], [14 * math.exp(-0.5)], 1e-9) else None)(settled()),
                      "the wheel comes closer")
    expect(near(closer["q"], after["q"]), "and does not turn")
    browser.evaluate("at('azimuth').value = 90, at('elevation').value = 0, at('azimuth').oninput()")
    joint = browser.evaluate("(e => { e.value = 0.25; e.oninput(); return e.id; })(document.querySelector('#objects input'))")
    expect(re.fullmatch(r"joint-0-\d+-0", joint), joint)
    wait_for(lambda: settled() and "0.0000     1.0000     0.0000" in browser.evaluate("at('sun').textContent"), "the Sun moves")
    wait_for(lambda: browser.evaluate("document.querySelector('#objects input').value") == "0.2500", "the joint moves")
    browser.close()
    print("Chromium steers")


def main():
    with tempfile.TemporaryDirectory() as folder:
        log = check_requests(folder)
        expect("SetViewpointByQuaternionD" in log and "GetViewpointByCamera" in log, "the log has what the page asks")
        check_read_only()
        check_lines(folder)
        server = Server("--web-control")
        check_hostile(server)
        if len(sys.argv) > 3 and os.path.exists(sys.argv[3]):
            check_chromium(sys.argv[3], server)
        else:
            print("Chromium is not installed: the page is not dragged")
        server.end()


main()
