"""The package and its stub pass a strict type checker, and the stub matches the compiled module.

    types_test.py FOLDER
"""
import importlib.util
import pathlib
import subprocess
import sys
import tempfile

if importlib.util.find_spec("mypy") is None:
    print("mypy is not installed: skipped")
    sys.exit(77)

USE = """
import panwright as pw
view: pw.View = {"camera": [1, 2, 3], "size": "64x64"}
image = pw.Renderer("a.pan").render(view)
depth: float = float(image["depth"].max())
"""
WRONG = """
import panwright as pw
view: pw.View = {"camrea": [1, 2, 3]}
pw.Renderer("a.pan").render(labels="yes")
pw.open(3)
"""
folder = pathlib.Path(sys.argv[1])
with tempfile.TemporaryDirectory() as work:
    def check(*words):
        return subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", work, *words], cwd=folder, capture_output=True, text=True)

    whole = check("panwright")
    print(whole.stdout)
    for name, text in (("use.py", USE), ("wrong.py", WRONG)):
        (pathlib.Path(work) / name).write_text(text)
    use, wrong = check(f"{work}/use.py"), check(f"{work}/wrong.py")
    print(use.stdout, wrong.stdout)
    errors = wrong.stdout.count(": error:")
    # pybind11's metaclass, and classes that cannot be made, are not what stubs can say
    (pathlib.Path(work) / "allowed").write_text(r"panwright\._core\.\w+(\.__init__)?" + "\n")
    stub = subprocess.run([sys.executable, "-m", "mypy.stubtest", "panwright._core", "--ignore-missing-stub", "--allowlist", f"{work}/allowed",
                           "--ignore-unused-allowlist"], cwd=folder, capture_output=True, text=True)
print(stub.stdout, stub.stderr)
sys.exit(whole.returncode or use.returncode or errors != 3 or stub.returncode)
