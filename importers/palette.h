// Palettes: images that stand for colours.
#pragma once

#include "base/job.h"
#include "importers/import.h"

namespace panwright::importers {

// Replaces a small image, in which each triangle takes its colour from one place, by a material for
// each colour. Some tools make such palettes of all materials of a model, to which no rule could
// assign materials. The appearance does not change. Runs after clean_up(), which merges triangles
// at one place.
//
// A mesh is split if the corners of each triangle lie at one place of the image, to half a texel.
// The texels around must agree within the error of lossy compression; images of at most 4096
// texels, meshes of at most 256 colours. Materials are named as the file's, followed by the
// colour's sRGB code: "Palette_8a7b6c"; a mesh of one colour stays one. Normal and cutout maps keep
// a material as it is.
//
// Reports N6301. Throws Cancelled. Cost: O(triangles · log colours).
void split_palettes(Imported& imported, DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::importers
