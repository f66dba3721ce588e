"""A wing that turns: one model, many values of a joint."""
import pathlib

import panwright as pw

examples = pathlib.Path(__file__).resolve().parent.parent
model = pw.open(examples / "servicer/servicer.pxn")
print([joint.name for joint in model.joints])
with pw.Renderer(model, size="256x256", camera=[10, -10, 6], look_at=[0, 0, 0], fov=60, samples=2) as renderer:
    views = [{"joint": {"wing_left/drive": f"{angle}deg"}} for angle in range(0, 180, 45)]
    for view, image in zip(views, renderer.frames(views)):
        print(view["joint"], "flux", float(image["radiance"].sum()))
