"""WebSockets by the standard library alone, written from RFC 6455, and headless Chromium by its DevTools."""

import atexit
import base64
import hashlib
import json
import os
import socket
import struct
import subprocess
import tempfile
import time
import urllib.request


def expect(condition, what):
    if not condition:
        raise SystemExit(f"web_sockets: {what}")


def opened(port, path="/live", origin=None, host=None, protocol="panwright"):
    """A socket after the handshake, and what the server answered."""
    connection = socket.create_connection(("127.0.0.1", port), 30)
    key = base64.b64encode(b"sixteen bytes ok").decode()
    lines = [f"GET {path} HTTP/1.1", f"Host: {host or f'127.0.0.1:{port}'}", "Upgrade: websocket", "Connection: Upgrade",
             f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13"]
    if protocol:
        lines.append(f"Sec-WebSocket-Protocol: {protocol}")
    if origin:
        lines.append(f"Origin: {origin}")
    connection.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
    head = b""
    while not head.endswith(b"\r\n\r\n"):
        byte = connection.recv(1)
        if not byte:
            return None, head.decode()
        head += byte
    head = head.decode()
    if " 101 " not in head:
        return None, head
    accept = base64.b64encode(hashlib.sha1((key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest()).decode()
    expect(accept in head, "the handshake has the right answer")
    return connection, head


def read_exactly(connection, count):
    data = b""
    while len(data) < count:
        piece = connection.recv(min(1 << 20, count - len(data)))
        expect(piece, "the connection stays open")
        data += piece
    return data


def frames(connection):
    """The next message, of one frame or several: its kind (1 text, 2 binary) and its bytes. None: the connection is closed."""
    data, kind = b"", 0
    while True:
        first, second = read_exactly(connection, 2)
        length = second & 127
        expect(second < 128, "a server does not mask")
        if length == 126:
            length, = struct.unpack(">H", read_exactly(connection, 2))
        elif length == 127:
            length, = struct.unpack(">Q", read_exactly(connection, 8))
        payload = read_exactly(connection, length)
        code = first & 15
        if code == 9:  # a ping, which lws sends to who is still
            continue
        if code == 8:
            return None
        expect((code != 0) == (kind == 0), "frames follow one another")
        kind = kind or code
        data += payload
        if first & 128:
            return kind, data


def message(connection):
    """The next image of a page: its JSON, and the bytes of its pixels."""
    kind, data = frames(connection)
    expect(kind == 2, "the message is binary")
    size, = struct.unpack_from("<I", data)
    return json.loads(data[4:4 + size]), data[4 + size:]


def send(connection, data, code=2, last=True):
    """One frame, masked as those of clients are."""
    mask = b"\x12\x34\x56\x78"
    size = len(data)
    head = bytes([code | (0x80 if last else 0)])
    head += bytes([0x80 | size]) if size < 126 else bytes([0x80 | 126]) + struct.pack(">H", size) if size < 65536 else bytes([0x80 | 127]) + struct.pack(">Q", size)
    connection.sendall(head + mask + bytes(byte ^ mask[k % 4] for k, byte in enumerate(data)))


class Chromium:
    """A page in headless Chromium, by its DevTools."""

    def __init__(self, program, url, width=1200, height=700):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.process = subprocess.Popen([program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--remote-debugging-port=0",
                                         f"--user-data-dir={self.folder.name}", f"--window-size={width},{height}", url],
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        atexit.register(self.process.kill)
        port_file = os.path.join(self.folder.name, "DevToolsActivePort")
        wait_for(lambda: os.path.exists(port_file) and os.path.getsize(port_file) > 0, "Chromium starts")
        with open(port_file, encoding="ascii") as file:
            port = int(file.readline())

        def pages():
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list", timeout=30) as answer:
                return [each for each in json.load(answer) if each["type"] == "page" and each["url"].startswith(url)]

        page = wait_for(pages, "Chromium opens the page")[0]
        path = page["webSocketDebuggerUrl"].split(str(port), 1)[1]
        self.connection, head = opened(port, path, protocol=None)
        expect(self.connection, f"DevTools answer: {head}")
        self.connection.settimeout(120)
        self.last = 0

    def call(self, method, **parameters):
        self.last += 1
        send(self.connection, json.dumps({"id": self.last, "method": method, "params": parameters}).encode(), 1)
        while True:
            answer = json.loads(frames(self.connection)[1])
            if answer.get("id") == self.last:
                expect("error" not in answer, answer)
                return answer["result"]

    def evaluate(self, expression):
        """The value of an expression of JavaScript."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        expect("exceptionDetails" not in result, result)
        return result["result"].get("value")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def close(self):
        self.connection.close()
        self.process.terminate()
        self.process.wait(60)
        atexit.unregister(self.process.kill)


def wait_for(ready, what, seconds=120):
    """What ready() answers, once it is true."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        answer = ready()
        if answer:
            return answer
        time.sleep(0.05)
    return expect(False, f"in time: {what}")
