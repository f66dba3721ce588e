#!/usr/bin/env python3
"""`render --views -` as a script drives it. serve_views.py PANWRIGHT EXAMPLE MODEL"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time

PROGRAM, EXAMPLE, MODEL = sys.argv[1:]
OPTIONS = ["--engine", "reference", "--samples", "1", "--size", "24x16"]


def start(*words):
    return subprocess.Popen([PROGRAM, "render", *words, "--views", "-", *OPTIONS], stdin=subprocess.PIPE,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def ask(process, line):
    """One line, and its answer: it comes before the next line is written."""
    process.stdin.write(line if isinstance(line, bytes) else (json.dumps(line) + "\n").encode())
    process.stdin.flush()
    return json.loads(process.stdout.readline())


def expect(condition, what):
    if not condition:
        sys.exit(f"serve_views: {what}")


def check_loop(folder):
    process = start(MODEL)
    frame = os.path.join(folder, "frame.npy")
    first = ask(process, {"name": "first", "output": frame})
    expect(first["ok"] and first["index"] == 0 and first["name"] == "first" and first["outputs"] == [frame], first)
    expect(first["errors"] == 0 and first["ms"] > 0 and first["engine"] == "reference", first)
    image = open(frame, "rb").read()
    # the same name again, and the settings of an answer make the same image
    other = ask(process, {"output": frame, "camera": [0, -40, 0]})
    expect(other["ok"] and open(frame, "rb").read() != image, other)
    same = ask(process, {**first["settings"], "output": frame})
    expect(same["ok"] and open(frame, "rb").read() == image, same)
    # wrong lines are answered, and the process goes on
    for line, code, words in (
            (b"{nonsense\n", "E0203", "invalid JSON at line 1, column 3"),
            ({"outpt": "a.png"}, "E0203", "view 4: unknown option 'outpt'"),
            ({"camera": [0, 0, 9]}, "E0203", "view 5: no output"),
            ({"output": "a.gif"}, "E0202", "view 6: "),
            ({"name": "n", "output": "a.png", "fov": 200}, "E0203", "view 7 ('n'): fov is '200'"),
            ([1], "E0203", "view 8: expected an object"),
            ({"output": MODEL + ".png", "targets": ["none.pan"]}, "E0101", "none.pan"),
            ({"output": os.path.join(folder, "no", "a.png")}, "E0103", ""),
            (b'{"output": "' + b"x" * (3 << 20) + b'"}\n', "E0203", "more than 1048576 bytes")):
        answer = ask(process, line)
        expect(not answer["ok"] and answer["errors"] > 0 and answer["outputs"] == [], answer)
        expect(any(each["code"] == code for each in answer["diagnostics"]), answer)
        expect(any(words in each["message"] for each in answer["diagnostics"]) or words == "none.pan", answer)
        expect("json." not in json.dumps(answer["diagnostics"]), answer)
    process.stdin.write(b"\n  \n")  # not views
    last = ask(process, {"outputs": [frame, frame + ".png"]})
    expect(last["ok"] and last["index"] == 12 and len(last["outputs"]) == 2, last)
    process.stdin.close()
    expect(process.wait() == 2, process.returncode)
    expect(process.stdout.read() == b"", "more was said than asked for")


def check_ends(folder):
    process = start(MODEL)
    frame = os.path.join(folder, "a.npy")
    expect(ask(process, {"output": frame})["ok"], "a view")
    process.stdin.write(json.dumps({"output": frame}).encode())  # the last line needs no end
    process.stdin.close()
    expect(json.loads(process.stdout.readline())["index"] == 1, "the last line")
    expect(process.wait() == 0, process.returncode)
    # a model that is not there: before the first line
    process = start(os.path.join(folder, "none.pan"))
    expect(process.wait() == 3 and b"[E0101]" in process.stderr.read(), "a model that is not there")
    process.stdin.close()
    # an idle process is stopped by a signal
    process = start(MODEL)
    expect(ask(process, {"output": frame})["ok"], "a view")
    process.send_signal(signal.SIGTERM)
    began = time.monotonic()
    process.wait(timeout=20)
    expect(process.returncode == -signal.SIGTERM and time.monotonic() - began < 10, process.returncode)
    process.stdin.close()


def check_example():
    done = subprocess.run([sys.executable, EXAMPLE, PROGRAM, MODEL], capture_output=True, text=True)
    if "[E5007]" in done.stderr or "E5001" in done.stderr:
        return  # without OpenGL
    lines = done.stdout.splitlines()
    expect(done.returncode == 0 and len(lines) >= 2, done.stdout + done.stderr)


def main():
    with tempfile.TemporaryDirectory() as folder:
        check_loop(folder)
        check_ends(folder)
    check_example()


main()
