"""What the module opens, draws and closes again leaves nothing behind.

    leaks.py EXAMPLES        under valgrind, by leaks_test.py
"""
import gc
import pathlib
import sys
import warnings

import panwright as pw

examples = pathlib.Path(sys.argv[1])
warnings.simplefilter("ignore", pw.PanwrightWarning)
for _ in range(2):
    model = pw.open(examples / "cubesat/cubesat.pxn", cache=False)
    model.mesh()
    try:
        pw.open(examples / "none.pxn")
    except pw.Error:
        pass
    pw.Camera(examples / "cameras/star_tracker.toml").project([[0, 0, 1]])
    pw.material("white_z93").brdf([0, 0, 1], [0, 0, 1])
    pw.sheet("crinkled", 0.1, 0.1).heights.sum()
    with pw.Renderer(model, gl="osmesa", size="24x16", samples=1, shadows="off") as renderer:
        for image in renderer.frames([{}, {}], labels=True):
            image.things[0].visible.sum()
            image["depth"].max()
        renderer.frames([{}])  # given up
    scenario = pw.Scenario(examples / "rendezvous/rendezvous.toml", every=1000)
    scenario.times.clear()
    del model, renderer, image, scenario
    gc.collect()
