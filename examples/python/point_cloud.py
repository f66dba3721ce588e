"""The depth of an image as points in camera axes."""
import pathlib

import numpy as np
import panwright as pw

examples = pathlib.Path(__file__).resolve().parent.parent
with pw.Renderer(examples / "client/client.pxn", size="320x240") as renderer:
    image = renderer.render(camera=[6, -9, 3])
row, column = np.nonzero(image["target_id"])
pixels = np.stack([column + 0.5, row + 0.5, np.ones(len(row))])
points = (np.linalg.inv(image.camera_matrix) @ pixels * image["depth"][row, column]).T
print(points.shape, "nearest", points[:, 2].min(), "m")
