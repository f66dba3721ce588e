// Optical flow in the .flo format of Middlebury: "PIEH", width, height, then right and down of each
// pixel in float. Private to labels.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/diagnostic.h"
#include "base/result.h"
#include "labels/labels.h"

namespace panwright::labels {

// Size of the file of a flow.
std::uint64_t flo_bytes(std::uint32_t width, std::uint32_t height);

// Fails: E0103.
bool write_flo(const std::filesystem::path& path, const Flow& flow, DiagnosticLog& log,
               double* sync_seconds);

// Fails: E0101; E9001 for other bytes and sizes.
Result<Flow> read_flo(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                      DiagnosticLog& log);

}  // namespace panwright::labels
