#!/usr/bin/env python3
"""The shipped clients steer to docking, from Python, C89 and Octave: the same steps; the S-function steps in Octave.

    clients_test.py PANWRIGHT SOURCE_DIR CC [OCTAVE]

Octave is left out where it or its package sockets is not installed, and it says so.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM, SOURCE, COMPILER = sys.argv[1:4]
OCTAVE = sys.argv[4] if len(sys.argv) > 4 and "NOTFOUND" not in sys.argv[4] else None
LOOP = pathlib.Path(SOURCE) / "examples" / "closed_loop"
SFUN = pathlib.Path(SOURCE) / "tests" / "server" / "sfun" / "run_sfun.m"


def expect(condition, what):
    if not condition:
        raise SystemExit(f"clients_test: {what}")


def steered(words):
    done = subprocess.run(words, capture_output=True, text=True, timeout=200)
    expect(done.returncode == 0, f"{words}: {done.stdout}{done.stderr}")
    steps = re.findall(r"step \d+: .*", done.stdout)
    end = re.search(r"docked at (\S+) (\S+) (\S+)", done.stdout)
    expect(end and len(steps) > 5, done.stdout)
    x, y, z = map(float, end.groups())
    # the axis of the client is x = y = 0, its ring at z = 3.61 m; its markings move the centre of brightness
    expect(abs(x) < 0.15 and abs(y) < 0.15 and 5.5 < z < 7, end.group())
    return steps, end.group()


def started(size):
    server = subprocess.Popen([PROGRAM, "serve", str(LOOP.parent / "client" / "client.pxn"), "--port", "0", "--size", size, "--samples", "2",
                               "--clients", "4"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    line = server.stdout.readline()
    if not line:
        error = server.stderr.read()
        if "E5007" in error or "E5001" in error:
            print("skipped: no OpenGL")
            sys.exit(77)
        expect(False, error)
    return server, line.rsplit(":", 1)[1].strip()


def check_s_function():
    server, port = started("64x48")
    try:
        done = subprocess.run([OCTAVE, "-qf", str(SFUN), str(pathlib.Path(SOURCE) / "server" / "clients"), port], capture_output=True, text=True,
                              timeout=200)
        expect("the S-function steps\n" in done.stdout, done.stdout + done.stderr)
    finally:
        server.kill()


def by_page(port):
    """The lines of Python in docs/server.md: an image with light, and the same distance by both look-ups."""
    page = (pathlib.Path(SOURCE) / "docs" / "server.md").read_text(encoding="utf-8")
    lines, = re.findall(r"```python\n(.*?)```", page, re.S)
    expect("port=10363" in lines, "the page names the port")
    done = subprocess.run([sys.executable, "-W", "error", "-c", lines.replace("port=10363", f"port={port}")],
                          cwd=pathlib.Path(SOURCE) / "server" / "clients", capture_output=True, text=True, timeout=200)
    expect(done.returncode == 0, done.stderr)
    size, point, pulse = done.stdout.splitlines()
    expect(size.startswith("64 64 ") and int(size.split()[2]) > 20, size)
    (x, y, z), = eval(point)
    expect(abs(x) + abs(y) < 0.2 and abs(eval(pulse)[0] - (14 - z)) < 1e-3, point + pulse)


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "docking")
        subprocess.run([COMPILER, "-std=c89", "-pedantic-errors", "-Wall", "-Wextra", "-Werror", str(LOOP / "docking.c"), "-lm", "-o", program],
                       check=True)
        server, port = started("64x64")
        try:
            by_python = steered([sys.executable, str(LOOP / "docking.py"), port])
            expect(steered([program, port]) == by_python, "C steers as Python does")
            has_sockets = OCTAVE and subprocess.run([OCTAVE, "--eval", "pkg load sockets"], capture_output=True).returncode == 0
            if has_sockets:
                expect(steered([OCTAVE, "-qf", str(LOOP / "docking.m"), port]) == by_python, "Octave steers as Python does")
                check_s_function()
            else:
                print("without Octave: it or its package sockets is not installed")
            by_page(port)
            server.terminate()
            expect(server.wait(20) == 0, "the server ends cleanly")
        finally:
            server.kill()


main()
