"""The error of a fast image against the reference renderer."""
import pathlib

import numpy as np
import panwright as pw

examples = pathlib.Path(__file__).resolve().parent.parent
with pw.Renderer(examples / "cubesat/cubesat.pxn", size="64x64", sun=[1, -1, 0.5]) as renderer:
    fast = renderer.render()
    truth = renderer.render(engine="reference", bounces=0, seed=1)
difference = fast["radiance"].sum() / truth["radiance"].sum() - 1
print(f"flux differs by {100 * difference:.2f} %; mean standard error of a pixel {truth['standard_error'].mean():.2g}")
