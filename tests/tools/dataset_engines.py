#!/usr/bin/env python3
"""dataset_engines.py PANWRIGHT EXAMPLES [--cluster]: a data set by each engine that is installed has the bytes of one run.

Slurm's array script is run by sh with the variables that Slurm sets; --cluster submits it to a Slurm of one node,
started here without rights of root, and runs nothing else.
"""
import contextlib
import os
import pathlib
import pwd
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

program, examples = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
SHARDS = 3
# four processors are told of a smaller machine too: the script asks for as many
CONFIGURATION = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={worker}
AuthInfo=socket={home}/munge
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={home}/state
SlurmdSpoolDir={home}/spool
SlurmctldPidFile={home}/slurmctld.pid
SlurmdPidFile={home}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SchedulerParameters=sched_interval=2
SelectType=select/cons_tres
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs=8
PartitionName=all Nodes={host} Default=YES
"""
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


@contextlib.contextmanager
def slurm_cluster():
    """A Slurm of this machine, its files in a folder of its own, on ports that are free: environment of its commands."""
    with tempfile.TemporaryDirectory() as home, contextlib.ExitStack() as stack:
        home = pathlib.Path(home)
        ports = []
        for _ in range(2):
            with socket.socket() as probe:
                probe.bind(("127.0.0.1", 0))
                ports.append(probe.getsockname()[1])
        # munged asks for a folder that nobody else can write, and a socket that all can reach
        home.chmod(0o755)
        (home / "key").write_bytes(os.urandom(128))
        (home / "key").chmod(0o600)
        for name in ("state", "spool"):
            (home / name).mkdir()
        user, host = pwd.getpwuid(os.getuid()).pw_name, socket.gethostname().split(".")[0]
        (home / "slurm.conf").write_text(CONFIGURATION.format(user=user, host=host, home=home, controller=ports[0], worker=ports[1]))
        environment = {"SLURM_CONF": str(home / "slurm.conf")}

        def start(*words):
            log = open(home / f"{words[0]}.txt", "w")
            started = subprocess.Popen(words, stdout=log, stderr=log, env={**os.environ, **environment})
            stack.callback(started.wait)
            stack.callback(started.send_signal, signal.SIGTERM)

        start("munged", "-F", f"--key-file={home}/key", f"--socket={home}/munge", f"--pid-file={home}/munged.pid",
              f"--log-file={home}/munged.log", f"--seed-file={home}/munged.seed")
        start("slurmctld", "-D", "-i")
        start("slurmd", "-D")
        for _ in range(60):
            said = subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True, env={**os.environ, **environment})
            if said.stdout.strip() == "idle":
                break
            time.sleep(0.5)
        else:
            sys.exit(f"Slurm did not start: {said.stdout}{said.stderr}\n"
                     + "\n".join(f"{f.name}: {f.read_text()[-2000:]}" for f in home.glob("*.txt")))
        yield environment


def sent_to_slurm(folder):
    with slurm_cluster() as environment:
        run(["sbatch", "--wait", f"--array=0-{SHARDS - 1}", examples / "slurm.sh", "set"], folder, **environment)


def parallel(folder):
    run(["sh", examples / "parallel.sh", "set", SHARDS], folder)


def snakemake(folder):
    run(["snakemake", "--snakefile", examples / "Snakefile", "--cores", "2", "--config", "plan=plan.toml", f"shards={SHARDS}"], folder)
    assert (folder / "archives/shard-000000.tar").is_file()


def dask(folder):
    run([DASK, examples / "with_dask.py", "set", SHARDS], folder)


# Debian's Python has the packages, another one may not
def with_packages(names):
    return next((p for p in (sys.executable, "/usr/bin/python3")
                 if subprocess.run([p, "-c", f"import {names}"], capture_output=True).returncode == 0), None)


DASK, NUMPY = with_packages("distributed"), with_packages("numpy, PIL")
ENGINES = {
    "slurm": (slurm, True, "bash"),
    "GNU parallel": (parallel, shutil.which("parallel"), "parallel"),
    "snakemake": (snakemake, shutil.which("snakemake"), "snakemake"),
    "dask": (dask, DASK, "python3-distributed"),
}
if "--cluster" in sys.argv[3:]:
    os.environ["PATH"] += ":/usr/sbin"
    if not all(shutil.which(p) for p in ("slurmctld", "slurmd", "munged")):
        print("not run, as slurm-wlm and munge are not installed")
        sys.exit(77)
    ENGINES = {"Slurm": (sent_to_slurm, True, "")}

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
    # what the page says of arrays
    block = re.search(r"(?s)<!-- run by .*?```python\n(.*?)```", (examples / "../../docs/datasets.md").read_text()).group(1)
    if NUMPY:
        run([NUMPY, "-c", block + "assert images.shape == (6, 24, 32, 3), images.shape\nassert len(places) == 6\n"], alone)
    else:
        print("the page's block: not run, as numpy or PIL is not installed")
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
