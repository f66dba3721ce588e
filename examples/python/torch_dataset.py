"""Frames with labels as a data set of PyTorch, where that is installed."""
import pathlib

import panwright as pw

try:
    from torch.utils.data import DataLoader, IterableDataset
except ImportError:
    IterableDataset, DataLoader = object, None

scenario = pathlib.Path(__file__).resolve().parent.parent / "rendezvous/rendezvous.toml"


class Frames(IterableDataset):
    def __iter__(self):
        for image in pw.frames(scenario, every=200, size=64, labels=True, samples=1):
            yield image["radiance"].transpose(2, 0, 1), image.things[0].camera_from_thing


if __name__ == "__main__":
    batches = DataLoader(Frames(), batch_size=2, num_workers=0) if DataLoader else Frames()
    for radiance, pose in batches:
        print(tuple(radiance.shape), tuple(pose.shape))
