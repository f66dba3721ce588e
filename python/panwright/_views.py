"""Members of a view. Made by schemas/generate_views.py from schemas/views.toml."""

from __future__ import annotations

from typing import Literal, Mapping, Sequence, TypedDict


class View(TypedDict, total=False):
    """One image: docs/views.md. Angles are degrees, lengths metres."""

    name: str  # Name of the view in diagnostics and replies, beside its number (from 0).
    size: str | float | Sequence[float]  # Pixels: `"640x480"`, `[640, 480]`, or one number for a square (1024).
    ev: float | str  # Exposure of a PNG, stops (0); `"auto"`: from the image.
    tone: Literal["linear", "photo"]  # Tone curve of a PNG: linear, clipped at white; or compressed highlights that keep their hue, as in a photograph.
    layers: Sequence[str] | str  # Layers of `.exr` and `.npz` (all): radiance, coverage, depth, range, normal, target_id, node_id, material_id, standard_error; of a detector dn, electrons and, only if named, stages.
    compress: bool  # Compress the layers of `.npz`.
    camera: Sequence[float] | str  # Camera position: metres, world axes.
    look_at: Sequence[float] | str  # Point on the boresight (the origin).
    up: Sequence[float] | str  # Up direction of the image (`0 0 1`).
    quat: Sequence[float] | str  # The attitude world_from_camera, `w x y z`, instead of `look-at`; x right, y down, z along the boresight.
    camera_frame: str  # A frame of a target that holds the camera: `"TARGET/FRAME"`, or `"FRAME"` where one target has it.
    fov: float | str  # Full horizontal field of view; a bare number is degrees.
    ifov: float | str  # Angle of the pixel on the axis.
    intrinsics: Sequence[float] | str  # Focal lengths and principal point, pixels: `fx fy cx cy`.
    distortion: str  # Distortion with `intrinsics`, a model and its numbers ([cameras](cameras.md)).
    camera_file: str  # File of the camera's size and lens ([cameras](cameras.md)).
    mount: Sequence[float] | str  # Misalignment of the camera, as in a camera file: rotates its axes into those of the attitude, `w x y z` ([cameras](cameras.md)).
    ortho: float | str  # An orthographic image of this width, metres.
    exposure: float | str  # Exposure time in seconds: of scenarios, around the time of the frame (0: an instant) ([exposures](exposures.md)); of detectors (0: their own; `auto`: by the image).
    detector: str  # Optics and detector: the tables of a camera file as text ([detectors](detector.md)).
    gain: float | str  # Gain of a detector, numbers per electron (that of its camera file).
    temperature: float | str  # Temperature of a detector in kelvin, which its dark current follows (that of its camera file).
    noise_seed: float | str  # Seed of the noise of a detector (0).
    frame_number: float | str  # Number of the frame, which has a noise of its own (0; of scenarios that of each frame).
    line_time: float | str  # Of scenarios: rolling shutter, seconds from the exposure of a row to that of the row below it; negative: above it (0: all at once).
    tdi: float | str  # Of scenarios: line scanner of N stages, which expose each row of the image, `line-time` apart (1: push-broom; 0: none).
    pose: Sequence[float] | str | Mapping[str, Sequence[float] | str]  # world_from_model: metres and a unit quaternion, `x y z qw qx qy qz`; of several targets an object by name.
    joint: Mapping[str, float | Sequence[float] | str]  # Values of joints by name, of several targets as `NAME/JOINT`: a bare number is degrees or metres, joints of several values take a list. `@sun`, `@camera`, `@NAME` or `@X Y Z` aim the joint's pointing direction. docs/articulation.md.
    define: Mapping[str, str | float]  # Values of `<param>`s of the model, as `-D` gives them. The model is compiled for each set of values; the last four sets are kept.
    sun: Sequence[float] | str  # Direction to the Sun, world axes (from behind the camera's left shoulder).
    sun_distance: float | str  # Distance to the Sun, AU (1).
    sun_irradiance: float | Sequence[float] | str  # In-band irradiance at the target, with `orbit` at 1 AU, W/m²: radiance is then W/(m² sr).
    lamp: Sequence[str]  # Lights beside the Sun, each as `spot on camera at 0.3 0 0 intensity 100 half-angle 20deg`; or changes of those of models, as `* off`. docs/lamps.md.
    white: float | Sequence[float] | str  # Irradiance E0 of emission 1, whose radiance is E0/π, whatever the Sun's (1; with `sun-irradiance` 158.6 186.2 191.4).
    limb_darkening: float | str  # Coefficient u of I = 1 − u (1 − cos) over the Sun's disc (0).
    planet: Mapping[str, str | Sequence[float]]  # Bodies of the sky by name: `earth`, `moon`, or others with `radius=`. Their centre (of `earth` and `moon` by `date` and `orbit`), then if need be a quaternion, `radius=`, `albedo=`, `law=`, `air=`, and last `map=FILE`, `clouds=FILE`, `night=FILE`. docs/sky.md.
    sky: str  # What stands in the background: any of `stars` (to V 8), `sun` (its disc), and by `date` and `orbit` `earth` and `moon`. docs/sky-by-date.md.
    stars: float | str  # Stars in the background, down to this magnitude V (off; Hipparcos reaches 8). World axes are those of J2000, or of `orbit`. docs/stars.md.
    star_catalogue: str  # Star catalogue in place of Hipparcos ([columns](stars.md)).
    date: str  # Date of the image, UTC: stars move, and with `orbit` the Earth, the Moon and the Sun (frames of scenarios with an epoch have their own).
    orbit: str  # Orbit of the origin at `date`: elements (degrees) or a state `r=X Y Z v=VX VY VZ`, then any of `about=moon`, `epoch=UTC`, `axes=rtn`; or `earth` or `moon`, whose centre is the origin. docs/sky-by-date.md.
    engine: Literal["gl", "reference"]  # OpenGL (`gl`), or path tracing with error bars (`reference`).
    quality: Literal["draft", "standard", "exact"]  # gl: preset of samples, shadows and imposters; options that are given replace its parts (docs/sampling.md).
    samples: float | str  # N × N samples in each pixel, or `"auto"` (gl; the default). Reference: 8.
    pixel_error: float | str  # gl, with `samples` auto: target error (5 %).
    adaptive: bool  # gl, with `samples` N: N × N samples only where they change the pixel.
    flat: bool  # Shade with the triangles' own normals.
    specular_filter: Literal["auto", "off"]  # gl, with `samples` N: filter of narrow highlights on curved surfaces, auto (averaged between samples that are too far apart) or off (docs/sampling.md).
    shadows: Literal["auto", "off", "hard", "soft"]  # gl: auto (penumbrae where visible, with `samples` auto), hard (the Sun's centre), soft (`sun-points` of its disc) or off.
    sun_points: float | str  # gl: number of points of the Sun's disc that cast shadows (64; with `shadows` auto the largest number).
    shadow_side: float | str  # gl: shadow map resolution, texels (2048; with `samples` auto 2896; imposters: five times their texels).
    indirect: Literal["off", "auto", "on"]  # gl: light that surfaces send one another, eight bounces, the first one glossy: off, on, or auto (on where it changes the image by more than `pixel-error`) ([light between surfaces](light.md)); [mirrors](mirrors.md) show others too.
    levels: float | str  # gl: level of detail: auto (pixel footprint), off (finest), or a footprint in metres.
    imposters: float | str  # gl: small targets drawn separately, finer than pixels (docs/imposters.md): auto (up to 100 pixels, 511 where accurate, with `samples` auto), off, always, or largest size.
    flux_error: float | str  # gl: target error of an imposter's flux (0.05 % up to 100 pixels; larger targets: as `pixel-error`).
    psf: float | str  # Gaussian point spread function of the camera: RMS width in pixels (0: none).
    until_error: float | str  # Reference: largest relative error of the flux; samples are added until it is reached.
    max_samples: float | str  # Reference, with `until-error`: limit of samples per pixel (67108864).
    bounces: float | str  # Reference: number of interreflections (3).
    seed: float | str  # Reference: seed of the random numbers (0).
    no_sun_disc: bool  # Reference: treats the Sun as a point.
    max_image_memory: float | str  # Limit of memory for the image (12GB).
