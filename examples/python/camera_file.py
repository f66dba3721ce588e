"""Points through a camera with distortion, and back."""
import pathlib

import numpy as np
import panwright as pw

examples = pathlib.Path(__file__).resolve().parent.parent
camera = pw.Camera(examples / "rendezvous/camera.toml")
points = np.random.default_rng(1).uniform([-1, -1, 4], [1, 1, 9], (1000, 3))
rays = camera.rays(camera.project(points))
back = rays * np.linalg.norm(points, axis=1, keepdims=True)
print(camera.width, camera.height, "largest difference", np.abs(back - points).max(), "m")
