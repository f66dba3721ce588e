"""The Python module against the program, and its errors.

    module_test.py PANWRIGHT EXAMPLES        PYTHONPATH names the module's folder
"""
import array
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import panwright as pw

PROGRAM, EXAMPLES = sys.argv[1], pathlib.Path(sys.argv[2])
CLIENT, CUBESAT = EXAMPLES / "client/client.pxn", EXAMPLES / "cubesat/cubesat.pxn"
VIEWS = [
    {"camera": [6, -9, 3], "sun": [1, -1, 0.5], "size": "96x64"},
    {"camera": [0, -40, 3], "fov": 1.5, "samples": 2, "size": [48, 48]},
    {"camera": [5, 5, 5], "sun": [-1, 0, 0.2], "engine": "reference", "samples": 2, "bounces": 0, "size": 32},
]


def run(*words):
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True)


class Instruments(unittest.TestCase):
    """Look-ups against ground truth of an image, clouds against the program's files."""

    def test_lookups_are_the_truth_of_an_image(self):
        view = {"camera": [6, -9, 3], "size": "64x48", "fov": 30}
        with pw.Renderer(CLIENT, gl="osmesa") as renderer:
            image = renderer.render(engine="reference", samples=1, labels=True, **view)
        rows, columns = np.mgrid[0:48, 0:64] + 0.5
        lookups = pw.Lookups(CLIENT, **view)
        found = lookups.pixels(np.stack([columns.ravel(), rows.ravel()], axis=1))
        for name in ("target_id", "node_id", "material_id"):
            np.testing.assert_array_equal(found[name].reshape(48, 64), image[name], name)
        seen = found["target_id"] > 0
        self.assertGreater(seen.sum(), 100)
        np.testing.assert_allclose(found["distance"][seen], image["range"].ravel()[seen], rtol=1e-6)
        back = lookups.rays(np.tile([6.0, -9, 3], (seen.sum(), 1)), found["position"][seen] - [6, -9, 3])
        np.testing.assert_allclose(back["distance"], found["distance"][seen], rtol=1e-9)
        self.assertTrue(np.isnan(found["position"][~seen]).all())
        expected = {each.name: (each.pixel, each.occluded, each.lit) for each in image.things[0].keypoints}
        points = lookups.keypoints()["client"]
        self.assertEqual({each.name: (each.pixel, each.occluded, each.lit) for each in points}, expected)
        near = lookups.nearest([[9, 0, 0], [0, 0, 9]])
        self.assertEqual(near["distance"].shape, (2,))
        self.assertEqual(lookups.sights([[9, 0, 0], [9, 9, 9]], [[-9, 0, 0], [9, 9, 8]]).tolist(), [False, True])
        self.assertEqual(lookups.elevations([[50, 50]])["target_id"].tolist(), [0])
        with self.assertRaises(ValueError):
            lookups.nearest([[1, 2]])
        lookups.update(camera=[0, -20, 0])
        self.assertGreater(lookups.pixels([[32, 24]])["distance"][0], 15)

    def test_lidar_is_the_program_s(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.npz"
            lidar = EXAMPLES / "lidar/flash_rvd.toml"
            run("lidar", CLIENT, "--lidar", lidar, "--camera", "6 -9 3", "--noise-seed", "3", "-o", file)
            cloud = pw.lidar(CLIENT, lidar, camera=[6, -9, 3], noise_seed=3)
            with np.load(file) as arrays:
                self.assertEqual(sorted(arrays.files), sorted(cloud))
                for name in arrays.files:
                    np.testing.assert_array_equal(arrays[name], cloud[name], name)
        with self.assertRaises(pw.Error):
            pw.lidar(CLIENT, "none.toml")

    def test_radar_is_the_program_s(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.npz"
            radar = EXAMPLES / "radar/docking_x_band.toml"
            run("radar", CLIENT, "--radar", radar, "--camera", "6 -9 3", "--noise-seed", "3", "-o", file)
            echoes = pw.radar(CLIENT, radar, camera=[6, -9, 3], noise_seed=3)
            with np.load(file) as arrays:
                record = json.loads(arrays["record"].tobytes())
                for name in set(arrays.files) - {"record", "response_sum"}:
                    np.testing.assert_array_equal(arrays[name], echoes[name], name)
                self.assertEqual(arrays["response_sum"], echoes["response_sum"])
        for name in ("noise_w", "gain", "echo_power_w", "outside"):
            self.assertEqual(record[name], echoes[name])
        target = echoes["targets"]["client"]
        self.assertEqual([{"name": "client"} | target], record["targets"])
        self.assertIsNone(echoes["altitude_m"])
        self.assertEqual(target["speed_m_s"], 0)
        # the instrument comes nearer by 0.16 m in the dwell of 0.08 s
        unit = np.array([6, -9, 3]) / 126 ** 0.5
        place = lambda metres: {"camera": list(np.array([6, -9, 3]) + metres * unit)}
        moved = pw.radar(CLIENT, radar, begin=place(0.08), end=place(-0.08), camera=[6, -9, 3], ideal=True)
        self.assertAlmostEqual(moved["targets"]["client"]["speed_m_s"], -2, delta=0.1)
        with self.assertRaises(ValueError):
            pw.radar(CLIENT, radar, begin={"camera": [0, 0, 9]})
        with self.assertRaises(pw.Error):
            pw.radar(CLIENT, "none.toml")


class AgainstTheProgram(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        cls.model = pw.open(CUBESAT)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def assert_equal(self, image, file):
        with np.load(file) as arrays:
            names = [name for name in arrays.files if name != "meta.json"]
            self.assertEqual(sorted(names), sorted(image.keys()))
            for name in names:
                self.assertEqual(arrays[name].dtype, image[name].dtype, name)
                np.testing.assert_array_equal(arrays[name], image[name], name)

    def test_pixels(self):
        views = [{**view, "output": str(self.path / f"{k}.npz")} for k, view in enumerate(VIEWS)]
        (self.path / "views.json").write_text(json.dumps(views))
        run("render", CUBESAT, "--views", self.path / "views.json", "--gl", "osmesa")
        with pw.Renderer(self.model, gl="osmesa") as renderer:
            images = list(renderer.frames(VIEWS, ahead=1))
            together = list(renderer.frames(VIEWS))
        for k, (image, other) in enumerate(zip(images, together)):
            self.assertEqual(image.number, k)
            self.assert_equal(image, views[k]["output"])
            self.assert_equal(other, views[k]["output"])

    def test_saved_files_are_the_program_s(self):
        view = {**VIEWS[0], "ev": 1.5}
        run("render", CUBESAT, "-o", self.path / "a.png", "--camera", "6 -9 3", "--sun", "1 -1 0.5", "--size", "96x64", "--ev", 1.5, "--gl", "osmesa")
        with pw.Renderer(CUBESAT, gl="osmesa") as renderer:
            image = renderer.render(view)
        image.save(self.path / "b.png")
        from PIL import Image
        codes = np.asarray(Image.open(self.path / "a.png"))
        np.testing.assert_array_equal(codes, image.srgb())
        np.testing.assert_array_equal(codes, np.asarray(Image.open(self.path / "b.png")))
        darker = image.srgb(ev=0.5).astype(int)
        self.assertTrue((darker <= codes).all() and (darker < codes).any())

    def test_compiled_files_are_the_program_s(self):
        run("compile", CUBESAT, "-o", self.path / "a.pan")
        self.model.save(self.path / "b.pan")
        info = [json.loads(run("info", self.path / name, "--json").stdout) for name in ("a.pan", "b.pan")]
        self.assertEqual(info[0]["build_id"], info[1]["build_id"])
        self.assertEqual(pw.command("info", self.path / "a.pan")["build_id"], self.model.build_id)

    def test_labels_of_a_scenario(self):
        scenario = EXAMPLES / "rendezvous/rendezvous.toml"
        run("run", scenario, "-o", self.path / "frames", "--every", 300, "--samples", 1, "--labels", "--gl", "osmesa", "--type", "npz")
        seen = 0
        for image in pw.frames(scenario, every=300, samples=1, labels=True, gl="osmesa"):
            expected = json.loads((self.path / f"frames/{image.number:06}.labels.json").read_text())
            self.assert_equal(image, self.path / f"frames/{image.number:06}.npz")
            self.assertEqual(image.time, expected["time"])
            self.assertEqual(len(image.things), len(expected["things"]))
            for thing, wanted in zip(image.things, expected["things"]):
                self.assertEqual(thing.target, wanted["target"])
                box = wanted["visible_box"]
                self.assertEqual(thing.visible_box, tuple(box) if box else None)
                self.assertAlmostEqual(thing.visible.sum() / 255, thing.visible_pixels, delta=0.02 * thing.visible_pixels + 2)
                for point, told in zip(thing.keypoints, wanted["keypoints"], strict=True):
                    self.assertEqual(point.pixel, tuple(told["pixel"]) if told["pixel"] else None)
                    self.assertEqual(point.lit, told["lit"])
            seen += 1
        self.assertGreater(seen, 1)

    def test_images_without_labels_say_so(self):
        with pw.Renderer(self.model, gl="osmesa", size=8) as renderer:
            image = renderer.render(camera=[3, -4, 2], samples=1)
            with self.assertRaisesRegex(ValueError, "labels=True"):
                image.things

    def test_flow(self):
        plain = (f'begin = 0\nend = 2\nstep = 1\nlook_at = "sat"\n[targets]\nsat = "{CUBESAT.resolve()}"\n[[source]]\nfile = "way.csv"\n'
                 '[[source]]\nformula = "fixed"\nsun = [1, -1, 0.5]\n[view]\nsize = "48x32"\nfov = 20\nsamples = 1\n')
        (self.path / "way.csv").write_text("time[s],camera.x[m],camera.y[m],camera.z[m]\n0,0,-3,1\n2,0.4,-2.8,1\n")
        scenario, with_flow = self.path / "plain.toml", self.path / "flow.toml"
        scenario.write_text(plain)
        with_flow.write_text(plain + "[labels]\nflow = true\n")
        settings = {"gl": "osmesa"}
        run("run", with_flow, "-o", self.path / "flow", "--gl", "osmesa", "--type", "npz")
        self.assertIsNotNone(next(pw.frames(with_flow, **settings)).forward_flow)
        images = list(pw.frames(scenario, flow=True, **settings))
        self.assertEqual(len(images), 3)
        known = 0
        for image in images:
            for ours, name in ((image.forward_flow, "forward"), (image.backward_flow, "backward")):
                file = self.path / f"flow/{image.number:06}.{name}.flo"
                self.assertEqual(ours is None, not file.exists(), file)
                if ours is None:
                    continue
                # of Middlebury: a number, width, height, then pairs; 1e10 is unknown
                width, height = np.fromfile(file, "<i4", 2, offset=4)
                written = np.fromfile(file, "<f4", offset=12).reshape(height, width, 2)
                np.testing.assert_array_equal(np.where(np.isnan(ours), np.float32(1e10), ours), written)
                known += np.isfinite(ours).any()
        self.assertGreater(known, 0)
        self.assertIsNone(images[0].backward_flow)
        self.assertIsNone(images[-1].forward_flow)
        self.assertIsNone(next(pw.frames(scenario, labels=True, **settings)).forward_flow)
        with pw.Renderer(self.model, gl="osmesa") as renderer, self.assertRaises(TypeError):
            renderer.frames([{}], flow=True).__next__()

    def test_detector(self):
        camera = self.path / "camera.toml"
        camera.write_text("size = [64, 48]\nfocal_length_mm = 8\npixel_um = 20\n[optics]\nf_number = 4\n[detector]\nexposure_s = 1e-4\nread_noise_e = 9\n")
        words = ("--camera", "3 -4 2", "--camera-file", camera, "--sun", "1 -1 0.5", "--gl", "osmesa", "--gain", 0.2, "--temperature", 310, "--noise-seed", 4)
        run("render", CUBESAT, "-o", self.path / "dn.npz", *words)
        with pw.Renderer(self.model, gl="osmesa", camera_file=camera) as renderer:
            image = renderer.render(camera=[3, -4, 2], sun=[1, -1, 0.5], gain=0.2, temperature=310, noise_seed=4, labels=True)
            self.assert_equal(image, self.path / "dn.npz")
            self.assertEqual(image["dn"].dtype, np.uint16)
            self.assertGreater(len(image.things[0].keypoints) + image.things[0].visible_pixels, 0)
            image.save(self.path / "dn.fits")
            with self.assertRaises(pw.Error):
                renderer.render(camera=[3, -4, 2], gain=-1)

    def test_geometry(self):
        points, triangles = self.model.mesh()
        np.testing.assert_allclose([points.min(0), points.max(0)], self.model.bounds, atol=1e-12)
        self.assertLess(triangles.max(), len(points))
        with pw.Renderer(self.model, gl="osmesa", size=64) as renderer:
            image = renderer.render(camera=[3, -4, 2], look_at=[0, 0, 0])
        # a pixel's depth and normal, against the plane of the ray's own triangle is the reference's task; here: units and axes
        row, column = np.argwhere(image["target_id"] == 1)[len(np.argwhere(image["target_id"] == 1)) // 2]
        ray = np.linalg.inv(image.camera_matrix) @ [column + 0.5, row + 0.5, 1]
        self.assertAlmostEqual(float(image["range"][row, column] / image["depth"][row, column]), float(np.linalg.norm(ray)), places=5)
        place = image.world_from_camera @ np.append(ray * image["depth"][row, column], 1)
        low, high = self.model.bounds
        self.assertTrue((place[:3] > low - 1e-3).all() and (place[:3] < high + 1e-3).all())
        np.testing.assert_allclose(image.world_from_camera[:3, 3], [3, -4, 2])


class Arrays(unittest.TestCase):
    def test_memory_is_the_image_s(self):
        with pw.Renderer(CUBESAT, gl="osmesa", size=32) as renderer:
            image = renderer.render()
        depth = image["depth"]
        self.assertTrue(np.shares_memory(depth, image["depth"]))
        self.assertFalse(depth.flags.owndata)
        before = depth.copy()
        del image
        np.testing.assert_array_equal(before, depth)

    def test_brdf_of_a_lambert_surface_and_shapes(self):
        paint = pw.material("white_z93")
        one = paint.brdf([0, 0, 2.0], [0, 0, 1])
        self.assertEqual(one.shape, (3,))
        many = paint.brdf([[0, 0, 1]] * 5, [0, 0.6, 0.8], [0, 0, 1])
        self.assertEqual(many.shape, (5, 3))
        # reciprocal
        np.testing.assert_allclose(paint.brdf([0.6, 0, 0.8], [0, 0.3, 0.9]), paint.brdf([0, 0.3, 0.9], [0.6, 0, 0.8]), rtol=1e-12)
        self.assertTrue(np.isnan(paint.brdf([0, 0, 0], [0, 0, 1])).all())
        self.assertTrue(np.isnan(paint.brdf([np.nan, 0, 1], [0, 0, 1])).all())
        for wrong in ([0, 1], [[[0, 0, 1]]], 3.0):
            with self.assertRaises(ValueError):
                paint.brdf(wrong, [0, 0, 1])
        with self.assertRaises(ValueError):
            paint.brdf([[0, 0, 1]] * 2, [[0, 0, 1]] * 3)
        # float32, another order and a slice are converted, not misread
        light = np.asfortranarray(np.random.default_rng(2).uniform(0.1, 1, (8, 3)).astype(np.float32))
        expected = np.array([paint.brdf(each, [0, 0, 1]) for each in light])
        np.testing.assert_array_equal(paint.brdf(light, [0, 0, 1]), expected)
        np.testing.assert_array_equal(paint.brdf(light[::-2], [0, 0, 1]), expected[::-2])
        np.testing.assert_array_equal(paint.brdf(array.array("d", [0, 0, 1]), [0, 0, 1]), one)

    def test_cameras(self):
        camera = pw.Camera(EXAMPLES / "rendezvous/camera.toml")
        points = np.array([[0, 0, 2], [0.5, -0.25, 2], [0, 0, -1]])
        pixels = camera.project(points)
        np.testing.assert_allclose(pixels[:2], [[320, 240], [320 + 772.5 / 4, 240 - 772.5 / 8]], rtol=1e-14)
        self.assertTrue(np.isnan(pixels[2]).all())
        np.testing.assert_allclose(camera.rays([320, 240]), [0, 0, 1])

    def test_foil(self):
        sheet = pw.sheet("crinkled", 0.3, 0.2, seed=3)
        self.assertEqual(sheet.heights.ndim, 2)
        self.assertAlmostEqual(sheet.heights.std(), sheet.height_rms, places=12)
        np.testing.assert_array_equal(sheet.heights, pw.sheet("crinkled", 0.3, 0.2, seed=3, threads=1).heights)
        self.assertFalse(np.array_equal(sheet.heights, pw.sheet("crinkled", 0.3, 0.2, seed=4).heights))


class Failures(unittest.TestCase):
    def codes(self, call, *arguments, **named):
        with self.assertRaises(pw.Error) as caught:
            call(*arguments, **named)
        self.assertTrue(str(caught.exception))
        return [each.code for each in caught.exception.diagnostics if each.severity == "error"]

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            self.assertEqual(self.codes(pw.open, path / "none.pan"), ["E0101"])
            (path / "broken.pxn").write_text('<pxn version="1"><box size="1 2 x"/></pxn>')
            with self.assertRaises(pw.Error) as caught:
                pw.open(path / "broken.pxn")
            first = caught.exception.diagnostics[0]
            self.assertEqual((first.line, pathlib.Path(first.file).name), (1, "broken.pxn"))
            (path / "short.pan").write_bytes(b"PANWRIGH" + bytes(20))
            self.assertNotEqual(self.codes(pw.open, path / "short.pan"), [])
            self.assertEqual(self.codes(pw.Camera, path / "none.toml"), ["E0101"])
        self.assertEqual(self.codes(pw.material, "white_z94"), ["E1311"])
        with self.assertRaises(ValueError):
            pw.sheet("crumpled", 1, 1)

    def test_settings(self):
        with pw.Renderer(CUBESAT, gl="osmesa", size=16) as renderer:
            for wrong in ({"camrea": [1, 2, 3]}, {"size": 0}, {"camera": [1, 2]}, {"camera": float("nan")}, {"samples": "many"},
                          {"pose": {"other": [0, 0, 0, 1, 0, 0, 0]}}, {"fov": 40, "ortho": 3}):
                self.assertNotEqual(self.codes(renderer.render, wrong), [], wrong)
            with self.assertRaises(TypeError):
                renderer.render(camera=object())
            with self.assertRaises(ValueError):
                renderer.render(output="a.png")
            with self.assertRaises(KeyError):
                renderer.render(samples=1)["colour"]
            # those before a wrong one are drawn; the renderer goes on
            views = [{"samples": 1}, {"samples": 1}, {"pose": {"other": [0, 0, 0, 1, 0, 0, 0]}}]
            drawn = []
            with self.assertRaises(pw.Error):
                for image in renderer.frames(views, ahead=1):
                    drawn.append(image)
            self.assertEqual(len(drawn), 2)
            self.assertEqual(renderer.render(samples=1).width, 16)
        with self.assertRaises(pw.Error):
            pw.Renderer(CUBESAT, sise=3)
        with self.assertRaises(ValueError):
            pw.Renderer(CUBESAT, gl="vulkan")

    def test_warnings(self):
        with pw.Renderer(CUBESAT, gl="osmesa", size=16) as renderer, warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            renderer.render(camera=[0, -9, 0], look_at=[0, -20, 0])
        self.assertEqual([each.message.diagnostic.code for each in caught], ["W5006"])

    def test_closed_while_drawing(self):
        renderer = pw.Renderer(CUBESAT, gl="osmesa", size=64)
        frames = renderer.frames({"samples": 1} for _ in range(1000))
        first = next(frames)
        renderer.close()
        with self.assertRaises((pw.Error, ValueError)):
            list(frames)
        self.assertGreater(float(first["radiance"].max()), 0)
        with self.assertRaises(ValueError):
            renderer.render()
        renderer.close()

    def test_iteration_given_up(self):
        with pw.Renderer(CUBESAT, gl="osmesa", size=32) as renderer:
            for _ in renderer.frames({"samples": 1} for _ in range(10**9)):
                break
            self.assertEqual(renderer.render().width, 32)

    def test_interrupted(self):
        code = (f"import panwright as pw\nr = pw.Renderer({str(CUBESAT)!r}, gl='osmesa')\nr.render(size=16)\nprint('ready', flush=True)\n"
                "r.render(engine='reference', samples=64, size=1024)\n")
        process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        process.stdout.readline()
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertIn("KeyboardInterrupt", errors)

    def test_forked(self):
        code = (f"import os, panwright as pw\nr = pw.Renderer({str(CUBESAT)!r}, gl='osmesa', size=16)\nr.render()\npid = os.fork()\n"
                "if pid == 0:\n    for call in (r.render, lambda: pw.Renderer(None)):\n        try: call()\n        except ValueError as e: print(e, flush=True)\n"
                "    os._exit(0)\nos.waitpid(pid, 0)\nprint(r.render().width)\n")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.stdout.count("spawn"), 2, done.stdout + done.stderr)
        self.assertTrue(done.stdout.endswith("16\n"), done.stdout + done.stderr)

    def test_commands(self):
        self.assertEqual(self.codes(pw.command, "info", "none.pan"), ["E0101"])
        self.assertEqual(self.codes(pw.command, "inform", "none.pan"), ["E0201"])


class Threads(unittest.TestCase):
    def test_renderers_side_by_side(self):
        model = pw.open(CUBESAT)
        images = {}

        def draw(number):
            with pw.Renderer(model, gl="osmesa", size=48) as renderer:
                images[number] = [image["radiance"].copy() for image in renderer.frames([{"camera": [3, -4, k]} for k in range(4)])]

        threads = [threading.Thread(target=draw, args=(number,)) for number in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for other in (1, 2):
            np.testing.assert_array_equal(images[0], images[other])

    def test_one_renderer_from_several_threads(self):
        with pw.Renderer(CUBESAT, gl="osmesa", size=48) as renderer:
            expected = [renderer.render(camera=[3, -4, k])["radiance"] for k in range(3)]
            results = [None] * 3

            def draw(k):
                results[k] = renderer.render(camera=[3, -4, k])["radiance"]

            threads = [threading.Thread(target=draw, args=(k,)) for k in range(3)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            np.testing.assert_array_equal(expected, results)

    def test_memory_does_not_grow(self):
        def resident():
            return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")

        calls = int(os.environ.get("PANWRIGHT_CALLS", "300"))
        with pw.Renderer(CUBESAT, gl="osmesa", size=64, samples=1) as renderer:
            for _ in range(calls // 3):
                renderer.render()
            before = resident()
            for _ in range(calls):
                renderer.render()
            # one image with its layers takes 0.2 MB: none of them may stay
            self.assertLess(resident() - before, 8 << 20)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
