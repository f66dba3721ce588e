// Layout of the window, saved from run to run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace panwright::studio {

inline constexpr double kSmallestText = 0.6, kLargestText = 3;

struct Layout {
  std::uint32_t width = 1280, height = 720;  // of the window, pixels
  double panel = 384;                        // width of the panel, pixels at a scale of 1
  bool panel_shown = true;
  double text = 1;  // size of text and widgets, relative to the screen's scale
  std::string tab = "Camera";
  std::string layer = "light";  // one of kLayers
  bool mark_white = false;      // saturated pixels are striped
  bool labels = false;          // names of frames and keypoints
  bool operator==(const Layout&) const = default;
};

// $XDG_STATE_HOME/panwright/window.json, else in ~/.local/state; empty: neither exists.
std::filesystem::path layout_file();

// Members that are absent or out of range are those of `Layout{}`; without a file, all are.
//
//   problem  error of a broken file; empty: none
Layout read_layout(const std::filesystem::path& file, std::string& problem);
// Makes the folder and writes the file; returns whether that succeeded. Reports nothing.
bool write_layout(const std::filesystem::path& file, const Layout& layout);

}  // namespace panwright::studio
