"""Runs as MCAP files, read back by a reader of its own, written from the specification of MCAP and the definitions in the file.

    mcap_test.py PANWRIGHT FOLDER_OF_EXAMPLES
"""
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

import numpy as np
from panwright import mcap

PROGRAM, EXAMPLES = sys.argv[1], pathlib.Path(sys.argv[2])
NUMBERS = {"bool": "?", "uint8": "B", "int32": "i", "uint32": "I", "float64": "d"}


def expect(condition, what):
    if not condition:
        raise SystemExit(f"mcap_test: {what}")


class Bytes:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, layout):
        values = struct.unpack_from("<" + layout, self.data, self.at)
        self.at += struct.calcsize("<" + layout)
        return values

    def one(self, layout):
        return self.take(layout)[0]

    def bytes(self, count):
        expect(self.at + count <= len(self.data), "a field ends within its record")
        self.at += count
        return self.data[self.at - count:self.at]

    def text(self):
        return bytes(self.bytes(self.one("I"))).decode()

    def pairs(self, key, value):
        end = self.one("I") + self.at
        out = {}
        while self.at < end:
            name = self.text() if key == "text" else self.one(key)
            out[name] = self.text() if value == "text" else self.one(value)
        expect(self.at == end, "a map ends at its length")
        return out


def records(data):
    at = 0
    while at < len(data):
        op, length = struct.unpack_from("<BQ", data, at)
        expect(at + 9 + length <= len(data), "a record ends within the file")
        yield at, op, Bytes(data[at + 9:at + 9 + length]), 9 + length
        at += 9 + length


def definitions(text, name):
    """Fields of a message and of those that it is made of."""
    out = {}
    for block in text.split("\n" + "=" * 80 + "\n"):
        if out:
            head, block = block.split("\n", 1)
            expect(head.startswith("MSG: "), head)
            name = head[5:]
        fields = [line.split()[:2] for line in block.splitlines() if line and "=" not in line]
        out[name.replace("/msg/", "/")] = fields
    return out


def decoded(data, known, kind):
    """CDR by the definitions alone."""
    expect(bytes(data[:4]) == b"\x00\x01\x00\x00", "CDR, little-endian")
    body = Bytes(data[4:])

    def number(layout):
        body.at += -body.at % struct.calcsize(layout)
        return body.one(layout)

    def value(of):
        if of in NUMBERS:
            return number(NUMBERS[of])
        if of == "string":
            text = bytes(body.bytes(number("I")))
            expect(text.endswith(b"\0"), "strings end with 0")
            return text[:-1].decode()
        return {field: member(each) for each, field in known[of]}

    def member(of):
        if not of.endswith("]"):
            return value(of)
        of, count = of[:-1].split("[")
        count = int(count) if count else number("I")
        return bytes(body.bytes(count)) if of == "uint8" else [value(of) for _ in range(count)]

    out = value(kind)
    expect(body.at == len(body.data), f"{kind}: {len(body.data) - body.at} bytes are left")
    return out


def read(path):
    """Messages by topic: (stamp, what), after all of the file has been looked at."""
    data = path.read_bytes()
    magic = b"\x89MCAP0\r\n"
    expect(data.startswith(magic) and data.endswith(magic), "magic at both ends")
    body = data[8:-8]
    all_records = list(records(body))
    expect([all_records[0][1], all_records[-1][1]] == [1, 2], "a header first, a footer last")
    expect(all_records[0][2].text() == "ros2" and all_records[0][2].text().startswith("panwright"), "profile and library")
    summary, offsets, crc = all_records[-1][2].take("QQI")
    expect(zlib.crc32(data[summary:-12]) == crc, "checksum of the summary")
    schemas, channels, messages, chunks, counts, places = {}, {}, {}, {}, {}, {}

    def declare(op, content):
        if op == 3:
            number, name = content.one("H"), content.text()
            expect(content.text() == "ros2msg", "encoding of definitions")
            found = name, content.text()
            expect(schemas.setdefault(number, found) == found, "equal copies of a schema")
        else:
            number, schema = content.take("HH")
            found = schema, content.text(), content.text(), tuple(content.pairs("text", "text").items())
            expect(schema in schemas and found[2] == "cdr" and found[3] == (("offered_qos_profiles", ""),), f"channel {found}")
            expect(channels.setdefault(number, found) == found, "equal copies of a channel")

    for at, op, content, _ in all_records:
        if op != 6:
            continue
        begin, end, size, checksum = content.take("QQQI")
        expect(content.text() == "", "no compression")
        inside = content.bytes(content.one("Q"))
        expect(len(inside) == size and zlib.crc32(inside) == checksum, "size and checksum of a chunk")
        chunks[at + 8] = begin, end, {}
        for place, kind, each, _ in records(inside):
            if kind != 5:
                declare(kind, each)
                continue
            channel, sequence, logged, published = each.take("HIQQ")
            schema, topic = channels[channel][:2]
            expect(sequence == counts.get(channel, 0) and begin <= logged == published <= end, "number and time of a message")
            counts[channel] = sequence + 1
            chunks[at + 8][2].setdefault(channel, []).append((logged, place))
            name, text = schemas[schema]
            kind = name.replace("/msg/", "/")
            messages.setdefault(topic, []).append((logged, decoded(each.data[each.at:], definitions(text, name), kind)))
    last = None
    for at, op, content, length in all_records:
        if op == 7:
            channel = content.one("H")
            entries = content.one("I") // 16
            found = [content.take("QQ") for _ in range(entries)]
            expect(found == chunks[last][2][channel], "index of a chunk's messages")
            places[channel, last] = at + 8
        last = at + 8 if op == 6 else last
        if op == 8:
            begin, end, start, size = content.take("QQQQ")
            expect(chunks[start][:2] == (begin, end) and data[start] == 6 and struct.unpack_from("<Q", data, start + 1)[0] + 9 == size, "place of a chunk")
            indexes = content.pairs("H", "Q")
            expect(all(places[channel, start] == place for channel, place in indexes.items()), "places of indexes")
        if op in (3, 4):
            declare(op, content)
        if op == 11:
            total, of_schemas, of_channels, attachments, metadata, of_chunks, first, final = content.take("QHIIIIQQ")
            expect((total, of_schemas, of_channels, attachments, metadata, of_chunks) ==
                   (sum(counts.values()), len(schemas), len(channels), 0, 0, len(chunks)), "statistics")
            expect((first, final) == (min(each[0] for each in chunks.values()), max(each[1] for each in chunks.values())), "times")
            expect(content.pairs("H", "Q") == counts, "counts of channels")
        if op == 14:
            group, start, size = content.take("BQQ")
            expect(at + 8 >= offsets and {kind for _, kind, _, _ in records(data[start:start + size])} == {group}, "groups of the summary")
    return messages, {channels[number][1]: schemas[channels[number][0]][0] for number in channels}


def check_vector():
    """Of a file that another library reads (@mcap/core with @foxglove/rosmsg2-serialization)."""
    data = mcap.image(1_000_000_500, "cam", "32FC1", np.zeros((3, 4), np.float32))
    expect(data[:48].hex() == "0001000001000000f40100000400000063616d0003000000040000000600000033324643310000001000000030000000", "bytes of an image")
    expect(len(data) == 96, "length of an image")


def check_cameras():
    known = definitions(mcap.definition("sensor_msgs/CameraInfo"), "sensor_msgs/CameraInfo")
    info = lambda *words: decoded(mcap.camera_info(0, "c", (64, 48), (100, 110, 32, 24), words), known, "sensor_msgs/CameraInfo")
    plain = info()
    expect((plain["width"], plain["height"], plain["distortion_model"], plain["d"]) == (64, 48, "plumb_bob", [0.0] * 5), "no distortion")
    # the middle of the image is between its middle pixels, whose centres are whole numbers in ROS
    expect(plain["k"] == [100, 0, 31.5, 0, 110, 23.5, 0, 0, 1], "matrix of the camera")
    expect(plain["p"] == [100, 0, 31.5, 0, 0, 110, 23.5, 0, 0, 0, 1, 0] and plain["r"] == [1, 0, 0, 0, 1, 0, 0, 0, 1], "projection")
    four = info("brown", "-0.2", "0.1", "0", "0.5")
    expect((four["distortion_model"], four["d"]) == ("plumb_bob", [-0.2, 0.1, 0, 0.5, 0]), "Brown's model")
    eight = info("brown", *"12345678")
    expect((eight["distortion_model"], eight["d"]) == ("rational_polynomial", [float(k) for k in range(1, 9)]), "a rational one")
    expect(info("fisheye", *"1234")["distortion_model"] == "equidistant", "a fisheye")


def check_run(folder):
    run = folder / "run"
    scenario = EXAMPLES / "rendezvous/instruments.toml"
    done = subprocess.run([PROGRAM, "run", scenario, "-o", run, "--frames", "0..2", "--type", "png", "--type", "npz", "--engine", "reference",
                           "--samples", "1", "--size", "64x48"], capture_output=True, text=True)
    expect(done.returncode == 0, done.stderr)
    done = subprocess.run([sys.executable, "-m", "panwright.mcap", run, "-o", folder / "run.mcap"], capture_output=True, text=True)
    expect(done.returncode == 0 and done.stdout.endswith(": 3 frames\n"), done.stdout + done.stderr)
    messages, kinds = read(folder / "run.mcap")
    print(kinds)
    expect(kinds == {"/camera/image_raw/compressed": "sensor_msgs/msg/CompressedImage", "/camera/camera_info": "sensor_msgs/msg/CameraInfo",
                     "/camera/depth": "sensor_msgs/msg/Image", "/lidar/points": "sensor_msgs/msg/PointCloud2",
                     "/tf": "tf2_msgs/msg/TFMessage"}, "topics")
    lines = [json.loads(line) for line in (run / "frames.jsonl").read_text().splitlines()]
    for topic, all_of in messages.items():
        expect([stamp for stamp, _ in all_of] == [0, 10 * 10**9, 20 * 10**9], f"times of {topic}")
        for stamp, each in all_of:
            header = each["transforms"][0]["header"] if topic == "/tf" else each["header"]
            expect(header["stamp"] == {"sec": stamp // 10**9, "nanosec": 0}, "stamps")
    for k, line in enumerate(lines):
        png = messages["/camera/image_raw/compressed"][k][1]
        expect(png["data"] == (run / f"00000{k}.png").read_bytes() and png["format"] == "png", "images are the files")
        with np.load(run / f"00000{k}.npz") as arrays:
            depth = messages["/camera/depth"][k][1]
            expect((depth["height"], depth["width"], depth["step"], depth["encoding"]) == (48, 64, 256, "32FC1"), "depth")
            np.testing.assert_array_equal(np.frombuffer(depth["data"], "<f4").reshape(48, 64), arrays["depth"])
        cloud = messages["/lidar/points"][k][1]
        fields = {each["name"]: each for each in cloud["fields"]}
        sizes = {2: ("u1", 1), 6: ("<u4", 4), 7: ("<f4", 4), 8: ("<f8", 8)}
        kind = np.dtype({"names": list(fields), "formats": [sizes[each["datatype"]][0] for each in fields.values()],
                         "offsets": [each["offset"] for each in fields.values()], "itemsize": cloud["point_step"]})
        points = np.frombuffer(cloud["data"], kind)
        with np.load(run / f"00000{k}.lidar.npz") as arrays:
            expect(cloud["width"] == len(points) == len(arrays["range"]) > 10 and cloud["row_step"] == len(cloud["data"]), "points")
            expect(cloud["header"]["frame_id"] == "client" and cloud["is_dense"], "frame of points")
            np.testing.assert_array_equal(np.stack([points[axis] for axis in "xyz"], 1), arrays["position"].astype("<f4"))
            for name in ("range", "time", "target_id", "node_id", "material_id", "echo", "flags"):
                np.testing.assert_array_equal(points[name], arrays[name], name)
        placed = {each["child_frame_id"]: (each["header"]["frame_id"], each["transform"]) for each in messages["/tf"][k][1]["transforms"]}
        expect(set(placed) == {"camera", "client", "lidar", "radar"}, f"frames {set(placed)}")
        for child, (parent, pose) in {"camera": ("world", line["camera"] + line["quat"]), "client": ("world", line["poses"]["client"]),
                                      "lidar": ("camera", [0.2, 0, 0, 1, 0, 0, 0]), "radar": ("camera", [-0.2, 0, 0, 1, 0, 0, 0])}.items():
            found = placed[child][1]
            expect(placed[child][0] == parent, f"parent of {child}")
            expect([found["translation"][a] for a in "xyz"] + [found["rotation"][a] for a in "wxyz"] == pose, f"pose of {child}")
    expect(messages["/camera/camera_info"][0][1]["k"][2::3][:2] == [31.5, 23.5], "centre of the camera")
    before = (folder / "run.mcap").read_bytes()
    mcap.convert(run, folder / "run.mcap")
    expect((folder / "run.mcap").read_bytes() == before, "the same bytes again")


def check_mistakes(folder):
    for name, files in {"empty": {}, "no JSON": {"frames.jsonl": "x", "run.json": "{}"}, "cut": {"frames.jsonl": '{"number": 0}\n', "run.json": "{}"}}.items():
        path = folder / name
        path.mkdir()
        for file, text in files.items():
            (path / file).write_text(text)
        done = subprocess.run([sys.executable, "-m", "panwright.mcap", path, "-o", folder / "none.mcap"], capture_output=True, text=True)
        expect(done.returncode == 1 and done.stderr.startswith("panwright.mcap: ") and "Traceback" not in done.stderr, f"{name}: {done.stderr}")
        expect(not [each for each in os.listdir(folder) if each.startswith("none.mcap")], "nothing is left")


with tempfile.TemporaryDirectory() as work:
    check_vector()
    check_cameras()
    check_run(pathlib.Path(work))
    check_mistakes(pathlib.Path(work))
