// Frames of labels made from formulas: discs before a pinhole camera.
#pragma once

#include <filesystem>
#include <string>

#include "labels/labels.h"

namespace panwright::labels {

// A folder of its own, removed at the end.
class SampleFolder {
 public:
  SampleFolder();
  SampleFolder(const SampleFolder&) = delete;
  SampleFolder& operator=(const SampleFolder&) = delete;
  ~SampleFolder();
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

std::string file_bytes(const std::filesystem::path& path);

// Frame `number` of 64 x 48 pixels: "client", a disc that moves to the right, with a part "wing";
// "servicer" before it, beyond the left edge from frame 2 on. Keypoints follow from the poses.
FrameLabels sample_frame(std::uint64_t number);

// Writes frames 0, 1, … with images, a PNG each, and depth, .npz: 10 m at the client, 8 m at the
// servicer, none elsewhere.
void write_sample_frames(const std::filesystem::path& folder, std::uint64_t count);

// True where all members are equal, NaN of flow too; else says which is not.
std::string difference(const FrameLabels& a, const FrameLabels& b);

// Output of a peer in Python beside this file, with its arguments.
struct PeerAnswer {
  bool skipped = false;  // a module is missing
  bool good = false;
  std::string text;
};
PeerAnswer peer(const std::string& script, const std::string& arguments);

}  // namespace panwright::labels
