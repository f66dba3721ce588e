#!/usr/bin/env python3
"""python_speed.py PANWRIGHT MODULE [MODEL]: what Python costs beyond the program, as lines of CSV.

The same 100 views of 100 × 100 pixels by `panwright render --views`, which writes .npy files of radiance, and by the module in the
folder MODULE, that layer alone, in processor time of all threads: interleaved runs, medians. Pixels must be the same to the bit. Import:
its processor time beyond that of numpy, and with it.
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

program, module = (str(pathlib.Path(word).resolve()) for word in sys.argv[1:3])
root = pathlib.Path(__file__).resolve().parent.parent
model = sys.argv[3] if len(sys.argv) > 3 else str(root / "examples/servicer/servicer.pxn")
RUNS, FRAMES = 5, 100
DRAW = """
import json, sys, numpy as np, panwright as pw
views = json.load(open("views.json"))
outputs = [view.pop("output") for view in views]
with pw.Renderer(sys.argv[1], gl="osmesa", size=100, samples=1, layers="radiance") as renderer:
    for image, output in zip(renderer.frames(views), outputs):
        radiance = image["radiance"]
        if len(sys.argv) > 2:
            assert np.array_equal(radiance, np.load(output)), output
"""


def seconds(words, folder):
    """Processor time of a command, all its threads."""
    before = os.times()
    done = subprocess.run(words, cwd=folder, env={**os.environ, "PYTHONPATH": module}, capture_output=True, text=True)
    after = os.times()
    if done.returncode != 0:
        sys.exit(f"{words}: {done.stdout}{done.stderr}")
    return after.children_user + after.children_system - before.children_user - before.children_system


with tempfile.TemporaryDirectory() as folder:
    views = [{"camera": [9 + 0.02 * k, -9, 8], "sun": [1, -0.7, 0.6], "output": f"{k}.npy"} for k in range(FRAMES)]
    pathlib.Path(folder, "views.json").write_text(json.dumps(views))
    command = [program, "render", model, "--views", "views.json", "--size", "100", "--samples", "1", "--gl", "osmesa", "--quiet"]
    draw = [sys.executable, "-c", DRAW, model]
    seconds(command, folder), seconds([*draw, "compare"], folder)
    times = {"program": [], "Python": [], "numpy": [], "panwright": []}
    for _ in range(RUNS):
        times["program"].append(seconds(command, folder))
        times["Python"].append(seconds(draw, folder))
        times["numpy"].append(seconds([sys.executable, "-c", "import numpy"], folder))
        times["panwright"].append(seconds([sys.executable, "-c", "import panwright"], folder))
    of = {name: statistics.median(all) for name, all in times.items()}
print("# python_speed.py: processor time, medians of", RUNS, "runs; all pixels the same to the bit")
print("case,setting,value,unit,must")
print(f"python,{FRAMES} frames of 100x100 beside the program's frames/s,{of['program'] / of['Python']:.3f},ratio,>=0.95")
print(f"python,import with numpy,{of['panwright']:.3f},s,<=0.15")
print(f"python,import without numpy,{of['panwright'] - of['numpy']:.3f},s,")
