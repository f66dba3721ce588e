#!/usr/bin/env python3
"""`serve --json-lines`: the answers of `render --views -`, images by all ways, several clients, hostile ones. lines_test.py PANWRIGHT SOURCE_DIR CC"""

import atexit
import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

PROGRAM, SOURCE, COMPILER = sys.argv[1:4]
sys.path.insert(0, os.path.join(SOURCE, "server", "clients"))
from panwright_lines import Lines, ServerError, TornImage  # noqa: E402

OPTIONS = ["--engine", "reference", "--samples", "1", "--size", "24x16"]
SCENE = '<pangu_model ver="1" units="m"><box size="4 4 2"/></pangu_model>'
VIEWS = [{"name": "first", "camera": [0, -9, 3]}, {"camera": [0, -12, 3], "fov": 30, "layers": ["depth", "node_id", "radiance"]},
         {"outpt": 3}, {"camera": [9, 0, 0], "sun": [1, 0, 0]}, {"fov": 400}, [1]]
C_CLIENT = """
#define PANWRIGHT_LINES_IMPLEMENTATION
#include "panwright_lines.h"
#include <stdio.h>
int main(int count, char** words) {
  pwl_client* client = pwl_open_path(words[1]);
  const pwl_layer* layer;
  unsigned long i, sum = 0;
  if (count < 2 || client == NULL) return 1;
  if (pwl_image(client, "{\\"image\\": \\"shared\\", \\"fov\\": 400}") == 0) return 2;
  fprintf(stderr, "%s\\n", pwl_error(client));
  if (pwl_image(client, "{\\"image\\": \\"shared\\", \\"camera\\": [0, -9, 3]}") != 0) { fprintf(stderr, "%s\\n", pwl_error(client)); return 3; }
  layer = pwl_find(client, "radiance");
  if (layer == NULL || pwl_find(client, "depth") != NULL || layer->type != PWL_FLOAT32) return 4;
  for (i = 0; i < 4ul * layer->width * layer->height * layer->channels; ++i) sum = (31 * sum + ((const unsigned char*)layer->data)[i]) % 1000000007;
  if (!pwl_is_whole(client)) return 5;
  printf("%u %u %u %lu\\n", layer->width, layer->height, layer->channels, sum);
  pwl_close(client);
  return 0;
}
"""


def expect(condition, what):
    if not condition:
        raise SystemExit(f"lines_test: {what}")


class Server:
    def __init__(self, *words):
        self.process = subprocess.Popen([PROGRAM, "serve", "box.pxn", *OPTIONS, "--json-lines", *words], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)
        line = self.process.stdout.readline()
        expect(line.startswith("listening on "), line or self.process.stderr.read())
        where = line.split()[2]
        self.place = {"path": where} if where.startswith(("/", ".")) else {"port": int(where.rsplit(":", 1)[1])}

    def connect(self):
        return Lines(**self.place)

    def end(self):
        self.process.terminate()
        expect(self.process.wait(20) == 0, "the server ends cleanly")


def without_times(answer):
    answer = {key: value for key, value in answer.items() if key not in ("ms", "seconds", "shared")}
    for layer in answer.get("layers", []):
        layer.pop("offset", None)
    return answer


def by_render(views):
    text = "".join(json.dumps(view) + "\n" for view in views)
    done = subprocess.run([PROGRAM, "render", "box.pxn", *OPTIONS, "--views", "-"], input=text, capture_output=True, text=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def segments(server):
    """Names of a server's shared memory."""
    return [name for name in os.listdir("/dev/shm") if name.startswith(f"panwright-{server.process.pid}-")]


def same_answers():
    """Files, images with answers and errors: as render answers, for two clients at once, over TCP and a Unix socket."""
    os.mkdir("out")
    views = [{**view, "output": f"out/{k}.npy"} if isinstance(view, dict) else view for k, view in enumerate(VIEWS)]
    views += [{**view, "image": "inline"} if isinstance(view, dict) else view for view in VIEWS]
    expected = [without_times(answer) for answer in by_render(views)]
    expect(len(expected) == len(views) and expected[0]["ok"] and not expected[2]["ok"] and expected[7]["layers"][1]["name"] == "depth", expected)
    files = {name: open(os.path.join("out", name), "rb").read() for name in os.listdir("out")}
    expect(len(files) == 3, files.keys())
    for words in (["--port", "0"], ["--socket", os.path.abspath("wire")]):
        for name in files:
            os.remove(os.path.join("out", name))
        server = Server("--folder", ".", *words)
        with server.connect() as one, server.connect() as two:
            for k, view in enumerate(views):
                expect(without_times(one.ask(view)) == expected[k], (view, expected[k]))
                expect(without_times(two.ask(view)) == expected[k], (view, expected[k]))
            two.socket.sendall(b"\n  \r\n" + json.dumps(VIEWS[0] | {"image": "inline"}).encode() + b"\r\n")  # blank lines are not counted
            expect(json.loads(two.input.readline())["index"] == len(views), "the number of a view")
        got = {name: open(os.path.join("out", name), "rb").read() for name in os.listdir("out")}
        expect(got == files, "files are those of render")
        server.end()
    expect(not os.path.exists("wire"), "the socket goes with its server")


def shared_images():
    """Layers by shared memory are those of the answer, in Python and C."""
    server = Server("--socket", os.path.abspath("wire"))
    with server.connect() as client:
        for k, view in enumerate((VIEWS[0], VIEWS[1], VIEWS[3])):
            inline = client.image(view, "inline")
            shared = client.image(view)
            expect(list(inline) == (["radiance", "depth", "node_id"] if k == 1 else ["radiance"]), list(inline))
            for name, layer in inline.items():
                expect(shared[name] == layer and shared[name].format == layer.format and shared[name].shape == layer.shape, name)
            expect(client.shared.newest() == (k + 1 if k == 0 else k), client.shared.newest())  # the second needs a larger segment
        number = client.shared.newest()
        old = client.shared.copy(number)
        expect(old["radiance"].tobytes() == shared["radiance"].tobytes(), "a copy")
        for _ in range(client.shared.slots):
            client.image(VIEWS[0])
        expect(not client.shared.is_whole(number), "a replaced image is known as one")
        try:
            client.shared.image(number)
            expect(False, "a replaced image is an error")
        except TornImage:
            pass
        try:
            client.image({"fov": 400})
            expect(False, "an error of the server")
        except ServerError as error:
            expect("fov is '400'" in str(error), error)
        expect(len(segments(server)) == 1 and os.stat("/dev/shm/" + segments(server)[0]).st_mode & 0o777 == 0o600, segments(server))
        with open("client.c", "w", encoding="utf-8") as file:
            file.write(C_CLIENT)
        subprocess.run([COMPILER, "-std=gnu89", "-pedantic-errors", "-Wall", "-Wextra", "-Werror", "-Wno-long-long", "-I",
                        os.path.join(SOURCE, "server", "clients"), "client.c", "-o", "client"], check=True)
        done = subprocess.run([os.path.abspath("client"), os.path.abspath("wire")], capture_output=True, text=True)
        total = 0
        for byte in client.image(VIEWS[0])["radiance"].tobytes():
            total = (31 * total + byte) % 1000000007
        expect(done.returncode == 0 and done.stdout.split() == ["24", "16", "3", str(total)] and "fov is '400'" in done.stderr, done)
    for _ in range(100):
        if not segments(server):
            break
        time.sleep(0.02)
    expect(not segments(server), "memory goes with its client")
    # a server that is killed: its client removes the name, or the next server does
    for client_too in (False, True):
        client = server.connect()
        client.image(VIEWS[0])
        expect(len(segments(server)) == 1, segments(server))
        server.process.send_signal(signal.SIGKILL)
        server.process.wait()
        if not client_too:
            try:
                client.image(VIEWS[0])
                expect(False, "a lost server")
            except (ConnectionError, OSError):
                pass
            if segments(server):  # where the write fails, the read is not tried
                client._remove_left_over()
        client.close()
        killed, server = server, Server("--socket", os.path.abspath("wire"))  # also takes the place of the socket left over
        expect(not segments(killed), "memory of killed servers is removed")
    server.end()


def closed_doors():
    """Files elsewhere are neither read nor written."""
    os.mkdir("root")
    os.symlink("/tmp", "root/link")
    os.symlink(os.path.abspath("victim.npy"), "root/file.npy")
    with open("root/own.npy", "w", encoding="ascii") as file:
        file.write("old")
    server = Server("--folder", "root", "--port", "0")
    with server.connect() as client:
        for output in ("../a.npy", "/tmp/a.npy", os.path.abspath("a.npy"), "link/a.npy", "file.npy", "x/../../a.npy", "a\0.npy"):
            answer = client.ask({"output": output})
            expect(not answer["ok"] and "outside of the folder" in answer["diagnostics"][0]["message"], (output, answer))
        for members in ({"targets": ["box.pxn", "other.pxn"]}, {"targets": ["/etc/passwd"]}, {"camera-file": "/etc/passwd"},
                        {"star-catalogue": "/etc/passwd", "stars": 5}, {"planet": {"earth": "0 0 -9000km map=/etc/passwd"}},
                        {"max-image-memory": "100GB"}):
            answer = client.ask({"image": "inline", **members})
            expect(not answer["ok"] and "passwd:" not in json.dumps(answer) and answer["diagnostics"][0]["code"] == "E0203", answer)
        expect(client.ask({"output": "own.npy"})["ok"] and os.path.getsize("root/own.npy") > 100, "an own file")
        expect(not client.ask({"output": "no/a.npy"})["ok"], "no folder is made")
        expect(client.ask({"image": "inline", "targets": ["box.pxn"]})["ok"], "the targets of the command line")
    server.end()
    expect(sorted(os.listdir("root")) == ["file.npy", "link", "own.npy"] and not os.path.exists("victim.npy"), os.listdir("root"))


class Honest(threading.Thread):
    def __init__(self, server):
        super().__init__(daemon=True)
        self.client, self.count, self.longest, self.wrong, self.stops = server.connect(), 0, 0.0, None, False

    def run(self):
        while not self.stops:
            begin = time.monotonic()
            answer = self.client.ask(VIEWS[0] | {"image": "inline"})
            if not answer["ok"]:
                self.wrong = answer
                return
            self.longest = max(self.longest, time.monotonic() - begin)
            self.count += 1


def memory(process):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS:"))


def hostile():
    """Nonsense, long and slow lines, many connections: refused, while an honest client is answered."""
    server = Server("--port", "0", "--clients", "8", "--request-seconds", "1")
    port = server.place["port"]
    honest = Honest(server)
    honest.start()
    numbers = random.Random(7)
    before = 0
    for k in range(300):
        if k == 100:
            before = memory(server.process)
        with socket.create_connection(("127.0.0.1", port), 20) as wire:
            what = k % 6
            if what == 0:
                wire.sendall(numbers.randbytes(numbers.randrange(1, 3000)).replace(b"\n", b"") + b"\n")
            elif what == 1:
                wire.sendall(b"[" * numbers.randrange(1, 200_000) + b"\n")
            elif what == 2:
                wire.sendall(b'{"image": "inline", "camera": [' + b"9" * numbers.randrange(400, 5000) + b', 0, 0]}\n')
            elif what == 3:
                wire.sendall(b'{"half": ')
                continue
            elif what == 4:
                wire.sendall(b'{"image": "inline"}\n' * 20)
                continue
            else:
                for byte in b'{"fov": 7000}\n':
                    wire.sendall(bytes([byte]))
            answer = wire.makefile("rb").readline()
            expect(answer == b"" or json.loads(answer)["ok"] is False, answer[:300])
    expect(memory(server.process) < before + 30_000, f"memory grew from {before} kB to {memory(server.process)} kB")
    # too long, and too slow
    with socket.create_connection(("127.0.0.1", port), 20) as wire:
        try:
            wire.sendall(b"x" * (3 << 20))
        except OSError:
            pass
        answer = json.loads(wire.makefile("rb").readline())
        expect("more than 1048576 bytes" in answer["diagnostics"][0]["message"], answer)
    half = socket.create_connection(("127.0.0.1", port), 20)
    half.sendall(b'{"half": ')
    slow = server.connect()
    begin = time.monotonic()
    answer = slow.ask({"image": "inline", "size": "1024x1024", "samples": 64, "camera": [0, -9, 3]})
    expect(not answer["ok"] and answer["diagnostics"][0]["code"] == "E0001" and time.monotonic() - begin < 15, answer)
    slow.close()
    answer = json.loads(half.makefile("rb").readline())
    expect("did not come in time" in answer["diagnostics"][0]["message"], answer)
    # too many, some of which leave again
    many = [socket.create_connection(("127.0.0.1", port), 20) for _ in range(60)]
    refused = 0
    for wire in many:
        wire.settimeout(20)
        try:
            wire.sendall(b'{"fov": 7000}\n')
            refused += b"as many clients" in wire.makefile("rb").readline()
        except OSError:
            refused += 1
    expect(refused >= 50, f"{refused} of 60 clients were refused")
    for wire in many:
        wire.close()
    time.sleep(1.2)
    metrics = json.load(urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics"))
    expect(metrics["requests"]["line"]["count"] > 100 and metrics["refused"] >= 50 and metrics["errors"] > 100, metrics)
    honest.stops = True
    honest.join(30)
    expect(honest.wrong is None and honest.count > 20, (honest.wrong, honest.count))
    print(f"{honest.count} honest answers, the longest after {honest.longest:.3f} s")
    server.end()


def usage():
    for words, message in ((["--json-lines", "--grey"], "--grey cannot be combined with --json-lines"),
                           (["--folder", "."], "--folder requires --json-lines"),
                           (["--socket", "a", "--address", "127.0.0.2"], "--address cannot be combined with --socket"),
                           (["--socket", "a", "--port", "0"], "--port cannot be combined with --socket"),
                           (["--replay", "a.jsonl", "--web", "0"], "--web cannot be combined with --replay"),
                           (["--json-lines", "--folder", "nowhere"], "folder not found"),
                           (["--json-lines", "--socket", "box.pxn"], "cannot listen on box.pxn"),
                           (["--json-lines", "--socket", "x" * 200], "at most 107 bytes")):
        done = subprocess.run([PROGRAM, "serve", "box.pxn", *words], capture_output=True, text=True, timeout=20)
        expect(done.returncode in (2, 3) and message in done.stderr, done)


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("box.pxn", "w", encoding="utf-8") as file:
            file.write(SCENE)
        for check in (usage, same_answers, shared_images, closed_doors, hostile):
            check()
        os.chdir("/")


PROGRAM, SOURCE = os.path.abspath(PROGRAM), os.path.abspath(SOURCE)
main()
