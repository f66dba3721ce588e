#!/usr/bin/env python3
"""packages.py CPACK BUILD: the Debian packages of program and Python module, unpacked beside nothing else, draw the same pixels.

Exit code 77: dpkg-deb is not there, or its Python is another one than the packages are for.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

cpack, build = sys.argv[1], pathlib.Path(sys.argv[2])
if not shutil.which("dpkg-deb") or subprocess.run(["/usr/bin/python3", "-c", "import numpy"], capture_output=True).returncode != 0:
    print("dpkg-deb or Debian's numpy is not installed: skipped")
    sys.exit(77)


def run(*words, **more):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"{words}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    run(cpack, "-G", "DEB", "-B", folder / "packages", "-D", "CPACK_COMPONENTS_ALL=program;python", cwd=build)
    packages = sorted((folder / "packages").glob("*.deb"))
    assert [p.name.split("_")[0] for p in packages] == ["panwright", "python3-panwright"], packages
    root = folder / "root"
    for package in packages:
        print(package.name, run("dpkg-deb", "-f", package, "Depends"))
        run("dpkg-deb", "-x", package, root)
    # nothing of the build: another place, and no path to it
    clean = {"PATH": f"{root}/usr/bin:/usr/bin:/bin", "HOME": str(folder), "PYTHONPATH": f"{root}/usr/lib/python3/dist-packages"}
    model = root / "usr/share/panwright/examples/cubesat/cubesat.pxn"
    settings = ["--size", "48", "--samples", "1", "--gl", "osmesa"]
    run(root / "usr/bin/panwright", "render", model, "-o", folder / "program.npy", *settings, env=clean, cwd=folder)
    code = ("import numpy as np, panwright as pw, sys\n"
            "assert pw.__file__.startswith(sys.argv[1]), pw.__file__\n"
            "with pw.Renderer(sys.argv[2], gl='osmesa', size=48, samples=1) as renderer: image = renderer.render()\n"
            "expected = np.load('program.npy')\n"
            "assert expected.max() > 0 and np.array_equal(image['radiance'], expected)\n")
    run("/usr/bin/python3", "-c", code, root, model, env=clean, cwd=folder)
print("the same pixels")
