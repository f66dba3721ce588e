"""Reads the files of frames with numpy and cv2, and compares them with each other and the schema.

own_files_peer.py FOLDER
"""

import json
import pathlib
import sys

try:
    import cv2
    import numpy as np
except ImportError as missing:
    print(missing)
    sys.exit(77)
import schema

FOLDER = pathlib.Path(sys.argv[1])
SCHEMA = json.loads((pathlib.Path(__file__).resolve().parents[2] / "schemas/labels.schema.json").read_text())
files = sorted(FOLDER.glob("*.labels.json"))
assert len(files) == 3
for file in files:
    frame = json.loads(file.read_text())
    found = list(schema.problems(frame, SCHEMA, SCHEMA))
    assert not found, found
    width, height = frame["camera"]["width"], frame["camera"]["height"]
    masks = np.load(FOLDER / frame["masks"])
    wanted = [f"{thing['id']}.{kind}" for thing in frame["things"] for kind in ("amodal", "visible") if thing[kind]["width"]]
    assert masks.files == wanted, (masks.files, wanted)
    for thing in frame["things"]:
        for kind in ("amodal", "visible"):
            place = thing[kind]
            if not place["width"]:
                continue
            crop = masks[f"{thing['id']}.{kind}"]
            assert crop.dtype == np.uint8 and crop.shape == (place["height"], place["width"])
            assert crop[0].any() and crop[-1].any() and crop[:, 0].any() and crop[:, -1].any()
            if kind == "visible":
                assert abs(crop.sum() / 255 - thing["visible_pixels"]) < 1e-9
    # the first thing is a disc about x = 36 + 2 t, y = 22.5
    crop, place = masks["1.amodal"].astype(float), frame["things"][0]["amodal"]
    x = (crop.sum(0) * (place["left"] + .5 + np.arange(place["width"]))).sum() / crop.sum()
    assert abs(x - 36 - 2 * frame["number"]) < .01, x
    for name in ("forward", "backward"):
        if frame[name] is None:
            assert name == "backward" and frame["number"] == 0
            continue
        flow = cv2.readOpticalFlow(str(FOLDER / frame[name]))
        assert flow.shape == (height, width, 2)
        known = np.abs(flow[..., 0]) < 1e9
        assert 200 < known.sum() < 300, known.sum()
        row, column = np.nonzero(known)
        step = 2 if name == "forward" else -2
        assert np.array_equal(flow[row, column, 0], np.float32(step) + column.astype(np.float32) / 64)
        assert np.array_equal(flow[row, column, 1], np.float32(-.125) * row.astype(np.float32))
