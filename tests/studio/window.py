#!/usr/bin/env python3
"""The window under a display without a screen: it is used by scripts, and what it saves is what
`panwright render` makes of the command that it shows.

    window.py PANWRIGHT SOURCE FOLDER

Exit code 77: Xvfb is not installed (scripts/setup installs it).
"""
import json
import os
import shutil
import struct
import subprocess
import sys
import zlib

MODEL = """<pangu_model ver="1">
  <material name="grey"> <diffuse> 0.5 0.5 0.5 </diffuse> </material>
  <joint name="hinge" type="revolute" axis="0 0 1" lower="0deg" upper="90deg">
    <box name="door" size="1 0.2 1" material="grey"/>
  </joint>
  <joint name="swivel" type="ball"> <box name="horn" size="0.2 0.2 0.4" translate="0 0.6 1" material="grey"/> </joint>
  <sphere name="ball" radius="0.4" translate="0 0 1.2" material="grey"/>
</pangu_model>
"""
wrong = []


def expect(what, good):
    if not good:
        wrong.append(what)
        print(f"wrong: {what}")


def view(program, folder, steps, *files, code=0, size="1280x720"):
    """What the window says at the end of a script."""
    script = os.path.join(folder, "script.json")
    with open(script, "w", encoding="utf-8") as file:
        json.dump(steps, file)
    words = ["xvfb-run", "-a", "-s", "-screen 0 2600x1500x24", program, "view", "--script", script,
             "--size", size, "--scale", "1", "--gl", "osmesa", "--json", *files]
    done = subprocess.run(words, capture_output=True, text=True, cwd=folder)
    said = json.loads(done.stdout)
    # xvfb-run may fail to remove its own folder, and says so with a code of its own
    ended = said["exit_code"] if "cleaning up temporary directory" in done.stderr else done.returncode
    expect(f"exit code {ended}: {done.stdout}{done.stderr}", ended == code)
    return said


def colours(path):
    """The number of different colours of a PNG, and its size."""
    with open(path, "rb") as file:
        data = file.read()
    at, packed, width, height = 8, b"", 0, 0
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height = struct.unpack(">II", data[at + 8:at + 16])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    return len(set(zlib.decompress(packed))), width, height


def main():
    program, source, folder = sys.argv[1:4]
    if not shutil.which("xvfb-run"):
        print("xvfb-run is not installed: no window was opened")
        return 77
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    model = os.path.join(folder, "door.pxn")
    with open(model, "w", encoding="utf-8") as file:
        file.write(MODEL)

    # what is seen is what is saved, and what the command makes
    said = view(program, folder, [
        {"wait": "exact"}, {"screenshot": "first.png"},
        {"click": "tab/Joints"}, {"type": ["joint/door/hinge", "30"]},
        {"expect": ["joint/door/hinge", "0.5235987755982988rad"]},
        {"type": ["joint/door/swivel/1", "90"]}, {"expect": ["joint/door/swivel", "0rad 1.5707963267948966rad 0rad"]},
        {"click": "tab/Camera"}, {"type": ["camera/range", "5"]}, {"type": ["camera/azimuth", "-60"]},
        {"type": ["camera/elevation", "20"]}, {"expect": ["range", "5"]},
        {"click": "tab/Save"}, {"wait": "exact"}, {"click": "save/save"}, {"wait": 20},
        {"wait": "saved"}, {"expect": ["saved", f"saved {folder}/image.png"]},
        {"screenshot": "saved.png"}], "door.pxn")
    expect("an exact image was drawn", said["exact"] >= 1)
    saved = os.path.join(folder, "image.png")
    same = os.path.join(folder, "same.png")
    words = said["render"]
    subprocess.run(["sh", "-c", words.replace("panwright", program, 1).replace(
        "-o image.png", f"-o {same}") + " --gl osmesa --quiet"], cwd=folder, check=True)
    with open(saved, "rb") as a, open(same, "rb") as b:
        expect("the file is that of the command", a.read() == b.read())

    # edits: a good one, a broken one, a mended one
    said = view(program, folder, [
        {"wait": "exact"},
        {"replace": {"file": "door.pxn", "text": "radius=\"0.4\"", "with": "radius=\"0.6\""}},
        {"wait": "exact"}, {"expect": ["failed", "false"]}, {"expect": ["readings", "2"]},
        {"replace": {"file": "door.pxn", "text": "<sphere", "with": "<sfere"}},
        {"wait": "read"}, {"expect": ["failed", "true"]}, {"expect": ["errors", "1"]},
        {"screenshot": "broken.png"}, {"expect": ["exact", "true"]},
        {"replace": {"file": "door.pxn", "text": "<sfere", "with": "<sphere"}},
        {"wait": "exact"}, {"expect": ["failed", "false"]},
        {"click": "tab/Parts"}, {"click": "visible/door/root/ball"}, {"expect": ["hidden", "1"]},
        {"wait": "exact"}, {"screenshot": "hidden.png"}], "door.pxn")
    expect("the models were read four times", said["readings"] == 4)

    # a number of a material, live, undone, and into its text
    with open(model, encoding="utf-8") as file:
        before = file.read()
    view(program, folder, [
        {"wait": "exact"}, {"click": "tab/Materials"}, {"click": "material/door.pxn/grey"},
        {"type": ["number/grey/diffuse/0", "0.9"]}, {"expect": ["edits", "1"]},
        {"type": ["number/grey/diffuse/1", "0.1"]}, {"expect": ["edits", "2"]},
        {"click": "materials/undo"}, {"expect": ["edits", "1"]}, {"wait": "exact"},
        {"expect": ["failed", "false"]}, {"screenshot": "material.png"},
        {"click": "materials/save"}, {"expect": ["edits", "0"]}, {"wait": 5}, {"wait": "exact"}], "door.pxn")
    with open(model, encoding="utf-8") as file:
        expect("one number of the text is another", file.read() == before.replace("0.5 0.5 0.5", "0.9 0.5 0.5"))

    # a long tour, at two sizes
    for size in ("1280x720", "2560x1440"):
        with open(os.path.join(source, "tests/studio/tour.json"), encoding="utf-8") as file:
            steps = json.load(file)["steps"]
        for step in steps:
            if "screenshot" in step:
                step["screenshot"] = f"{size}-{step['screenshot']}"
        view(program, folder, steps, os.path.join(source, "examples/cubesat/cubesat.pxn"), size=size)
    for name in sorted(os.listdir(folder)):
        if name.endswith(".png") and name not in ("image.png", "same.png"):
            count, width, height = colours(os.path.join(folder, name))
            expect(f"{name} shows something", count > 40 and width in (1280, 2560)
                   and height in (720, 1440))

    # what cannot be done is said
    for step, words in (({"click": "tab/Son"}, "'tab/Sun' is"), ({"expect": ["range", "7"]}, "not '7'"),
                        ({"replace": {"file": "door.pxn", "text": "nowhere", "with": ""}}, "does not hold")):
        said = view(program, folder, [step], "door.pxn", code=2)
        expect(f"{step}: {said['diagnostics']}", words in said["diagnostics"][0]["message"])
    view(program, folder, [{"wait": "read"}, {"expect": ["failed", "true"]}, {"screenshot": "none.png"}],
         "nothing.pxn")
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run([program, "view", "door.pxn"], capture_output=True, text=True, cwd=folder,
                          env=environment)
    expect(f"without a display: {done.stderr}", "panwright render" in done.stderr and done.returncode == 1)
    print(f"{len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
