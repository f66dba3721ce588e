"""Judges converted labels by our own files, with readers and scores written from the formats' public descriptions alone.

formats_peer.py FORMAT FOLDER OUTPUT
"""

import json
import pathlib
import struct
import sys

try:
    import cv2
    import numpy as np
except ImportError as missing:
    print(missing)
    sys.exit(77)

FORMAT, FOLDER, OUT = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])


def load():
    frames = []
    for file in sorted(FOLDER.glob("*.labels.json")):
        frame = json.loads(file.read_text())
        size = frame["camera"]["height"], frame["camera"]["width"]
        masks = np.load(FOLDER / frame["masks"])
        for thing in frame["things"]:
            for kind in ("amodal", "visible"):
                place, whole = thing[kind], np.zeros(size, np.uint8)
                if place["width"]:
                    crop = masks[f"{thing['id']}.{kind}"]
                    whole[place["top"]:place["top"] + place["height"], place["left"]:place["left"] + place["width"]] = crop
                thing[kind] = whole / 255 > .5
        frames.append(frame)
    return frames


def matrix(q):
    """Rotation matrix of a Hamilton quaternion w x y z."""
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def same_bytes(made, number):
    assert made.read_bytes() == (FOLDER / f"{number:06}.png").read_bytes(), made


def rle_mask(text, height, width):
    """COCO's compressed runs, decoded."""
    counts, at = [], 0
    while at < len(text):
        value, shift, more = 0, 0, True
        while more:
            group = ord(text[at]) - 48
            value |= (group & 0x1f) << shift
            more = bool(group & 0x20)
            at, shift = at + 1, shift + 5
            if not more and group & 0x10:
                value |= -1 << shift
        counts.append(value + (counts[-2] if len(counts) > 2 else 0))
    flat = np.repeat(np.arange(len(counts)) % 2 == 1, counts)
    assert len(flat) == height * width
    return flat.reshape(width, height).T


def average_precision(scores):
    """Of detections that each match their own truth with this similarity, at 0.5, 0.55 ... 0.95."""
    return np.mean([np.mean(np.array(scores) >= limit) for limit in np.arange(.5, .951, .05)])


def coco(frames):
    data = json.loads((OUT / "annotations.json").read_text())
    names = {each["id"]: each for each in data["categories"]}
    assert {key: each["name"] for key, each in names.items()} == {1: "client", 2: "client/wing", 3: "servicer"}
    assert names[1]["keypoints"] == ["tip", "dock", "behind"] and len(names[1]["kpt_oks_sigmas"]) == 3
    assert [each["file_name"] for each in data["images"]] == [frame["image"] for frame in frames]
    by = {(each["image_id"], each["category_id"]): each for each in data["annotations"]}
    assert len(by) == len(data["annotations"]) == len({each["id"] for each in data["annotations"]})
    similar, points = [], []
    for frame in frames:
        for thing in frame["things"]:
            truth = thing["visible"]
            if not truth.any():
                assert (frame["number"], thing["id"]) not in by
                continue
            found = by.pop((frame["number"], thing["id"]))
            mask = rle_mask(found["segmentation"]["counts"], *found["segmentation"]["size"])
            similar.append((mask & truth).sum() / (mask | truth).sum())
            row, column = np.nonzero(truth)
            assert found["bbox"] == [column.min(), row.min(), column.max() - column.min() + 1, row.max() - row.min() + 1]
            assert found["area"] == truth.sum() and found["iscrowd"] == 0
            keypoints = np.array(found["keypoints"]).reshape(-1, 3)
            assert found["num_keypoints"] == (keypoints[:, 2] > 0).sum()
            errors = []
            for point, (x, y, v) in zip(thing["keypoints"], keypoints):
                if point["truncated"]:
                    assert (x, y, v) == (0, 0, 0)
                    continue
                assert v == (1 if point["occluded"] else 2)
                errors.append(np.hypot(x + .5 - point["pixel"][0], y + .5 - point["pixel"][1]))
            if errors:
                k = 2 * np.array(names[thing["id"]]["kpt_oks_sigmas"][:len(errors)])
                points.append(np.mean(np.exp(-np.array(errors) ** 2 / (2 * found["area"] * k ** 2))))
    assert not by and len(similar) >= 7 and len(points) >= 5
    assert average_precision(similar) == 1 and min(similar) == 1
    assert average_precision(points) == 1 and min(points) > 1 - 1e-12


def speed(frames, name="q_vbs2tango"):
    """The score of the contest: |dt| / |t| + 2 acos |q.q'|; then keypoints through camera.json."""
    lines = json.loads((OUT / "train.json").read_text())
    camera = json.loads((OUT / "camera.json").read_text())
    assert len(lines) == len(frames)
    k = np.array(camera["cameraMatrix"]).reshape(3, 3)
    for line, frame in zip(lines, frames):
        same_bytes(OUT / "images" / line["filename"], frame["number"])
        pose = frame["things"][0]["camera_from_thing"]
        q, t = np.array(line[name]), np.array(line["r_Vo2To_vbs_true"])
        assert set(line) == {"filename", name, "r_Vo2To_vbs_true"}
        error = np.linalg.norm(t - pose["translation"]) / np.linalg.norm(t)
        error += 2 * np.arccos(min(1, abs(q @ pose["rotation"]))) if abs(q @ pose["rotation"]) < 1 - 1e-15 else 0
        assert error == 0, error
        seen = 0
        for point in frame["things"][0]["keypoints"]:
            at = matrix(q) @ point["position"] + t
            if at[2] <= 0:
                continue
            pixel = k @ (at / at[2])
            assert np.hypot(pixel[0] + .5 - point["pixel"][0], pixel[1] + .5 - point["pixel"][1]) < 1e-9
            seen += 1
        assert seen == 2
    assert (camera["Nu"], camera["Nv"]) == (64, 48)
    # the starter kit's class Camera asks for these, in metres
    assert np.allclose([camera["fx"] / camera["ppx"], camera["fy"] / camera["ppy"]], [k[0, 0], k[1, 1]], rtol=1e-15, atol=0)


def rows_of(name):
    lines = (OUT / name).read_text().splitlines()
    return lines[0].split(","), [line.split(",") for line in lines[1:]]


def spark(frames):
    header, rows = rows_of("train.csv")
    assert header == "sequence,filename,Tx,Ty,Tz,Qw,Qx,Qy,Qz".split(",") and len(rows) == len(frames)
    for row, frame in zip(rows, frames):
        pose = frame["things"][0]["camera_from_thing"]
        assert [float(each) for each in row[2:]] == pose["translation"] + pose["rotation"]
        same_bytes(OUT / "images" / row[1], frame["number"])


def urso(frames):
    """As UrsoNet draws axes: JPL quaternion, axes right, up, depth, the target's y mirrored."""
    header, rows = rows_of("train_poses_gt.csv")
    names = (OUT / "train_images.csv").read_text().split()
    assert header == "x,y,z,q1,q2,q3,q4".split(",") and len(rows) == len(frames) == len(names)
    for name, row, frame in zip(names, rows, frames):
        same_bytes(OUT / name, frame["number"])
        x, y, z, *q = [float(each) for each in row]
        q = np.array(q)
        jpl = np.array([[1 - 2 * q[1]**2 - 2 * q[2]**2, 2 * (q[0] * q[1] + q[2] * q[3]), 2 * (q[0] * q[2] - q[1] * q[3])],
                        [2 * (q[0] * q[1] - q[2] * q[3]), 1 - 2 * q[0]**2 - 2 * q[2]**2, 2 * (q[1] * q[2] + q[0] * q[3])],
                        [2 * (q[0] * q[2] + q[1] * q[3]), 2 * (q[1] * q[2] - q[0] * q[3]), 1 - 2 * q[0]**2 - 2 * q[1]**2]])
        fx, fy = frame["camera"]["focal"]
        cx, cy = frame["camera"]["principal"]
        for point in frame["things"][0]["keypoints"][:2]:
            a, b, c = point["position"]
            at = jpl @ [a, -b, c] + [y, z, x]
            assert abs(fx * at[0] / at[2] + cx - point["pixel"][0]) < 1e-9
            assert abs(-fy * at[1] / at[2] + cy - point["pixel"][1]) < 1e-9


def yolo_lines(frame):
    same_bytes(OUT / f"images/train/{frame['name']}.png", frame["number"])
    return [[float(word) for word in line.split()] for line in (OUT / f"labels/train/{frame['name']}.txt").read_text().splitlines()]


def yolo(frames):
    assert '0: "client"' in (OUT / "data.yaml").read_text() and '2: "servicer"' in (OUT / "data.yaml").read_text()
    for frame in frames:
        seen = [thing for thing in frame["things"] if thing["visible"].any()]
        lines = yolo_lines(frame)
        assert len(lines) == len(seen) >= 2
        for line, thing in zip(lines, seen):
            row, column = np.nonzero(thing["visible"])
            number, x, y, w, h = line
            assert number == thing["id"] - 1
            edges = [64 * (x - w / 2), 48 * (y - h / 2), 64 * (x + w / 2), 48 * (y + h / 2)]
            assert np.allclose(edges, [column.min(), row.min(), column.max() + 1, row.max() + 1], atol=1e-6)


def yolo_pose(frames):
    text = (OUT / "data.yaml").read_text()
    assert "kpt_shape: [3, 3]" in text and '1: "servicer"' in text and "wing" not in text
    for frame in frames:
        seen = [thing for thing in frame["things"] if thing["visible"].any() and not thing["label"]]
        lines = yolo_lines(frame)
        assert len(lines) == len(seen)
        for line, thing in zip(lines, seen):
            assert len(line) == 5 + 3 * 3 and line[0] == (0 if thing["id"] == 1 else 1)
            for k in range(3):
                x, y, v = line[5 + 3 * k:8 + 3 * k]
                point = thing["keypoints"][k] if k < len(thing["keypoints"]) else {"truncated": True}
                if point["truncated"]:
                    assert (x, y, v) == (0, 0, 0)
                else:
                    assert v == (1 if point["occluded"] else 2)
                    assert abs(64 * x - point["pixel"][0]) < 1e-6 and abs(48 * y - point["pixel"][1]) < 1e-6


def yolo_seg(frames):
    for frame in frames:
        seen = [thing for thing in frame["things"] if thing["visible"].any()]
        lines = yolo_lines(frame)
        assert len(lines) == len(seen)
        for line, thing in zip(lines, seen):
            # filled by cv2 ten times as large, where centres of pixels are 4.5
            polygon = np.round(np.array(line[1:]).reshape(-1, 2) * [640, 480] - .5).astype(np.int32)
            large = np.zeros((480, 640), np.uint8)
            cv2.fillPoly(large, [polygon], 1)
            assert np.array_equal(large[4::10, 4::10] > 0, thing["visible"])


def kitti(frames):
    for frame in frames:
        number = f"{frame['number']:06}"
        code = cv2.imread(str(OUT / f"flow_occ/{number}_10.png"), cv2.IMREAD_UNCHANGED)
        assert code.dtype == np.uint16 and code.shape == (48, 64, 3)
        truth = cv2.readOpticalFlow(str(FOLDER / frame["forward"]))
        known = np.abs(truth[..., 0]) < 1e9
        assert np.array_equal(code[..., 0] == 1, known) and not code[~known].any()
        flow = (code[..., :0:-1].astype(float) - 32768) / 64
        assert np.abs(flow - truth)[known].max() <= 1 / 128
        same_bytes(OUT / f"image_2/{number}_10.png", frame["number"])
        if frame["number"] + 1 < len(frames):
            same_bytes(OUT / f"image_2/{number}_11.png", frame["number"] + 1)


def ply(path):
    data = path.read_bytes()
    head, _, body = data.partition(b"end_header\n")
    count, faces = [int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element")]
    vertices = np.frombuffer(body, "<f4", 6 * count).reshape(-1, 6)
    triangles = [struct.unpack_from("<B3i", body, 24 * count + 13 * k) for k in range(faces)]
    assert len(body) == 24 * count + 13 * faces and all(each[0] == 3 for each in triangles)
    return vertices, np.array([each[1:] for each in triangles])


def bop(frames):
    scene = OUT / "train/000000"
    poses, infos, cameras = [json.loads((scene / f"scene_{name}.json").read_text()) for name in ("gt", "gt_info", "camera")]
    assert list(poses) == list(infos) == list(cameras) == ["0", "1", "2"]
    vertices, triangles = ply(OUT / "models/obj_000001.ply")
    # the node turns (x, y, z) to (-y, -x, z) + (5, 0, 0)
    corners = 1000 * np.array([[5 - y, -x, z] for x in (-.5, .5) for y in (-1, 1) for z in (-1.5, 1.5)])
    assert {tuple(np.round(each)) for each in vertices[:, :3]} == {tuple(each) for each in corners}
    a, b, c = (vertices[triangles[:, k], :3] for k in range(3))
    normal = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", normal, a - [5000, 0, 0]) > 0).all()
    assert (np.einsum("ij,ij->i", normal / np.linalg.norm(normal, axis=1, keepdims=True), vertices[triangles[:, 0], 3:]) > .999).all()
    info = json.loads((OUT / "models/models_info.json").read_text())["1"]
    assert abs(info["diameter"] - 1000 * np.sqrt(1 + 4 + 9)) < 1e-3
    assert np.allclose([info[name] for name in ("min_x", "min_y", "min_z", "size_x", "size_y", "size_z")], [4000, -500, -1500, 2000, 1000, 3000])
    for frame in frames:
        key, number = str(frame["number"]), f"{frame['number']:06}"
        same_bytes(scene / f"rgb/{number}.png", frame["number"])
        camera = cameras[key]
        k = np.array(camera["cam_K"]).reshape(3, 3)
        r_world, t_world = np.array(camera["cam_R_w2c"]).reshape(3, 3), np.array(camera["cam_t_w2c"])
        assert np.allclose(r_world @ (1000 * np.array(frame["camera"]["position"])) + t_world, 0, atol=1e-9)
        assert np.allclose(r_world, matrix(frame["camera"]["world_from_camera"]).T, atol=1e-15)
        depth = cv2.imread(str(scene / f"depth/{number}.png"), cv2.IMREAD_UNCHANGED)
        truth = np.load(FOLDER / f"{frame['name']}.npz")["depth"]
        assert depth.dtype == np.uint16 and camera["depth_scale"] == 1
        assert np.array_equal(depth, np.where(np.isfinite(truth), 1000 * truth, 0))
        targets = [thing for thing in frame["things"] if not thing["label"]]
        assert len(poses[key]) == len(infos[key]) == len(targets)
        for place, (pose, info, thing) in enumerate(zip(poses[key], infos[key], targets)):
            assert pose["obj_id"] == thing["id"]
            r, t = np.array(pose["cam_R_m2c"]).reshape(3, 3), np.array(pose["cam_t_m2c"])
            truth_r, truth_t = matrix(thing["camera_from_thing"]["rotation"]), 1000 * np.array(thing["camera_from_thing"]["translation"])
            points = vertices[:, :3].astype(float)
            add = np.linalg.norm(points @ r.T + t - points @ truth_r.T - truth_t, axis=1).mean()
            assert add < 1e-9, add
            for point in thing["keypoints"]:
                if point["pixel"]:
                    pixel = k @ (r @ (1000 * np.array(point["position"])) + t)
                    assert np.allclose(pixel[:2] / pixel[2] + .5, point["pixel"], atol=1e-9)
            mask, seen = [cv2.imread(str(scene / f"{name}/{number}_{place:06}.png"), cv2.IMREAD_UNCHANGED) for name in ("mask", "mask_visib")]
            assert np.array_equal(mask == 255, thing["amodal"]) and np.array_equal(seen == 255, thing["visible"])
            assert not ((mask != 255) & (mask != 0)).any()
            assert info["px_count_visib"] == (seen > 0).sum()
            assert info["px_count_valid"] == ((mask > 0) & (depth > 0)).sum()
            assert abs(info["visib_fract"] - (seen > 0).sum() / info["px_count_all"]) < 1e-15
            box = thing["amodal_box"]
            if box[0] >= 0:
                assert info["px_count_all"] == (mask > 0).sum()
            else:
                assert abs(info["px_count_all"] - thing["amodal_pixels"]) <= 4
            x, y, w, h = info["bbox_obj"]
            assert np.abs(np.array([x, y, x + w + 1, y + h + 1]) - box).max() <= 1, (info, box)
            if seen.any():
                row, column = np.nonzero(seen)
                assert info["bbox_visib"] == [column.min(), row.min(), column.max() - column.min(), row.max() - row.min()]
            else:
                assert info["bbox_visib"] == [-1] * 4


JUDGES = {"coco": coco, "speed": speed, "speedplus": lambda frames: speed(frames, "q_vbs2tango_true"), "spark": spark, "urso": urso,
          "yolo": yolo, "yolo-pose": yolo_pose, "yolo-seg": yolo_seg, "kitti": kitti, "bop": bop}
JUDGES[FORMAT](load())
