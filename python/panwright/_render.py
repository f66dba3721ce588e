"""Renderers, scenarios and commands."""

from __future__ import annotations

import itertools
import json
import os
import pathlib
import subprocess
import sys
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from types import TracebackType
from typing import Any, Union

from . import _core
from ._diagnostics import settle
from ._views import View

Path = Union[str, "os.PathLike[str]"]
Target = Union[Path, _core.Model]


def open(path: Path, *, define: Mapping[str, Any] | None = None, budget: str = "", root: Path = "", units: str = "auto", up: str = "auto",
         cache: bool = True, threads: int = 0) -> _core.Model:
    """Opens a file as a model: .pan is checked; .pxn and CAD files are read, cleaned and compiled in memory.

    define: values in place of those of <param>.  budget: in place of the model's, as "tolerance=0.001 m".
    root: folder that files named by the model may not leave; by default the model's.
    units, up: of a CAD file, as of `panwright import`.
    cache: keeps long work in the user's cache folder.  threads: 0 for all cores.
    Raises Error; warns with PanwrightWarning.
    """
    values = {name: value if isinstance(value, str) else repr(value) for name, value in (define or {}).items()}
    return _core.open_model(os.fspath(path), values, budget, os.fspath(root), units, up, cache, threads)


def record(image: _core.Image) -> dict[str, Any]:
    """Returns the record of an image's making: program, models, all settings, names of ids."""
    return dict(json.loads(image._record()))


def material(name: str, file: Path = "") -> _core.Material:
    """Returns a material of the library, or of a file of materials. `brdf()` evaluates it on arrays."""
    return _core.Material(name, os.fspath(file))


def sheet(preset: str, width: float, height: float, *, cells: int = 0, seed: int = 0, threads: int = 0) -> _core.Sheet:
    """Makes a sheet of foil from a preset: crinkled, smooth, quilted, embossed or taped.

    width, height: metres.  cells: across the width; 0: as the preset needs.
    """
    return _core.Sheet(preset, width, height, cells, seed, threads)


def _plain(value: Any) -> Any:
    """Numbers and arrays of NumPy, and paths, as JSON takes them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a setting is a {type(value).__name__}, expected numbers, text or lists of these")


def _text(settings: Mapping[str, Any]) -> str:
    return json.dumps(settings, default=_plain)


def _named(targets: Any) -> list[tuple[str, Target]]:
    if targets is None:
        return []
    if isinstance(targets, Mapping):
        return list(targets.items())
    name = targets.name if isinstance(targets, _core.Model) else os.fspath(targets)
    return [(pathlib.Path(name).stem, targets)]


class Renderer:
    """Draws images of one or more targets. Models and the OpenGL context are kept from call to call.

    targets: a model or file; or these by name; None: the sky alone.
    gl: "auto" (a GPU, else the processor), "egl" or "osmesa" (the processor: the same bits everywhere).
    settings: of every image, members of a view.
    Images are drawn on a thread of the renderer's own, without the GIL; any thread may call it.
    After a fork it can no longer be used: start processes by "spawn".
    """

    def __init__(self, targets: Target | Mapping[str, Target] | None = None, *, gl: str = "auto", threads: int = 0, **settings: Any):
        models = [(name, each if isinstance(each, _core.Model) else open(each, threads=threads)) for name, each in _named(targets)]
        self._settings = settings
        self._threads = threads
        self._pid = os.getpid()
        self._worker = _core.Worker(models, gl)
        if settings:
            _core.view(_text(settings), 0, False)

    @property
    def targets(self) -> list[str]:
        """Names of the targets, in the order of ids: the first is 1 in `target_id`."""
        return self._worker.targets

    @property
    def info(self) -> dict[str, Any]:
        """OpenGL in use: renderer, version, hardware; empty before the first image, and of terrain alone."""
        return self._worker.info

    def render(self, view: View | None = None, /, *, labels: bool = False, **settings: Any) -> _core.Image:
        """Draws one image.

        view, settings: members of a view (docs/views.md), as camera=[0, -9, 3], size="640x480".
        labels: also masks, boxes and keypoints, in Image.things.
        Returns the image with radiance, coverage and, unless `layers` leaves them out, depth, range,
        normal, target_id, node_id and material_id.
        Raises Error; warns with PanwrightWarning.
        """
        image, = self.frames([dict(view or {}, **settings)], labels=labels)
        return image

    def frames(self, views: Iterable[Mapping[str, Any]] | Scenario, *, labels: bool = False, flow: bool = False,
               ahead: int = 4) -> Iterator[_core.Image]:
        """Draws images, one after the other; the next ones while the caller works on one.

        views: as of render(); or a scenario, whose targets the renderer has.
        flow: also labels with the motion to the next and the previous frame of a scenario.
        ahead: images of a batch, two of which are under way; memory grows with it.
        """
        if ahead < 1:
            raise ValueError(f"ahead is {ahead}, expected at least 1")
        if flow and not isinstance(views, Scenario):
            raise TypeError("flow is of the frames of a Scenario")
        made = views._views(self._worker, labels, flow) if isinstance(views, Scenario) else (
            _core.view(_text({**self._settings, **view}), index, labels) for index, view in enumerate(views))
        return self._drawn(made, ahead)

    def _drawn(self, views: Iterator[Any], ahead: int) -> Iterator[_core.Image]:
        batches: deque[_core.Batch] = deque()
        begun = 0
        try:
            while True:
                while len(batches) < 2 and (some := list(itertools.islice(views, ahead))):
                    batches.append(self._begun(some, begun))
                    begun += len(some)
                if not batches:
                    return
                while (image := batches[0].next()) is not None:
                    yield image
                batches.popleft()
        finally:
            for batch in batches:
                batch.cancel()

    def _begun(self, views: list[Any], first: int) -> _core.Batch:
        if os.getpid() != self._pid:
            raise ValueError("the renderer was made before a fork: make one in each process, started by the method 'spawn'")
        return self._worker.begin(views, first, self._threads)

    def close(self) -> None:
        """Ends what is under way and frees the OpenGL context. Images stay."""
        if os.getpid() == self._pid:
            self._worker.close()

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


class Scenario:
    """Frames over time from a scenario (.toml) or a trajectory file (docs/scenarios.md).

    target: owner of a trajectory file that is opened alone; by default the camera.
    settings: members of a view, in place of the scenario's.
    """

    def __init__(self, path: Path, *, target: str = "", strict: bool = False, every: float | None = None, **settings: Any):
        self._scenario = _core.Scenario(os.fspath(path), target, strict, _text(settings))
        self.times: list[float] = self._scenario.times if every is None else self._scenario.times_every(every)

    @property
    def targets(self) -> dict[str, str]:
        """Files of its targets, by name."""
        return dict(self._scenario.targets)

    def __len__(self) -> int:
        return len(self.times)

    def _views(self, worker: _core.Worker, labels: bool, flow: bool) -> Iterator[Any]:
        neighbours = [None, *self.times, None]
        return (self._scenario.view((time, neighbours[number], neighbours[number + 2]), number, labels, flow, worker)
                for number, time in enumerate(self.times))


def frames(scenario: Path | Scenario, *, labels: bool = False, flow: bool = False, gl: str = "auto", ahead: int = 4, threads: int = 0,
           **settings: Any) -> Iterator[_core.Image]:
    """Draws the frames of a scenario: `for image in panwright.frames("rendezvous.toml", every=10, labels=True)`.

    settings: as of Scenario.  Image.number, time and name tell which frame it is.
    """
    if not isinstance(scenario, Scenario):
        scenario = Scenario(scenario, **settings)
    elif settings:
        raise TypeError("settings belong to the Scenario: " + ", ".join(settings))
    with Renderer(scenario.targets, gl=gl, threads=threads) as renderer:
        yield from renderer.frames(scenario, labels=labels, flow=flow, ahead=ahead)


def command(*arguments: Any) -> dict[str, Any]:
    """Runs a command of the program, as command("info", "client.pan"), and returns its JSON.

    Raises Error with its diagnostics.
    """
    words = [os.fspath(each) if isinstance(each, os.PathLike) else str(each) for each in arguments]
    folder = str(pathlib.Path(__file__).resolve().parent.parent)
    paths = os.pathsep.join(filter(None, [folder, os.environ.get("PYTHONPATH", "")]))
    done = subprocess.run([sys.executable, "-m", "panwright", *words, "--json"], capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": paths})
    result: dict[str, Any] = json.loads(done.stdout) if done.stdout.startswith("{") else {}
    if done.returncode != 0:
        shown = {"errors": 1, "diagnostics": result.get("diagnostics", [])}
        text = "\n".join(each["message"] for each in shown["diagnostics"]) or done.stderr
        settle(json.dumps(shown), text, done.returncode)
    return result
