"""leaks.py under valgrind: of what the module allocates, nothing is definitely lost.

    leaks_test.py SCRIPT EXAMPLES SUPPRESSIONS

Exit code 77: valgrind is not installed (scripts/setup --nightly installs it).
"""
import os
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

if not shutil.which("valgrind"):
    print("valgrind is not installed: skipped")
    sys.exit(77)
script, examples, suppressions = sys.argv[1:4]
with tempfile.TemporaryDirectory() as folder:
    report = os.path.join(folder, "report.xml")
    done = subprocess.run(
        ["valgrind", "--leak-check=full", "--show-leak-kinds=definite", "--num-callers=40", f"--suppressions={suppressions}", "--xml=yes",
         f"--xml-file={report}", sys.executable, script, examples],
        env={**os.environ, "PYTHONMALLOC": "malloc", "PANWRIGHT_CACHE": "off"}, capture_output=True, text=True, check=False)
    print(done.stdout, done.stderr)
    root = tree.parse(report).getroot()
lost = [error for error in root.iter("error") if error.findtext("kind") == "Leak_DefinitelyLost"]
ours = [error for error in lost if any("panwright/_core" in (frame.findtext("obj") or "") for frame in error.iter("frame"))]
for error in ours:
    print(error.findtext("xwhat/text"))
    for frame in error.iter("frame"):
        print("   ", frame.findtext("fn"), frame.findtext("obj"))
print(f"{len(lost)} definite leaks, {len(ours)} with the module among their callers")
sys.exit(done.returncode != 0 or bool(ours))
