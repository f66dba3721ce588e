"""Folders of `panwright run` as MCAP files, the bags of ROS 2: images, camera, depth, point clouds and tf.

    python3 -m panwright.mcap FOLDER -o run.mcap      # ros2 bag info run.mcap

Container: https://mcap.dev/spec, in chunks with an index, uncompressed. Messages: CDR of OMG DDSI-RTPS 2.3, 10.
"""

from __future__ import annotations

import argparse
import json
import pathlib
import struct
import sys
import zlib
from collections.abc import Iterator, Sequence
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

MAGIC = b"\x89MCAP0\r\n"

# Definitions of ROS 2 (common_interfaces, rcl_interfaces), without comments.
TYPES = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "sensor_msgs/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data",
    "sensor_msgs/Image": "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data",
    "sensor_msgs/RegionOfInterest": "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify",
    "sensor_msgs/CameraInfo": "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\n"
                              "float64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi",
    "sensor_msgs/PointField": "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\n"
                              "uint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count",
    "sensor_msgs/PointCloud2": "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n"
                               "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
    "geometry_msgs/TransformStamped": "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform",
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
}


def definition(name: str) -> str:
    """The definition of a message with those that it is made of, as "ros2msg" has them."""
    text = TYPES[name]
    needed: list[str] = []

    def add(of: str) -> None:
        for line in TYPES[of].splitlines():
            kind = line.split()[0].split("[")[0]
            if kind in TYPES and kind not in needed:
                needed.append(kind)
                add(kind)

    add(name)
    return text + "".join(f"\n{'=' * 80}\nMSG: {each}\n{TYPES[each]}" for each in needed) + "\n"


class Cdr:
    """Bytes of a message, little-endian; numbers at multiples of their size from behind the first four bytes."""

    def __init__(self) -> None:
        self.bytes = bytearray(b"\x00\x01\x00\x00")

    def add(self, kind: str, *values: float) -> Cdr:
        size = struct.calcsize(kind)
        self.bytes += bytes(-(len(self.bytes) - 4) % size)
        self.bytes += struct.pack(f"<{len(values)}{kind}", *values)
        return self

    def text(self, value: str) -> Cdr:
        data = value.encode() + b"\0"
        self.add("I", len(data)).bytes.extend(data)
        return self

    def octets(self, value: bytes) -> Cdr:
        self.add("I", len(value)).bytes.extend(value)
        return self

    def header(self, stamp: int, frame: str) -> Cdr:
        return self.add("i", stamp // 10**9).add("I", stamp % 10**9).text(frame)


def compressed_image(stamp: int, frame: str, data: bytes) -> bytes:
    return bytes(Cdr().header(stamp, frame).text("png").octets(data).bytes)


def image(stamp: int, frame: str, encoding: str, pixels: NDArray[Any]) -> bytes:
    """pixels: (H, W) or (H, W, channels), of the encoding's type."""
    pixels = np.ascontiguousarray(pixels, pixels.dtype.newbyteorder("<"))
    out = Cdr().header(stamp, frame).add("I", *pixels.shape[:2]).text(encoding).add("B", 0).add("I", pixels.nbytes // pixels.shape[0])
    return bytes(out.octets(pixels.tobytes()).bytes)


def camera_info(stamp: int, frame: str, size: Sequence[int], intrinsics: Sequence[float], distortion: Sequence[str]) -> bytes:
    """size: width, height. intrinsics: fx fy cx cy, (0, 0) the corner of the image. distortion: model and numbers, as `--distortion`."""
    fx, fy, cx, cy = intrinsics
    # ROS counts from the middle of the first pixel
    cx, cy = cx - 0.5, cy - 0.5
    numbers = [float(each) for each in distortion[1:]]
    model = "plumb_bob"
    if distortion and distortion[0] == "brown":
        numbers += [0.0] * ((5 if len(numbers) <= 5 else 8) - len(numbers))
        model = "plumb_bob" if len(numbers) == 5 else "rational_polynomial"
    elif distortion:
        model = "equidistant" if distortion[0] == "fisheye" else distortion[0]
    else:
        numbers = [0.0] * 5
    out = Cdr().header(stamp, frame).add("I", size[1], size[0]).text(model).add("I", len(numbers)).add("d", *numbers)
    out.add("d", fx, 0, cx, 0, fy, cy, 0, 0, 1).add("d", 1, 0, 0, 0, 1, 0, 0, 0, 1).add("d", fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0)
    return bytes(out.add("I", 0, 0, 0, 0, 0, 0).add("B", 0).bytes)


def point_cloud(stamp: int, frame: str, cloud: NDArray[Any]) -> bytes:
    """cloud: a structured array, of float32, float64, uint8 and uint32."""
    kinds = {"|u1": 2, "<u4": 6, "<f4": 7, "<f8": 8}
    fields: dict[str, Any] = dict(cloud.dtype.fields or {})
    out = Cdr().header(stamp, frame).add("I", 1, len(cloud)).add("I", len(fields))
    for name, (kind, offset, *_) in fields.items():
        out.text(name).add("I", offset).add("B", kinds[kind.str]).add("I", 1)
    out.add("B", 0).add("I", cloud.itemsize, cloud.nbytes).octets(cloud.tobytes())
    return bytes(out.add("B", 1).bytes)


def transforms(stamp: int, all: Sequence[tuple[str, str, Sequence[float], Sequence[float]]]) -> bytes:
    """all: frame, child, translation, quaternion w x y z: frame_from_child."""
    out = Cdr().add("I", len(all))
    for frame, child, (x, y, z), (qw, qx, qy, qz) in all:
        out.header(stamp, frame).text(child).add("d", x, y, z, qx, qy, qz, qw)
    return bytes(out.bytes)


def _text(value: str) -> bytes:
    data = value.encode()
    return struct.pack("<I", len(data)) + data


def _record(op: int, content: bytes) -> bytes:
    return struct.pack("<BQ", op, len(content)) + content


class Writer:
    """An MCAP file of ROS 2 messages. A chunk is what is added between two calls of end_chunk()."""

    def __init__(self, file: BinaryIO, library: str):
        self.file = file
        self.at = 0
        self.schemas: dict[str, bytes] = {}
        self.channels: dict[str, tuple[int, bytes]] = {}
        self.counts: dict[int, int] = {}
        self.chunks: list[bytes] = []
        self.span = [2**64 - 1, 0]
        self._begin()
        self._write(MAGIC + _record(1, _text("ros2") + _text(library)))

    def _write(self, data: bytes) -> None:
        self.file.write(data)
        self.at += len(data)

    def _begin(self) -> None:
        self.chunk = bytearray()
        self.index: dict[int, list[tuple[int, int]]] = {}

    def _channel(self, topic: str, kind: str) -> int:
        if topic in self.channels:
            return self.channels[topic][0]
        if kind not in self.schemas:
            package, name = kind.split("/")
            data = definition(kind).encode()
            self.schemas[kind] = _record(3, struct.pack("<H", len(self.schemas) + 1) + _text(f"{package}/msg/{name}") + _text("ros2msg") +
                                         struct.pack("<I", len(data)) + data)
            self.chunk += self.schemas[kind]
        number = len(self.channels) + 1
        profiles = _text("offered_qos_profiles") + _text("")
        record = _record(4, struct.pack("<HH", number, list(self.schemas).index(kind) + 1) + _text(topic) + _text("cdr") +
                         struct.pack("<I", len(profiles)) + profiles)
        self.channels[topic] = number, record
        self.chunk += record
        return number

    def add(self, topic: str, kind: str, stamp: int, data: bytes) -> None:
        """stamp: nanoseconds."""
        channel = self._channel(topic, kind)
        count = self.counts.get(channel, 0)
        self.counts[channel] = count + 1
        self.index.setdefault(channel, []).append((stamp, len(self.chunk)))
        self.chunk += _record(5, struct.pack("<HIQQ", channel, count, stamp, stamp) + data)

    def end_chunk(self) -> None:
        if not self.index:
            return
        stamps = [stamp for entries in self.index.values() for stamp, _ in entries]
        span = struct.pack("<QQ", min(stamps), max(stamps))
        self.span = [min(self.span[0], *stamps), max(self.span[1], *stamps)]
        start, size = self.at, len(self.chunk)
        self._write(_record(6, span + struct.pack("<QI", size, zlib.crc32(self.chunk)) + _text("") + struct.pack("<Q", size) + self.chunk))
        length, offsets = self.at - start, b""
        indexes = self.at
        for channel, entries in self.index.items():
            offsets += struct.pack("<HQ", channel, self.at)
            data = b"".join(struct.pack("<QQ", *entry) for entry in entries)
            self._write(_record(7, struct.pack("<HI", channel, len(data)) + data))
        self.chunks.append(_record(8, span + struct.pack("<QQI", start, length, len(offsets)) + offsets +
                                   struct.pack("<Q", self.at - indexes) + _text("") + struct.pack("<QQ", size, size)))
        self._begin()

    def end(self) -> None:
        self.end_chunk()
        self._write(_record(15, struct.pack("<I", 0)))
        counts = b"".join(struct.pack("<HQ", *each) for each in self.counts.items())
        span = self.span if self.counts else [0, 0]
        statistics = _record(11, struct.pack("<QHIIIIQQI", sum(self.counts.values()), len(self.schemas), len(self.channels), 0, 0,
                                             len(self.chunks), *span, len(counts)) + counts)
        groups = {3: b"".join(self.schemas.values()), 4: b"".join(record for _, record in self.channels.values()), 11: statistics,
                  8: b"".join(self.chunks)}
        start, summary, offsets = self.at, b"", b""
        for op, group in groups.items():
            if group:
                offsets += _record(14, struct.pack("<BQQ", op, start + len(summary), len(group)))
            summary += group
        footer = struct.pack("<BQQQ", 2, 20, start, start + len(summary))
        self._write(summary + offsets + footer + struct.pack("<I", zlib.crc32(summary + offsets + footer)) + MAGIC)


# ---- a folder of `panwright run`


def _png_record(data: bytes) -> dict[str, Any]:
    """The record that the program writes into its images."""
    at = 8
    while at + 8 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        name, _, text = data[at + 8:at + 8 + length].partition(b"\0")
        if kind == b"tEXt" and name == b"panwright.record":
            record: dict[str, Any] = json.loads(text)
            return record
        at += 12 + length
    raise ValueError("a PNG has no record of panwright")


def _add_image(writer: Writer, stamp: int, path: pathlib.Path) -> None:
    data = path.read_bytes()
    writer.add("/camera/image_raw/compressed", "sensor_msgs/CompressedImage", stamp, compressed_image(stamp, "camera", data))
    view = _png_record(data)["view"]
    if "intrinsics" not in view:
        return  # orthographic: no message of ROS has it
    size = struct.unpack_from(">II", data, 16)
    distortion = str(view.get("distortion", "")).split()
    writer.add("/camera/camera_info", "sensor_msgs/CameraInfo", stamp, camera_info(stamp, "camera", size, view["intrinsics"], distortion))


def _add_depth(writer: Writer, stamp: int, path: pathlib.Path) -> None:
    with np.load(path) as arrays:
        if "depth" in arrays.files:
            writer.add("/camera/depth", "sensor_msgs/Image", stamp, image(stamp, "camera", "32FC1", arrays["depth"].astype("<f4")))


def _add_cloud(writer: Writer, stamp: int, path: pathlib.Path, name: str, frame: str) -> None:
    kinds = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<f4"), ("range", "<f8"), ("time", "<f8"), ("target_id", "<u4"),
             ("node_id", "<u4"), ("material_id", "<u4"), ("echo", "|u1"), ("flags", "|u1")]
    with np.load(path) as arrays:
        cloud = np.zeros(len(arrays["range"]), np.dtype(kinds))
        for axis, column in zip("xyz", arrays["position"].T):
            cloud[axis] = column
        for field, _ in kinds[3:]:
            cloud[field] = arrays[field]
    writer.add(f"/{name}/points", "sensor_msgs/PointCloud2", stamp, point_cloud(stamp, frame, cloud))


def _placements(line: dict[str, Any], instruments: Sequence[dict[str, Any]]) -> Iterator[tuple[str, str, Sequence[float], Sequence[float]]]:
    yield "world", "camera", line["camera"], line["quat"]
    for name, pose in line.get("poses", {}).items():
        yield "world", name, pose[:3], pose[3:]
    for each in instruments:
        yield "camera", each["name"], each["position"], each["quat"]


def convert(folder: str | pathlib.Path, file: str | pathlib.Path) -> int:
    """Writes a run's frames as an MCAP file and returns their number.

    Topics: /camera/image_raw/compressed (PNG), /camera/camera_info, /camera/depth (of .npz images; metres along the boresight, inf:
    none), /NAME/points (of the .npz files of LiDARs), /tf. Frames: world, camera (x right, y down, z forward), targets and instruments by
    name. Stamps are the scenario's seconds, from 0 where they begin before. Raises OSError; ValueError for what is no run.
    """
    folder = pathlib.Path(folder)
    lines = [json.loads(line) for line in (folder / "frames.jsonl").read_text(encoding="utf-8").splitlines()]
    settings = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    instruments = settings.get("instruments", [])
    start = min(0.0, *(line.get("time", 0.0) for line in lines)) if lines else 0.0
    part = pathlib.Path(f"{file}.part")
    try:
        with part.open("wb") as out:
            writer = Writer(out, settings["program"])
            for line in lines:
                if "camera" not in line or "quat" not in line:
                    raise ValueError(f"frame {line['number']} has no pose of the camera")
                stamp = round((line.get("time", 0.0) - start) * 1e9)
                for name in line["outputs"]:
                    if name.endswith(".png"):
                        _add_image(writer, stamp, folder / name)
                    elif name.endswith(".npz"):
                        _add_depth(writer, stamp, folder / name)
                stem = pathlib.Path(line["outputs"][0]).stem
                for each in instruments:
                    if "lidar" in each and "npz" in each["types"]:
                        frame = each["name"] if each["frame"] == "instrument" else each["frame"]
                        _add_cloud(writer, stamp, folder / f"{stem}.{each['name']}.npz", each["name"], frame)
                writer.add("/tf", "tf2_msgs/TFMessage", stamp, transforms(stamp, list(_placements(line, instruments))))
                writer.end_chunk()
            writer.end()
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)
    return len(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description="Writes a folder of `panwright run` as an MCAP file, a bag of ROS 2.")
    parser.add_argument("folder", help="folder of the run: frames.jsonl, run.json and what they name")
    parser.add_argument("-o", "--output", required=True, metavar="FILE.mcap")
    options = parser.parse_args()
    try:
        count = convert(options.folder, options.output)
    except (OSError, ValueError, KeyError) as problem:
        print(f"panwright.mcap: {problem}", file=sys.stderr)
        return 1
    print(f"{options.output}: {count} frames")
    return 0


if __name__ == "__main__":
    sys.exit(main())
