"""Runs every example, and the blocks of Python of a page: they end well and print what they found.

    examples_test.py FOLDER PAGE
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

MOST_LINES = 25
failed = 0
examples = sorted(pathlib.Path(sys.argv[1]).glob("*.py"))
assert len(examples) >= 10, examples
for example in examples:
    lines = sum(bool(line.strip()) for line in example.read_text().splitlines())
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, "-W", "error", example], cwd=folder, capture_output=True, text=True,
                              env={**os.environ, "PANWRIGHT_CACHE": "off"})
    good = done.returncode == 0 and done.stdout.strip() and lines <= MOST_LINES
    print(f"{example.name}: {'ok' if good else 'failed'}, {lines} lines\n{done.stdout}{done.stderr}")
    failed += not good
page = pathlib.Path(sys.argv[2])
blocks = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.S)
assert len(blocks) >= 3, page
done = subprocess.run([sys.executable, "-W", "error", "-c", "\n".join(blocks)], cwd=page.parent.parent, capture_output=True, text=True,
                      env={**os.environ, "PANWRIGHT_CACHE": "off"})
print(f"{page.name}:\n{done.stdout}{done.stderr}")
failed += done.returncode != 0 or not done.stdout
sys.exit(failed > 0)
