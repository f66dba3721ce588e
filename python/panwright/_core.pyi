"""The compiled part. Arrays are NumPy's; H and W are the height and width of an image in pixels."""

from os import PathLike
from typing import Any, Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

version: str

class Joint:
    """A joint of a model. Angles are radians, lengths metres."""

    @property
    def name(self) -> str: ...
    @property
    def kind(self) -> str: ...  # "revolute", "continuous", "prismatic", "ball", "general", "scale", "fixed"
    @property
    def value(self) -> list[float]: ...  # as the model has it
    @property
    def lower(self) -> list[float]: ...  # empty: no limits
    @property
    def upper(self) -> list[float]: ...

class Model:
    """A model, compiled and checked. It never changes; renderers and threads share it."""

    @property
    def path(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def build_id(self) -> str:
        """Hash of the content, hexadecimal."""
    @property
    def nodes(self) -> list[str]:
        """Paths of the nodes; `node_id` of an image is the index + 1."""
    @property
    def materials(self) -> list[str]:
        """Names; `material_id` of an image is the index + 1."""
    @property
    def joints(self) -> list[Joint]: ...
    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """(2, 3) metres, the least and the largest corner in the model's axes. None: without meshes."""
    def mesh(self) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
        """Vertices (V, 3), metres in the model's axes, and triangles (T, 3), of the finest meshes as the joints stand."""
    def save(self, path: str | PathLike[str]) -> None:
        """Writes a .pan file, atomically. Raises Error."""

class Keypoint:
    """A named point of a target in an image."""

    @property
    def name(self) -> str: ...
    @property
    def truncated(self) -> bool: ...  # outside the image
    @property
    def occluded(self) -> bool: ...  # hidden from the camera
    @property
    def lit(self) -> bool: ...  # by the Sun
    @property
    def position(self) -> tuple[float, float, float]:
        """Metres, in the target's axes."""
    @property
    def in_camera(self) -> tuple[float, float, float]:
        """Metres: right, down, along the boresight."""
    @property
    def pixel(self) -> tuple[float, float] | None:
        """Column, row; None: behind the camera, or outside its lens."""

class Thing:
    """A target, or a part of one, in an image."""

    @property
    def id(self) -> int: ...
    @property
    def target(self) -> str: ...
    @property
    def label(self) -> str:
        """Of a part; empty: the whole target."""
    @property
    def camera_from_thing(self) -> NDArray[np.float64]:
        """(4, 4) rigid transform."""
    @property
    def visible(self) -> NDArray[np.uint8]:
        """(H, W) share of each pixel, 255 for all, as the image shows it."""
    @property
    def amodal(self) -> NDArray[np.uint8]:
        """(H, W) the same as if nothing stood in front."""
    @property
    def visible_box(self) -> tuple[float, float, float, float] | None:
        """Left, top, right, bottom, pixels; None: not visible."""
    @property
    def amodal_box(self) -> tuple[float, float, float, float] | None:
        """The same of all of it, beyond the image's edges too."""
    @property
    def visible_pixels(self) -> float: ...
    @property
    def amodal_pixels(self) -> float: ...
    @property
    def keypoints(self) -> list[Keypoint]: ...

class Image:
    """An image and its ground truth. image["depth"] is a layer: an array of the image's memory, not a copy.

    radiance (H, W, 3) float32 in `unit`; coverage (H, W) float32, 0 to 1; depth and range (H, W) float32,
    metres, background infinite; normal (H, W, 3) float32, world axes; target_id, node_id and material_id
    (H, W) uint32, background 0; standard_error (H, W, 3) float32, of the reference renderer. Of a
    detector also dn (H, W) uint16, and electrons (H, W) float32.
    """

    @property
    def name(self) -> str: ...
    @property
    def number(self) -> int: ...  # of the frame, from 0
    @property
    def time(self) -> float: ...  # seconds, of a scenario
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def unit(self) -> str:
        """Of radiance: "1/sr" or "W/(m^2 sr)"."""
    @property
    def ev(self) -> float:
        """Exposure of its PNG, stops."""
    @property
    def targets(self) -> list[str]: ...
    @property
    def error(self) -> float | None:
        """Estimated RMS error of lit pixels, a share of their radiance. None: of the reference renderer."""
    @property
    def camera_matrix(self) -> NDArray[np.float64]:
        """(3, 3) pinhole part: focal lengths and principal point, pixels."""
    @property
    def world_from_camera(self) -> NDArray[np.float64]:
        """(4, 4) rigid transform; camera axes: right, down, along the boresight."""
    @property
    def things(self) -> list[Thing]:
        """Labels, of an image drawn with labels=True; ValueError of another."""
    @property
    def forward_flow(self) -> NDArray[np.float32] | None:
        """(H, W, 2) motion right and down to the next frame, pixels; NaN: background. None: not drawn with flow=True, or the last frame."""
    @property
    def backward_flow(self) -> NDArray[np.float32] | None:
        """(H, W, 2) the same to the frame before. None also: the first frame."""
    def srgb(self, ev: float | None = None, photo: bool | None = None) -> NDArray[np.uint8]:
        """(H, W, 3) codes of a PNG. ev: stops, in place of the view's. photo: tone curve, in place of the view's."""
    def save(self, path: str | PathLike[str]) -> None:
        """Writes .png, .exr, .npy or .npz, as `panwright render` does. Raises Error."""
    def keys(self) -> list[str]:
        """Names of the layers that it has."""
    def _record(self) -> str: ...
    def __getitem__(self, name: str) -> NDArray[Any]: ...
    def __contains__(self, name: str) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...

class Camera:
    """A camera file: .toml, or one of OpenCV, ROS, Kalibr or SPEED (docs/cameras.md)."""

    def __init__(self, path: str | PathLike[str]) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def matrix(self) -> NDArray[np.float64]:
        """(3, 3) focal lengths and principal point, pixels."""
    @property
    def distortion(self) -> str:
        """Model and numbers; empty: none."""
    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Pixels (N, 2) of points (N, 3), metres in camera axes. NaN: behind the camera, or outside its lens."""
    def rays(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Unit directions (N, 3) of pixels (N, 2), camera axes. NaN: outside its lens."""

class Material:
    """A material of one reflectance."""

    def __init__(self, name: str, file: str) -> None: ...
    @property
    def name(self) -> str: ...
    def brdf(self, to_light: ArrayLike, to_viewer: ArrayLike, normal: ArrayLike = ...) -> NDArray[np.float64]:
        """BRDF (N, 3), 1/sr, RGB, of directions (N, 3) or (3,); those away from the surface. Double precision."""

class Sheet:
    """A sheet of foil."""

    def __init__(self, preset: str, width: float, height: float, cells: int, seed: int, threads: int) -> None: ...
    @property
    def heights(self) -> NDArray[np.float64]:
        """(rows, columns) metres; row 0 is the lower edge."""
    @property
    def spacing(self) -> tuple[float, float]:
        """Metres between columns and rows."""
    @property
    def height_rms(self) -> float: ...
    @property
    def slope_rms(self) -> float: ...

class View: ...

class Batch:
    def next(self) -> Image | None: ...
    def cancel(self) -> None: ...

class Worker:
    @property
    def closed(self) -> bool: ...
    @property
    def info(self) -> dict[str, Any]: ...
    @property
    def targets(self) -> list[str]: ...
    def __init__(self, targets: list[tuple[str, Model]], gl: str) -> None: ...
    def begin(self, views: list[View], first: int, threads: int) -> Batch: ...
    def close(self) -> None: ...

class Scenario:
    @property
    def times(self) -> list[float]: ...
    @property
    def targets(self) -> list[tuple[str, str]]: ...
    def __init__(self, path: str, target: str, strict: bool, settings: str) -> None: ...
    def times_every(self, seconds: float) -> list[float]: ...
    def view(self, times: tuple[float, float | None, float | None], number: int, labels: bool, flow: bool, worker: Worker) -> View: ...

class Lookups:
    def __init__(self, targets: list[tuple[str, Model]], view: View, threads: int) -> None: ...
    def update(self, view: View) -> None: ...
    def rays(self, origins: NDArray[np.float64], directions: NDArray[np.float64]) -> dict[str, NDArray[Any]]: ...
    def pixels(self, places: NDArray[np.float64]) -> dict[str, NDArray[Any]]: ...
    def elevations(self, places: NDArray[np.float64]) -> dict[str, NDArray[Any]]: ...
    def nearest(self, points: NDArray[np.float64]) -> dict[str, NDArray[Any]]: ...
    def sights(self, start: NDArray[np.float64], end: NDArray[np.float64], slack: float) -> NDArray[np.bool_]: ...
    def keypoints(self, slack: float) -> dict[str, list[Keypoint]]: ...

def lidar(targets: list[tuple[str, Model]], view: View, file: str, frame: str, ideal: bool, threads: int) -> dict[str, NDArray[Any]]: ...
def radar(targets: list[tuple[str, Model]], view: View, motion: tuple[View, View] | None, file: str, ideal: bool,
          threads: int) -> dict[str, Any]: ...
def open_model(path: str, define: dict[str, str], budget: str, root: str, units: str, up: str, cache: bool, threads: int) -> Model: ...
def view(text: str, index: int, labels: bool) -> View: ...
def material_names() -> list[str]:
    """Returns the names of the library's materials."""

def run_command(arguments: list[str]) -> int: ...
