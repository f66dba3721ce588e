"""Keypoints drawn over an image."""
import pathlib

import panwright as pw
from PIL import Image, ImageDraw

examples = pathlib.Path(__file__).resolve().parent.parent
with pw.Renderer(examples / "client/client.pxn", size="640x480") as renderer:
    image = renderer.render(camera=[6, -9, 3], sun=[1, -1, 0.5], labels=True)
picture = Image.fromarray(image.srgb(photo=True))
draw = ImageDraw.Draw(picture)
for point in image.things[0].keypoints:
    if point.pixel is not None:
        x, y = point.pixel
        draw.ellipse([x - 3, y - 3, x + 3, y + 3], outline="red" if point.occluded else "lime")
picture.save("keypoints.png")
print(len(image.things[0].keypoints), "keypoints, box", image.things[0].visible_box)
