// Completeness of image files.
#pragma once

#include <filesystem>

namespace panwright::image {

// Returns whether an image file that this program wrote is whole. PNG: all chunks, by their
// checksums; NPY, TIFF and FITS: the size in the header; NPZ: the directory at the end, and the
// places of all entries; EXR: all lines have a place, and the last ones can be read. False: no such
// file too.
//
// Cost: a PNG is read, of others the begin and the end.
bool is_whole(const std::filesystem::path& path);

}  // namespace panwright::image
