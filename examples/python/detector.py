"""Digital numbers of a camera along a scenario, with labels: arrays to train on."""
import pathlib

import numpy as np
import panwright as pw

examples = pathlib.Path(__file__).resolve().parent.parent
pathlib.Path("camera.toml").write_text("""size = [160, 120]
focal_length_mm = 6
pixel_um = 24
[optics]
f_number = 8
psf_px = 0.5
[detector]
exposure_s = 1e-4
read_noise_e = 9
bits = 10
""")
scenario = pw.Scenario(examples / "rendezvous/rendezvous.toml", every=200, samples=2, camera_file="camera.toml")
numbers, pixels = [], []
for image in pw.frames(scenario, labels=True):
    numbers.append(image["dn"])
    client = next(thing for thing in image.things if thing.target == "client" and not thing.label)
    pixels.append([point.pixel or (np.nan, np.nan) for point in client.keypoints])
print("numbers", np.stack(numbers).shape, "up to", np.max(numbers), "keypoints", np.array(pixels).shape)
