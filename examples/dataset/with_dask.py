"""A data set on the workers of Dask: with_dask.py SET SHARDS [SCHEDULER]"""
import subprocess
import sys

from dask.distributed import Client


def shard(folder, index, count):
    words = ["panwright", "dataset", "run", folder, "--threads", "1", "--shard", f"{index}/{count}"]
    return subprocess.run(words, check=True).returncode


if __name__ == "__main__":
    folder, count = sys.argv[1], int(sys.argv[2])
    client = Client(sys.argv[3]) if len(sys.argv) > 3 else Client(n_workers=2, threads_per_worker=1)
    client.gather(client.map(shard, [folder] * count, range(count), [count] * count, pure=False))
