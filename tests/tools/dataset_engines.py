#!/usr/bin/env python3
"""dataset_engines.py PANWRIGHT EXAMPLES: a data set by each engine that is installed has the bytes of one run.

Slurm's array script is run by sh with the variables that Slurm sets: no cluster is started.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

program, examples = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
SHARDS = 3
PLAN = """frames = 6
seed = 3
[targets]
box = "box.pxn"
[camera]
range = { uniform = [4, 9] }
[labels]
[view]
sun = [1, -1, 0.5]
size = [32, 24]
fov = 40
engine = "reference"
samples = 1
"""


def run(words, folder, **more):
    # other engines start the program by its name
    path = f"{program.parent}:{os.environ['PATH']}"
    done = subprocess.run([str(w) for w in words], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "PATH": path, "HOME": str(folder), **more})
    if done.returncode != 0:
        sys.exit(f"{words}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")


def tree(folder):
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}


def slurm(folder):
    for k in range(SHARDS):
        run(["sh", examples / "slurm.sh", "set"], folder, SLURM_ARRAY_TASK_ID=str(k), SLURM_ARRAY_TASK_COUNT=str(SHARDS))


def parallel(folder):
    run(["sh", examples / "parallel.sh", "set", SHARDS], folder)


def snakemake(folder):
    run(["snakemake", "--snakefile", examples / "Snakefile", "--cores", "2", "--config", "plan=plan.toml", f"shards={SHARDS}"], folder)
    assert (folder / "archives/shard-000000.tar").is_file()


def dask(folder):
    run([DASK, examples / "with_dask.py", "set", SHARDS], folder)


# Debian's Python has the package, another one may not
DASK = next((p for p in (sys.executable, "/usr/bin/python3")
             if subprocess.run([p, "-c", "import distributed"], capture_output=True).returncode == 0), None)
ENGINES = {
    "slurm": (slurm, True, "bash"),
    "GNU parallel": (parallel, shutil.which("parallel"), "parallel"),
    "snakemake": (snakemake, shutil.which("snakemake"), "snakemake"),
    "dask": (dask, DASK, "python3-distributed"),
}

with tempfile.TemporaryDirectory() as temporary:
    def planned(name):
        folder = pathlib.Path(temporary) / name.replace(" ", "-")
        folder.mkdir()
        (folder / "box.pxn").write_text('<pangu_model ver="1"><box size="1"/></pangu_model>')
        (folder / "plan.toml").write_text(PLAN)
        run([program, "dataset", "plan", "plan.toml", "-o", "set"], folder)
        return folder

    alone = planned("alone")
    run([program, "dataset", "run", "set"], alone)
    expected = tree(alone / "set")
    assert len(expected) == 6 + 6 * 4, sorted(expected)
    for name, (engine, found, package) in ENGINES.items():
        if not found:
            print(f"{name}: not run, as {package} is not installed")
            continue
        folder = planned(name)
        engine(folder)
        got = tree(folder / "set")
        wrong = [f for f in expected.keys() | got.keys() if expected.get(f) != got.get(f)]
        assert not wrong, f"{name}: {sorted(wrong)}"
        print(f"{name}: {len(got)} files, the same bytes"
              + (" (its script by sh, without a cluster)" if name == "slurm" else ""))
