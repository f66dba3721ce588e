"""Look-ups, LiDARs and RADARs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._render import Path, Target, _named, _text, open


def _models(targets: Target | Mapping[str, Target], threads: int) -> list[tuple[str, _core.Model]]:
    return [(name, each if isinstance(each, _core.Model) else open(each, threads=threads)) for name, each in _named(targets)]


class Lookups:
    """Answers questions of geometry about one or more targets, in double precision, many at once.

    targets: a model or file; or these by name.
    settings: members of a view that place targets, joints and the camera, as camera=[0, -9, 3], fov=40.

    Coordinates are metres in world axes. Surfaces come as a dictionary of arrays with a row a question:
    distance (inf: nothing found), position, in_model (in the target's axes), facet and normal (unit),
    target_id, node_id, material_id, instance_id (index + 1; 0: nothing found).
    """

    def __init__(self, targets: Target | Mapping[str, Target], *, threads: int = 0, **settings: Any):
        self._settings = settings
        self._lookups = _core.Lookups(_models(targets, threads), _core.view(_text(settings), 0, False), threads)

    def update(self, **settings: Any) -> None:
        """Moves targets, joints and the camera: settings in place of those given before."""
        self._settings = {**self._settings, **settings}
        self._lookups.update(_core.view(_text(self._settings), 0, False))

    def pixels(self, places: ArrayLike) -> dict[str, NDArray[Any]]:
        """Surfaces at places of the image: (N, 2) columns and rows; pixel (i, j) covers [i, i+1) x [j, j+1)."""
        return self._lookups.pixels(np.asarray(places, float))

    def rays(self, origins: ArrayLike, directions: ArrayLike) -> dict[str, NDArray[Any]]:
        """Nearest surfaces to rays: (N, 3) origins and directions of any length."""
        return self._lookups.rays(np.asarray(origins, float), np.asarray(directions, float))

    def sights(self, start: ArrayLike, end: ArrayLike, *, slack: float = 1e-4) -> NDArray[np.bool_]:
        """Whether nothing stands between points (N, 3). slack: metres at both ends where surfaces do not count."""
        return self._lookups.sights(np.asarray(start, float), np.asarray(end, float), slack)

    def elevations(self, places: ArrayLike) -> dict[str, NDArray[Any]]:
        """Highest surfaces at places (N, 2), along the world's z axis."""
        return self._lookups.elevations(np.asarray(places, float))

    def nearest(self, points: ArrayLike) -> dict[str, NDArray[Any]]:
        """Points of surfaces that are nearest to points (N, 3)."""
        return self._lookups.nearest(np.asarray(points, float))

    def keypoints(self, *, slack: float = 1e-4) -> dict[str, list[_core.Keypoint]]:
        """Keypoints of each target in the camera's view. slack: metres beside them where surfaces do not count."""
        return self._lookups.keypoints(slack)


def lidar(targets: Target | Mapping[str, Target], file: Path, *, frame: str = "instrument", ideal: bool = False, threads: int = 0,
          **settings: Any) -> dict[str, NDArray[Any]]:
    """Measures targets with a LiDAR (docs/lidar.md), whose axes are those of the view's camera.

    frame: axes of the positions: "instrument", "world", or a target's name.
    ideal: ranges of the axes of the pulses alone, without receiver and noise.
    settings: members of a view; noise_seed and frame_number choose the noise.
    Returns the arrays of a .npz file. Raises Error.
    """
    return _core.lidar(_models(targets, threads), _core.view(_text(settings), 0, False), os.fspath(file), frame, ideal, threads)


def radar(targets: Target | Mapping[str, Target], file: Path, *, begin: Mapping[str, Any] | None = None,
          end: Mapping[str, Any] | None = None, ideal: bool = False, threads: int = 0, **settings: Any) -> dict[str, Any]:
    """Measures targets with a RADAR (docs/radar.md), whose axes are those of the view's camera.

    settings: members of a view in the middle of the dwell; noise_seed and frame_number choose the noise.
    begin, end: members that differ at the begin and the end of the dwell, from which speeds follow; neither: nothing moves.
    ideal: the mean power, without speckle and noise.
    Returns power_w, mean_power_w, azimuth_rad and elevation_rad (speeds, ranges), range_m and speed_m_s (of the cells'
    centres), response_sum, noise_w (mean of a cell), gain, echo_power_w (of all echoes), outside (their share outside of
    the histogram), targets (by name: cross_section_m2, range_m, speed_m_s; NaN: no echo), altitude_m (None: not found, or
    no altimeter). Raises Error; ValueError for one of begin and end.
    """
    if (begin is None) != (end is None):
        raise ValueError("begin and end of the dwell come together")

    def view(more: Mapping[str, Any]) -> _core.View:
        return _core.view(_text({**settings, **more}), 0, False)

    motion = None if begin is None or end is None else (view(begin), view(end))
    return _core.radar(_models(targets, threads), view({}), motion, os.fspath(file), ideal, threads)
