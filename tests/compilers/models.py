"""The models by which compilers are compared."""
import glob
import os

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
EXAMPLES = ("examples/*/*.pxn", "examples/*/*.wrl")
# a minute of foil even when optimised: mli_compilers compares what makes it
SLOW = ("operations.pxn",)
# small files of each format, and ten of the corpus where it is there
IMPORTS = (
    "tests/importers/data/bad/[NW]6*", "spacecraft-gltf/hubble-draco-webp.glb",
    "spacecraft-gltf/hubble-meshopt.glb", "spacecraft-gltf/newhorizons-draco-webp.glb",
    "spacecraft-gltf/ulysses-draco-webp.glb", "spacecraft-gltf/tdrs-a-blender.glb",
    "spacecraft-gltf/space-shuttle-d-draco.glb", "spacecraft-vrml/derived/tdrs-a-vtk.wrl",
    "spacecraft-vrml/derived/cubesat6u-freecad-gui.wrl",
    "spacecraft-vrml/derived/ISS_MainBody-meshlab.wrl", "small-bodies/bennu.obj")


def models(corpus):
    """Their files, those of the corpus where that is there."""
    roots = [(ROOT, EXAMPLES + IMPORTS[:1])]
    if corpus and os.path.isdir(corpus):
        roots.append((corpus, IMPORTS[1:]))
    for root, patterns in roots:
        for pattern in patterns:
            for path in sorted(glob.glob(os.path.join(root, pattern))):
                if os.path.basename(path) not in SLOW and path.endswith((".pxn", ".wrl", ".glb", ".gltf", ".obj", ".stl", ".ply")):
                    yield path
