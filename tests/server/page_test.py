#!/usr/bin/env python3
"""The page of `serve --web` for browsers. page_test.py PANWRIGHT SOURCE_DIR [CHROMIUM]

A WebSocket client of the standard library alone, written from RFC 6455, and headless Chromium where it is installed.
"""

import atexit
import math
import os
import re
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
sys.path.insert(0, os.path.join(SOURCE, "server", "clients"))
from panwright_client import Client, read_ppm  # noqa: E402
from web_sockets import message, opened  # noqa: E402

WIDTH, HEIGHT = 320, 240  # messages of several pieces
QUAT = (math.sqrt(0.5), -math.sqrt(0.5), 0, 0)


def expect(condition, what):
    if not condition:
        raise SystemExit(f"page_test: {what}")


def newest(connection, images):
    while True:
        text, pixels = message(connection)
        if text["images"] >= images:
            return text, pixels


def srgb(code):
    """Of a linear code."""
    value = code / 255
    return 255 * (12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055)


def serve(*options):
    process = subprocess.Popen([PROGRAM, "serve", os.path.join(SOURCE, "examples/servicer/servicer.pxn"), "--size", f"{WIDTH}x{HEIGHT}", "--fov",
                                "40", "--sun", "1 -2 2", "--engine", "reference", "--samples", "1", "--port", "0", "--web", "0", *options],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    atexit.register(process.kill)
    page = re.fullmatch(r"page on http://127\.0\.0\.1:(\d+)/\n", process.stdout.readline())
    expect(page, "the place of the page is printed")
    line = process.stdout.readline()
    return process, int(page[1]), int(line.rsplit(":", 1)[1])


def check_page(web):
    with urllib.request.urlopen(f"http://127.0.0.1:{web}/", timeout=30) as answer:
        text = answer.read().decode()
        expect(answer.headers["Content-Type"] == "text/html; charset=utf-8", "the page is HTML")
        expect("default-src 'none'" in answer.headers["Content-Security-Policy"], "the page loads nothing else")
    with open(os.path.join(SOURCE, "server/page/page.html"), encoding="utf-8") as file:
        expect(text == file.read(), "the page is the file")
    for path in ("/nothing", "/../server.h", "/%2e%2e/%2e%2e/etc/passwd"):
        try:
            urllib.request.urlopen(f"http://127.0.0.1:{web}{path}", timeout=30)
            expect(False, f"{path} is not there")
        except urllib.error.HTTPError as error:
            expect(error.code in (403, 404), f"{path} answers {error.code}")


def check_images(web, client):
    viewer, _ = opened(web, origin=f"http://127.0.0.1:{web}")
    expect(viewer, "the page's own script is let in")
    joint = client.joints(0)[0]
    expected = None
    for k in range(5):
        client.set_viewpoint((0.5 * k, -14, 0), QUAT)
        client.set_joint(0, 0, 0.2 * k)
        expected = read_ppm(client.image())
    text, pixels = newest(viewer, 5)
    expect((text["images"], text["client"]) == (5, 1), "the last image is shown")
    expect((text["width"], text["height"]) == expected[:2] == (WIDTH, HEIGHT), "its size")
    worst = max(abs(shown - srgb(code)) for shown, code in zip(pixels, expected[2]))
    # half of a linear code is 6.5 sRGB codes at black, where their slope is 12.92
    expect(len(pixels) == 3 * WIDTH * HEIGHT and worst <= 7, f"pixels are those of the reply: {worst}")
    bright = max(abs(shown - srgb(code)) for shown, code in zip(pixels, expected[2]) if code > 60)
    print(f"largest difference of sRGB codes {worst:.2f}, of pixels that are not dark {bright:.2f}")
    expect(bright <= 1.2, "bright pixels within a code")
    near = lambda a, b: all(abs(x - y) < 1e-6 for x, y in zip(a, b))
    expect(near(text["camera"]["position"], [2, -14, 0]) and near(text["camera"]["quat"], QUAT), "the camera")
    expect(abs(text["camera"]["fov_deg"][0] - 40) < 1e-9, "the field of view")
    length = math.sqrt(9)
    expect(near(text["sun"]["direction"], [1 / length, -2 / length, 2 / length]) and text["sun"]["distance_au"] == 1, "the Sun")
    expect([each["name"] for each in text["objects"]] == ["servicer"], "the objects")
    joints = text["objects"][0]["joints"]
    expect(joint and abs(joints[0]["values"][0] - 0.8) < 1e-6, "joints")
    expect(text["answer_ms"]["last"] > 0 and text["answer_ms"]["99 %, at most"] >= text["answer_ms"]["median, at most"], "times")


def check_strangers(web):
    for origin, host in (("http://evil.example", None), ("http://evil.example", "evil.example"), ("null", None),
                         (f"http://evil.example:{web}", f"evil.example:{web}"), (f"https://127.0.0.1:{web}", None)):
        connection, head = opened(web, origin=origin, host=host)
        expect(connection is None, f"a page of {origin} at {host} is refused: {head}")
    expect(opened(web, origin=f"http://localhost:{web}", host=f"localhost:{web}")[0], "localhost is this machine")


def check_crowd(web, client):
    """Browsers that read nothing, say something or are too many: clients are served, and the memory ends."""
    silent = [opened(web)[0] for _ in range(20)]
    expect(sum(one is not None for one in silent) < 10, "the number of browsers is limited")
    began = time.monotonic()
    for _ in range(50):
        client.image()
    print(f"50 images beside silent browsers: {20 * (time.monotonic() - began):.1f} ms each")
    for one in silent:
        if one is not None:
            one.close()
    time.sleep(0.5)
    talker, _ = opened(web)
    expect(talker, "places are free again")
    talker.sendall(bytes([0x82, 0x84, 1, 2, 3, 4, 0, 0, 0, 0]))
    talker.settimeout(30)
    try:
        while talker.recv(1 << 16):
            pass
    except ConnectionError:
        pass
    with socket.create_connection(("127.0.0.1", web), 30) as garbage:
        garbage.sendall(bytes(range(256)) * 40)
    client.image()


def check_chromium(chromium, web, client):
    client.image()
    for _ in range(5):  # its time for a page may end before the first image comes
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([chromium, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                                   f"--user-data-dir={folder}", "--virtual-time-budget=20000", "--dump-dom", f"http://127.0.0.1:{web}/"],
                                  capture_output=True, text=True, timeout=240, check=False)
        if "data-images" in done.stdout:
            break
    expect(re.search(r'data-images="\d+"', done.stdout), f"Chromium shows an image: {done.stdout[-2000:]}{done.stderr[-2000:]}")
    expect("image " in done.stdout and "servicer" in done.stdout and f"{WIDTH} × {HEIGHT}" in done.stdout, "and what it is")
    print("Chromium shows the page")


def main():
    process, web, port = serve()
    with Client(port=port) as client:
        check_page(web)
        check_images(web, client)
        check_strangers(web)
        check_crowd(web, client)
        viewer, _ = opened(web)
        newest(viewer, 56)
        time.sleep(11)  # longer than a browser has to take a piece of an image
        client.image()
        newest(viewer, 57)
        if len(sys.argv) > 3 and os.path.exists(sys.argv[3]):
            check_chromium(sys.argv[3], web, client)
        else:
            print("Chromium is not installed: the page is not shown")
        busy = subprocess.run([PROGRAM, "serve", os.path.join(SOURCE, "examples/client/client.pxn"), "--port", "0", "--web", str(web)],
                              capture_output=True, text=True, timeout=120, check=False)
        expect(busy.returncode == 2 and "[E0201]" in busy.stderr and "--web 0" in busy.stderr, f"a port in use is said: {busy.stderr}")
    process.terminate()
    expect(process.wait(30) == 0, "the server ends cleanly")


main()
