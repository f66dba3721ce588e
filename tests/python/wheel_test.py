"""Makes the wheel, installs it alone and draws with it.

    wheel_test.py CMAKE BUILD EXAMPLES
"""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile

cmake, build, examples = sys.argv[1:]
if importlib.util.find_spec("wheel") is None or importlib.util.find_spec("pip") is None:
    print("wheel or pip is not installed: skipped")
    sys.exit(77)
subprocess.run([cmake, "--build", build, "--target", "panwright_wheel"], check=True, stdout=subprocess.DEVNULL)
wheel, = pathlib.Path(build, "python").glob("*.whl")
with tempfile.TemporaryDirectory() as folder:
    subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--no-cache-dir", "--target", folder, wheel], check=True)
    code = ("import panwright as pw, sys\n"
            "image = pw.Renderer(sys.argv[1], gl='osmesa', size=16).render()\n"
            "assert image['radiance'].max() > 0\nprint(pw.__file__, pw.__version__)\n")
    done = subprocess.run([sys.executable, "-c", code, pathlib.Path(examples, "cubesat/cubesat.pxn")], cwd="/", capture_output=True, text=True, check=True,
                          env={**os.environ, "PYTHONPATH": folder})
    print(wheel.name, done.stdout)
    assert done.stdout.startswith(folder)
