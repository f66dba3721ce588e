// What the window remembers of one run for the next one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace panwright::studio {

inline constexpr double kSmallestText = 0.6, kLargestText = 3;

struct Layout {
  std::uint32_t width = 1280, height = 720;  // of the window, pixels
  double panel = 384;                        // its width, pixels at a scale of 1
  bool panel_shown = true;
  double text = 1;  // size of text and widgets, beside the screen's scale
  std::string tab = "Camera";
  std::string layer = "light";  // one of kLayers
  bool mark_white = false;
  bool labels = false;
  bool operator==(const Layout&) const = default;
};

// $XDG_STATE_HOME/panwright/window.json, or that in ~/.local/state; empty: neither is there.
std::filesystem::path layout_file();

// What is absent, or beyond what it may be, is as in `Layout{}`; no file: all of it.
//
//   problem  what is wrong with the file, where it is broken
Layout read_layout(const std::filesystem::path& file, std::string& problem);
// Whether it could be written; its folder is made. Nothing is reported.
bool write_layout(const std::filesystem::path& file, const Layout& layout);

}  // namespace panwright::studio
