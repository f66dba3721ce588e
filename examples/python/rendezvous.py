"""Frames of a scenario with their labels."""
import pathlib

import panwright as pw

examples = pathlib.Path(__file__).resolve().parent.parent
scenario = pw.Scenario(examples / "rendezvous/rendezvous.toml", every=200, samples=2)
for image in pw.frames(scenario, labels=True):
    client = next(thing for thing in image.things if thing.target == "client" and not thing.label)
    print(f"{image.time:6.0f} s: client {client.visible_pixels:8.0f} pixels at {client.camera_from_thing[:3, 3].round(2)} m")
    image.save(f"frame{image.number:03}.png")
