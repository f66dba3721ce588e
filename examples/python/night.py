"""Over the Earth at night, with a docking light."""
import pathlib

import panwright as pw

examples = pathlib.Path(__file__).resolve().parent.parent
with pw.Renderer(examples / "client/client.pxn", size="256x256", camera=[6, -9, 3], look_at=[0, 0, 0], fov=50, samples=2) as renderer:
    day = renderer.render(planet={"earth": [0, 0, -6778000]}, sun=[1, -1, 2])
    night = renderer.render(planet={"earth": [0, 0, -6778000]}, sun=[0, 0, -1],
                            lamp=["spot on camera intensity 40 half-angle 20deg"])
print("day", float(day["radiance"].sum()), "night", float(night["radiance"].sum()))
night.save("night.png")
