// Histograms of RADARs as files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "instruments/radar.h"

namespace panwright::instruments {

inline constexpr std::string_view kHistogramFileTypes = ".npz, .csv, .png or .exr";
bool is_histogram_file(const std::filesystem::path& path);
// Returns whether a file that write_histogram() wrote is whole, as far as its end tells.
bool is_whole_histogram_file(const std::filesystem::path& path);

// Writes a histogram in the format of its extension, atomically.
//
//   .npz  power_w, mean_power_w, azimuth_rad, elevation_rad (S, R) float64; range_m (R), speed_m_s
//         (S), response_sum; record: the JSON text as bytes
//   .csv  range_m, speed_m_s, power_w, mean_power_w, azimuth_rad, elevation_rad: a line a cell
//   .png  decibels below the largest cell, black at 60; a square of pixels a cell, ranges to the
//         right, speeds upwards
//   .exr  watts, a pixel a cell, as the PNG lies
//
//   record  of PNG, EXR and NPZ: JSON in ASCII
// Fails: E0103. Expects: is_histogram_file().
bool write_histogram(const RadarHistogram& histogram, const std::filesystem::path& path,
                     const std::string& record, DiagnosticLog& log);

}  // namespace panwright::instruments
