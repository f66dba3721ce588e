"""Panwright: spacecraft models as a rendezvous camera shows them.

    import panwright as pw

    model = pw.open("client.pxn")                       # any file: pan, pxn, CAD
    with pw.Renderer(model) as renderer:
        image = renderer.render(camera=[0, -9, 3], sun=[1, -1, 0.5], labels=True)
    image["depth"]                                      # (H, W) float32, metres
    image.things[0].keypoints[0].pixel

Settings of an image are those of `panwright render` and of views files, with `_` between words
(docs/views.md). Lengths are metres; pixels count from the upper left corner of the image, and pixel
(i, j) covers [i, i+1) × [j, j+1). Arrays have row 0 at the top.
"""

from __future__ import annotations

from ._core import Camera, Image, Joint, Keypoint, Model, Thing, material_names
from ._core import version as __version__
from ._diagnostics import Cancelled, Diagnostic, Error, PanwrightWarning
from ._instruments import Lookups, lidar, radar
from ._render import Renderer, Scenario, command, frames, material, open, record, sheet
from ._views import View

__all__ = [
    "Camera", "Cancelled", "Diagnostic", "Error", "Image", "Joint", "Keypoint", "Lookups", "Model", "PanwrightWarning", "Renderer", "Scenario",
    "Thing", "View", "__version__", "command", "frames", "lidar", "material", "material_names", "open", "radar", "record", "sheet",
]
