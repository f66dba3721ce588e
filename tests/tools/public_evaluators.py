#!/usr/bin/env python3
"""public_evaluators.py PANWRIGHT EXAMPLES: labels of runs, scored as predictions of themselves by COCO's and BOP's own code.

They must be perfect, and score less once disturbed. Needs pycocotools or bop_toolkit_lib; with neither it exits with 77.
"""
import contextlib
import importlib.util
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import types

known = [name for name in ("pycocotools", "bop_toolkit_lib") if importlib.util.find_spec(name)]
if not known:
    sys.exit(print("neither pycocotools nor bop_toolkit_lib can be imported") or 77)
import numpy as np  # both need it
program, examples = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()


def moved(label, kind, pixels, mask):
    """A label of COCO as a prediction, that many pixels to the right."""
    found = {"bbox": lambda box: [box[0] + pixels, *box[1:]],
             "segmentation": lambda runs: mask.encode(np.asfortranarray(np.roll(mask.decode(runs), pixels, axis=1))),
             "keypoints": lambda points: [value + (pixels if k % 3 == 0 else 0) for k, value in enumerate(points)]}[kind](label[kind])
    return {"image_id": label["image_id"], "category_id": label["category_id"], "score": 1.0, kind: found}


def coco(frames, folder):
    from pycocotools import mask
    from pycocotools.coco import COCO
    from pycocotools.cocoeval import COCOeval
    truth, ours = COCO(str(folder / "annotations.json")), {}
    for file in sorted(frames.glob("*.labels.json")):
        frame = json.loads(file.read_text())
        masks = np.load(frames / frame["masks"])
        for thing in frame["things"]:
            place, whole = thing["visible"], np.zeros((frame["camera"]["height"], frame["camera"]["width"]), np.uint8)
            if place["width"]:
                whole[place["top"]:, place["left"]:][:place["height"], :place["width"]] = masks[f"{thing['id']}.visible"] > 127
            ours[frame["number"], thing["id"]] = whole
    for each in truth.dataset["annotations"]:
        assert np.array_equal(truth.annToMask(each), ours.pop((each["image_id"], each["category_id"])))
        assert mask.area(each["segmentation"]) == each["area"] and list(mask.toBbox(each["segmentation"])) == each["bbox"]
    assert not any(left.any() for left in ours.values())
    for category in truth.loadCats(truth.getCatIds()):
        labels = truth.loadAnns(truth.getAnnIds(catIds=category["id"]))
        for kind in ("bbox", "segmentation", "keypoints")[:3 if "keypoints" in category else 2]:
            scores = []
            for pixels in (0, 2, 20):
                judge = COCOeval(truth, truth.loadRes([moved(each, kind, pixels, mask) for each in labels]), kind.replace("entation", ""))
                judge.params.catIds = [category["id"]]
                judge.params.kpt_oks_sigmas = np.array(category.get("kpt_oks_sigmas"))
                for step in (judge.evaluate, judge.accumulate, judge.summarize):
                    step()
                scores.append(judge.stats[0])
            print(f"{category['name']} {kind}: {scores}", file=sys.stderr)
            assert scores[0] == 1 >= scores[1] >= scores[2] and scores[2] < 1, (category, kind, scores)


def depth_of(model, size, rotation, translation, fx, fy, cx, cy):
    """At the centres of pixels, as BOP's renderers see a model that lies before the camera."""
    depth, points = np.full(size, np.inf), model["pts"] @ rotation.T + translation.ravel()
    corners = np.stack([fx * points[:, 0] / points[:, 2] + cx, fy * points[:, 1] / points[:, 2] + cy, 1 / points[:, 2]], axis=1)
    for a, b, c in corners[model["faces"].astype(int)]:
        left, top = np.maximum(np.ceil(np.minimum(np.minimum(a, b), c)[:2]), 0).astype(int)
        right, bottom = np.maximum(np.floor(np.maximum(np.maximum(a, b), c)[:2]) + 1, 0).astype(int)
        double, window = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]), depth[top:bottom, left:right]
        if window.size and double:
            y, x = np.mgrid[top:top + window.shape[0], left:left + window.shape[1]]
            v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / double
            w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / double
            inside = (v >= 0) & (w >= 0) & (v + w <= 1)
            window[inside] = np.minimum(window, 1 / (a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2])))[inside]
    return {"depth": np.where(np.isfinite(depth), depth, 0)}


def bop(folder):
    from bop_toolkit_lib import misc, inout, pose_error, pose_matching, score, visibility
    scene, taus = folder / "train/000000", np.arange(.05, .51, .05)
    truth, cameras = inout.load_scene_gt(scene / "scene_gt.json"), inout.load_scene_camera(scene / "scene_camera.json")
    facts, info = (inout.load_json(folder / name, keys_to_int=True) for name in ("train/000000/scene_gt_info.json", "models/models_info.json"))
    models = {number: inout.load_ply(folder / f"models/obj_{number:06}.ply") for number in info}
    symmetries = {number: misc.get_symmetry_transformations(info[number], .01) for number in info}
    depths = {image: inout.load_depth(scene / f"depth/{image:06}.png") * cameras[image]["depth_scale"] for image in truth}
    size = depths[min(truth)].shape
    renderer = types.SimpleNamespace(render_object=lambda number, *pose: depth_of(models[number], size, *pose))

    def errors_of(kind, image, found, true):
        number, poses = true["obj_id"], (found["R"], found["t"], true["cam_R_m2c"], true["cam_t_m2c"])
        k, diameter, shape = cameras[image]["cam_K"], info[number]["diameter"], (models[number]["pts"], symmetries[number])
        if kind == "vsd":
            return pose_error.vsd(*poses, depths[image], k, 15, taus, True, diameter, renderer, number)
        return [pose_error.mssd(*poses, *shape) / diameter if kind == "mssd" else pose_error.mspd(*poses, k, *shape) * 640 / size[1]]

    def judged(kind, degrees):
        """Largest error, and average recall, of poses turned about the models' x axes and read back."""
        s, c = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
        inout.save_bop_results(folder / "results.csv", [
            {"scene_id": 0, "im_id": image, "obj_id": each["obj_id"], "score": 1.0, "t": each["cam_t_m2c"],
             "R": each["cam_R_m2c"] @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])} for image, all_of in truth.items() for each in all_of])
        errors, recalls = [], []
        for place, found in enumerate(inout.load_bop_results(folder / "results.csv")):
            image = found["im_id"]
            of = {k: errors_of(kind, image, found, each) for k, each in enumerate(truth[image]) if each["obj_id"] == found["obj_id"]}
            errors.append({"im_id": image, "obj_id": found["obj_id"], "est_id": place, "score": 1.0, "errors": of,
                           "gt_visib_fracts": {k: facts[image][k]["visib_fract"] for k in of}})
        valid = {image: [each["visib_fract"] > 0 for each in facts[image]] for image in truth}
        for tau in range(len(errors[0]["errors"][0])):
            one = [{**each, "errors": {k: [e[tau]] for k, e in each["errors"].items()}} for each in errors]
            for limit in np.arange(5, 51, 5) if kind == "mspd" else taus:
                matches = pose_matching.match_poses_scene(0, truth, facts, valid, one, [limit], 1)
                recalls.append(score.calc_localization_scores([0], list(info), matches, 1, do_print=False)["recall"])
        return max(max(e) for each in errors for e in each["errors"].values()), np.mean(recalls)

    for kind in ("mssd", "mspd", "vsd"):
        scores = [judged(kind, degrees) for degrees in (0, 1, 30)]
        print(f"{kind}: {scores}", file=sys.stderr)
        assert scores[0] == (0, 1) and 0 < scores[1][0] < scores[2][0] and scores[2][1] < 1, (kind, scores)
    for image, place in ((image, place) for image in truth for place in range(len(truth[image]))):
        each, k = truth[image][place], cameras[image]["cam_K"]
        model = renderer.render_object(each["obj_id"], each["cam_R_m2c"], each["cam_t_m2c"], k[0, 0], k[1, 1], k[0, 2], k[1, 2])["depth"]
        seen = visibility.estimate_visib_mask_gt(*(misc.depth_im_to_dist_im_fast(of, k) for of in (depths[image], model)), 15)
        ours = inout.load_im(scene / f"mask_visib/{image:06}_{place:06}.png") > 0
        border = np.any([np.roll(ours, step, axis) != ours for axis in (0, 1) for step in (1, -1)], axis=0)
        assert ((seen != ours) & ~border).sum() <= 6, (image, each)  # in gaps narrower than pixels: 3 measured


def main():
    with tempfile.TemporaryDirectory() as scratch, contextlib.redirect_stdout(io.StringIO()):
        scratch = pathlib.Path(scratch)
        (scratch / "camera.toml").write_text("size = [320, 240]\nfocal = 386.25\n")

        def written(scenario, name, *models):
            for command in (["run", examples / f"rendezvous/{scenario}.toml", "-o", scratch / scenario, "--camera-file", scratch / "camera.toml",
                             "--every", "60", "--labels", "--type", "png", "--type", "npz"],
                            ["labels", scratch / scenario, "-o", scratch / name, "--format", name, *models]):
                subprocess.run([program, *command], check=True, stdout=subprocess.DEVNULL)
            return scratch / name
        if "pycocotools" in known:
            coco(scratch / "rendezvous", written("rendezvous", "coco"))
        if "bop_toolkit_lib" in known:
            bop(written("approach", "bop", "--target", f"client={examples / 'client/client.pxn'}"))
    print("scored by", *known)


main()
