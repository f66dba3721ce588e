#include "tools/command_table.h"

namespace panwright::tools {

namespace {

constexpr Example kExamples[] = {
    {"new", "probe", "Write probe/probe.pxn, a bus in foil with a wing and a camera, and pxn.xsd for editors."},
    {"new", "models/lander", "In another folder."},
    {"new", "rover --json", "The names of the files as JSON."},

    {"compile", "cubesat/cubesat.pxn", "Write cubesat.pan into the working directory."},
    {"compile", "servicer/servicer.pxn -D panels=2 -o small.pan",
     "Give a parameter of the model another value."},
    {"compile", "paper/figure8.pxn --max-error 1e-4 --compress -o fine.pan",
     "Meshes within 0.1 mm of their shapes, in a smaller file."},

    {"import", "cad/relay.wrl --units mm", "Say what is in a CAD file; write nothing."},
    {"import", "cad/relay.wrl --units mm -o relay.pan",
     "Clean it, take away what nobody outside sees, and compile it."},
    {"import", "cad/relay.wrl --units mm --up-axis z -o cad/dressed.pxn",
     "Write a text that imports it, in which materials are assigned."},

    {"export", "cubesat/cubesat.pxn -o cubesat.glb", "Write a model for viewers of glTF."},
    {"export", "servicer/servicer.pxn -D panels=2 -o servicer.glb --timings",
     "Say how long each step took."},
    {"export", "paper/figure8.pxn -o coarse.glb --max-error 0.01",
     "Fewer triangles: meshes within 1 cm of their shapes."},

    {"check", "cubesat/cubesat.pxn client/client.pxn", "Check two models."},
    {"check", "servicer/servicer.pxn --sarif report.sarif",
     "Write the diagnostics for an editor or a code review too."},
    {"check", "cad/relay.wrl --units mm --json", "The same of a CAD file, as JSON."},

    {"info", "cubesat/cubesat.pxn", "Show triangles, errors, materials and frames."},
    {"info", "servicer/servicer.pxn --meshes", "List all meshes with their errors."},
    {"info", "paper/figure8.pxn --json", "The same, with all numbers, as JSON."},

    {"joints", "servicer/servicer.pxn", "List the joints as a tree: kinds, axes, limits, values."},
    {"joints", "servicer/servicer.pxn --joint wing_left/drive=45deg --json",
     "Where every node is with a wing turned, as JSON."},
    {"joints", "servicer/servicer.pxn --sweep-joint arm/elbow",
     "Through which box the elbow takes the lower arm, and what that runs into."},

    {"render", "cubesat/cubesat.pxn --size 256x256",
     "Write cubesat.png: the model fills the image, the Sun behind the left shoulder."},
    {"render",
     "servicer/servicer.pxn -o s.npz --size 256x256 --camera \"9 -9 6\" --fov 45 --sun \"1 -0.7 "
     "0.6\" --samples 2",
     "Radiance and ground truth (depth, normals, ids) from a given camera."},
    {"render",
     "cubesat/cubesat.pxn -o truth.exr --engine reference --size 32x32 --samples 2 --seed 1",
     "The same light by path tracing, with error bars."},

    {"view", "servicer/servicer.pxn", "A window: move the camera, the Sun and the joints; edit the text beside it."},
    {"view", "servicer=servicer/servicer.pxn client/client.pxn --size 1920x1080", "Two targets in a larger window."},
    {"view", "cubesat/cubesat.pxn -D units=6 -D wings=1", "Other values of the model's parameters."},

    {"material", "--list", "List the materials of the library."},
    {"material", "white_z93", "What a material does with light: albedo, energy, precision."},
    {"material", "mli_gold_kapton copper --render samples.png --width 120",
     "Draw samples of two materials."},

    {"mli", "crinkled", "Statistics of half a metre of crinkled foil: heights, slopes."},
    {"mli",
     "quilted --seed 2 -o quilted.png --width 128 --height heights.npy --histogram slopes.svg",
     "Draw another sheet of the same kind; its heights in metres, its slopes as a plot."},
    {"mli", "blankets/blankets.pxn --sheet taped --fit \"slope_rms=0.1\" --json",
     "A sheet of a model with another slope, as JSON with its recipe."},

    {"diff", "cubesat/cubesat.pxn cubesat/cubesat.pxn", "Compare two models: these are equal."},
    {"diff", "cubesat/cubesat.pxn cubesat/cubesat.pxn --all",
     "Compare what they were made from, too."},
    {"diff", "paper/figure8.pxn paper/figure8.pxn --max-error 0.01 --json",
     "The differences as JSON."},

    {"fmt", "cubesat/cubesat.pxn", "Lay a text out in place; comments stay."},
    {"fmt", "--check cubesat/cubesat.pxn client/client.pxn",
     "Only name the files that would change, with exit code 1."},
    {"fmt", "cubesat/cubesat.pxn -o formatted.pxn", "Write the result elsewhere."},

    {"upgrade", "paper/figure8.pxn -o figure8.pxn",
     "Write a text of level 0 in level 1; the model stays the same."},
    {"upgrade", "paper/figure5a.pxn paper/figure5b.pxn", "Upgrade several files in place."},
    {"upgrade", "paper/figure7.pxn -o -", "Print the text."},

    {"expand", "cubesat/cubesat.pxn -o expanded.pxn",
     "Write one text without parts, repeats and expressions."},
    {"expand", "servicer/servicer.pxn -D panels=2 -o two.pxn",
     "The same with another value of a parameter."},
    {"expand", "paper/figure8.pxn -o -", "Print the text, without textures."},

    {"explain", "E1101", "What a code means, with an example and its cure."},
    {"explain", "", "List all codes."},
    {"explain", "W6006 --json", "The same as JSON."},

    {"help", "", "List the commands."},
    {"help", "render", "The options of a command; the same as `panwright render --help`."},
    {"help", "material --man | man -l -", "Read its manual page."},

    {"version", "", "Print the version."},
    {"version", "--json", "Print features, formats, compiler and libraries too."},
    {"version", "--json --timings", "JSON has the same frame for every command."},

    {"completion", "bash > panwright.bash", "Write the script; then `source panwright.bash`."},
    {"completion", "zsh > _panwright", "Write the script into a folder of zsh's fpath."},
    {"completion", "fish > panwright.fish", "Write it as fish has it in its completions folder."},
};

}  // namespace

std::span<const Example> all_examples() { return kExamples; }

}  // namespace panwright::tools
