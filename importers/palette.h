// Images that stand for colours.
#pragma once

#include "base/job.h"
#include "importers/import.h"

namespace panwright::importers {

// Gives surfaces whose colour comes from a small image, each triangle's from one place of it, a
// material for each colour in its place. Some tools make such palettes of all materials of a model,
// which then can be dressed by no rule. What it looks like stays the same; after clean_up(), which
// takes triangles at one place for one.
//
// A mesh is split where each of its triangles has its corners at one place of the image, to half a
// texel, and the texels around that are the same to what lossy compression does; images of at most
// 4096 texels, meshes of at most 256 colours. Materials are called as the file's, with the colour's
// sRGB code behind: "Palette_8a7b6c"; a mesh of one colour stays one. Normal and cutout maps keep a
// material as it is.
//
// Reports N6301. Throws Cancelled. Cost: O(triangles · log colours).
void split_palettes(Imported& imported, DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::importers
