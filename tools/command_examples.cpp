#include "tools/command_table.h"

namespace panwright::tools {

namespace {

constexpr Example kExamples[] = {
    {"new", "probe",
     "Write probe/probe.pxn, a bus in foil with a wing and a camera, and pxn.xsd for editors."},
    {"new", "models/lander", "Write it into another folder."},
    {"new", "rover --json", "Print the names of the files as JSON."},

    {"compile", "cubesat/cubesat.pxn", "Write cubesat.pan into the working directory."},
    {"compile", "servicer/servicer.pxn -D panels=2 -o small.pan", "Set a parameter of the model."},
    {"compile", "paper/figure8.pxn --max-error 1e-4 --compress -o fine.pan",
     "Compile meshes within 0.1 mm of their shapes into a smaller file."},

    {"import", "cad/relay.wrl --units mm", "Show the contents of a CAD file; write nothing."},
    {"import", "cad/relay.wrl --units mm -o relay.pan",
     "Clean it, remove hidden parts, and compile it."},
    {"import", "cad/relay.wrl --units mm --up-axis z -o cad/dressed.pxn",
     "Write a text that imports it and assigns materials."},

    {"export", "cubesat/cubesat.pxn -o cubesat.glb", "Write a model for viewers of glTF."},
    {"export", "servicer/servicer.pxn -D panels=2 -o servicer.glb --timings",
     "Print the time of each step."},
    {"export", "paper/figure8.pxn -o coarse.glb --max-error 0.01",
     "Write fewer triangles: meshes within 1 cm of their shapes."},

    {"check", "cubesat/cubesat.pxn client/client.pxn", "Check two models."},
    {"check", "servicer/servicer.pxn --sarif report.sarif",
     "Write the diagnostics for an editor or a code review too."},
    {"check", "cad/relay.wrl --units mm --json", "Check a CAD file; print JSON."},

    {"info", "cubesat/cubesat.pxn", "Show triangles, errors, materials and frames."},
    {"info", "servicer/servicer.pxn --meshes", "List all meshes with their errors."},
    {"info", "paper/figure8.pxn --json", "Print all numbers as JSON."},

    {"joints", "servicer/servicer.pxn", "List the joints as a tree: kinds, axes, limits, values."},
    {"joints", "servicer/servicer.pxn --joint wing_left/drive=45deg --json",
     "Print the pose of every node with a wing turned, as JSON."},
    {"joints", "servicer/servicer.pxn --sweep-joint arm/elbow",
     "Sweep the elbow: bounds of the lower arm, and its collisions."},

    {"render", "cubesat/cubesat.pxn --size 256x256",
     "Write cubesat.png: the model fills the image, the Sun behind the left shoulder."},
    {"render",
     "servicer/servicer.pxn -o s.npz --size 256x256 --camera \"9 -9 6\" --fov 45 --sun \"1 -0.7 "
     "0.6\" --samples 2",
     "Write radiance and ground truth (depth, normals, ids) from a given camera."},
    {"render",
     "cubesat/cubesat.pxn -o truth.exr --engine reference --size 32x32 --samples 2 --seed 1",
     "Render by path tracing, with error bars."},

    {"scenario", "rendezvous/approach.toml", "Print times, ranges and phase angles of its frames."},
    {"scenario", "rendezvous/flyby.csv --plot flyby.svg", "Draw the course of a table."},
    {"scenario", "rendezvous/approach.toml --at 42.5 --json",
     "Print the frame of a time, interpolated."},

    {"run", "rendezvous/approach.toml -o frames --frames 0..2 --sheet frames.png",
     "Render the first three frames, and a contact sheet of them."},
    {"run",
     "rendezvous/flyby.csv --target client=client/client.pxn -o flyby --size 320x240 --fov 60",
     "Fly a camera past a model on the way of a table."},
    {"run", "rendezvous/approach.toml -o truth --every 150 --type npz",
     "Write radiance and ground truth of a frame every 150 s."},

    {"serve", "client/client.pxn --size 512x512 --fov 40",
     "Serve a model to simulators on 127.0.0.1:10363, each with a world of its own."},
    {"serve", "7=client/client.pxn servicer/servicer.pxn --port 0 --log requests.jsonl --gl osmesa",
     "Number an object 7, take a free port, and log requests for --replay."},
    {"serve", "--coverage", "List the requests of the protocol and what each does."},

    {"labels", "labels -o coco --format coco",
     "Write masks, boxes and keypoints of all frames of a folder for COCO."},
    {"labels", "labels -o speed --format speedplus --target client",
     "Write the poses of one target for SPEED+, with images and camera.json."},
    {"labels", "labels -o sets --format yolo,yolo-seg,cryptomatte",
     "Write several formats, each into a folder of its own."},

    {"radar",
     "servicer/servicer.pxn --radar radar/docking_x_band.toml --camera \"13 -15.5 8\" --look-at "
     "\"0 0 0\" -o echoes.png",
     "Measure the echoes of a model by range and speed."},
    {"radar", "rendezvous/approach.toml --radar radar/docking_x_band.toml --at 200 -o echoes.npz",
     "Measure moving targets at a time of a scenario."},
    {"radar",
     "client/client.pxn --radar radar/docking_x_band.toml --camera \"0 -20 0\" --look-at \"0 0 0\" "
     "--ideal -o echoes.csv",
     "Write mean powers, without noise or speckle."},
    {"dataset", "plan dataset/plan.toml -o set",
     "Write the table of the frames that a plan declares, and what they cover."},
    {"dataset", "run set --shard 0/40", "Render the first fortieth of them, or what is not whole."},
    {"dataset", "run set --shard 1/40 --json", "Render the second fortieth; print JSON."},

    {"stars", "--quat \"0.5 -0.5 0.5 -0.5\" --fov 10", "List the stars that a camera has in view."},
    {"stars",
     "--look-at \"0.37 0.88 -0.29\" --fov 20 --size 1024x1024 --stars 5 --date 2026-06-01T00:00:00",
     "List bright stars with their motion up to a date."},
    {"stars", "--camera-file rendezvous/camera.toml --look-at \"0 0 1\" --stars 9 --json",
     "Write the pixels of stars through a calibrated lens as JSON."},

    {"lookup",
     "servicer/servicer.pxn --camera \"9 -9 6\" --fov 45 --pixel \"512 512\" --nearest \"0 0 3\"",
     "Find the surface of a pixel, and the point of the model nearest to another."},
    {"lookup", "client/client.pxn --camera \"9 -9 6\" --fov 45 --keypoints --json",
     "List the keypoints, and whether they are hidden and lit, as JSON."},
    {"lookup", "cubesat/cubesat.pxn --sight \"1 0 0 -1 0 0\" --elevation \"0 0\" -o answers.csv",
     "Ask for a line of sight and a height; write a table."},

    {"lidar",
     "servicer/servicer.pxn --lidar lidar/flash_rvd.toml --camera \"15 -18 9\" -o cloud.npz",
     "Measure a cloud with a flash LiDAR."},
    {"lidar",
     "client/client.pxn --lidar lidar/scanning_rvs.toml --camera \"9 -12 5\" --frame client -o "
     "scan.las -o scan.csv",
     "Scan a target; write the points in its axes."},
    {"lidar", "rendezvous/approach.toml --lidar lidar/flash_rvd.toml --at 100 --ideal -o ideal.pcd",
     "Measure ranges without noise at a time of a scenario."},

    {"camera", "cameras/narrow_rvd.toml", "Show its field of view, MTF, noise and exposure."},
    {"camera", "cameras/star_tracker.toml --svg plots",
     "Plot photon transfer, MTF and encircled energy."},
    {"camera", "cameras/wide_docking.toml --albedo 0.1 --json",
     "Print all numbers, with the exposure of a dark plate, as JSON."},

    {"dem", "terrain/crater.lbl -o crater.png",
     "Show its size, place, voids and slopes, and draw its hillshade."},
    {"dem", "terrain/crater.lbl --void -32768 --json", "Print the same as JSON."},
    {"dem", "terrain/body.tab --unit km -o body.png", "Draw three views of a shape model."},

    {"view", "servicer/servicer.pxn",
     "Open a window to move the camera, the Sun and the joints; edit the text in an editor."},
    {"view", "servicer=servicer/servicer.pxn client/client.pxn --size 1920x1080",
     "Show two targets in a larger window."},
    {"view", "rendezvous/approach.toml", "Play a scenario."},

    {"material", "--list", "List the materials of the library."},
    {"material", "white_z93", "Report on a material: albedo, energy, precision."},
    {"material", "mli_gold_kapton copper --render samples.png --width 120",
     "Draw samples of two materials."},

    {"mli", "crinkled", "Print statistics of half a metre of crinkled foil: heights, slopes."},
    {"mli",
     "quilted --seed 2 -o quilted.png --width 128 --height heights.npy --histogram slopes.svg",
     "Draw another sheet of the same kind; write its heights in metres and a plot of its slopes."},
    {"mli", "blankets/blankets.pxn --sheet taped --fit \"slope_rms=0.1\" --json",
     "Fit a sheet of a model to another slope; print JSON with its recipe."},

    {"diff", "cubesat/cubesat.pxn cubesat/cubesat.pxn", "Compare two models: these are equal."},
    {"diff", "cubesat/cubesat.pxn cubesat/cubesat.pxn --all",
     "Compare their provenance and storage too."},
    {"diff", "paper/figure8.pxn paper/figure8.pxn --max-error 0.01 --json",
     "Print the differences as JSON."},

    {"fmt", "cubesat/cubesat.pxn", "Format a text in place; comments are kept."},
    {"fmt", "--check cubesat/cubesat.pxn client/client.pxn",
     "List the files that would change, with exit code 1."},
    {"fmt", "cubesat/cubesat.pxn -o formatted.pxn", "Write the result to another file."},

    {"upgrade", "paper/figure8.pxn -o figure8.pxn",
     "Write a text of level 0 in level 1; the model stays the same."},
    {"upgrade", "paper/figure5a.pxn paper/figure5b.pxn", "Upgrade several files in place."},
    {"upgrade", "paper/figure7.pxn -o -", "Print the text."},

    {"expand", "cubesat/cubesat.pxn -o expanded.pxn",
     "Write one text without parts, repeats and expressions."},
    {"expand", "calibration/board.pxn -D columns=2 -o board.pxn", "Set a parameter, then expand."},
    {"expand", "paper/figure8.pxn -o -", "Print the text, without textures."},

    {"explain", "E1101", "Explain a code, with an example and its cure."},
    {"explain", "", "List all codes."},
    {"explain", "W6006 --json", "Print the explanation as JSON."},

    {"help", "", "List the commands."},
    {"help", "render", "List the options of a command, as `panwright render --help`."},
    {"help", "material --man | man -l -", "Read its manual page."},

    {"version", "", "Print the version."},
    {"version", "--json", "Print features, formats, compiler and libraries too."},
    {"version", "--json --timings", "Print JSON with the fields that every command has."},

    {"completion", "bash > panwright.bash", "Write the script; then `source panwright.bash`."},
    {"completion", "zsh > _panwright", "Write the script into a folder of zsh's fpath."},
    {"completion", "fish > panwright.fish", "Write the script into fish's completions folder."},
};

}  // namespace

std::span<const Example> all_examples() { return kExamples; }

}  // namespace panwright::tools
