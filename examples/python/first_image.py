"""An image of the client as a PNG."""
import pathlib

import panwright as pw

examples = pathlib.Path(__file__).resolve().parent.parent
with pw.Renderer(examples / "client/client.pxn", size="320x240") as renderer:
    image = renderer.render(camera=[6, -9, 3], sun=[1, -1, 0.5])
image.save("client.png")
print(image.width, image.height, image.unit, "largest radiance", image["radiance"].max())
