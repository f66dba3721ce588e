// Labels that a run writes beside its images.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "labels/compute.h"

namespace panwright::workspace {

struct View;
struct Frame;

struct Labelling {
  labels::LabelOptions options;
  bool flow = false;                 // to the next and the previous frame
  std::vector<std::string> formats;  // of data sets, written at the end of a run (labels/convert.h)
  bool operator==(const Labelling&) const = default;
};

// Labels of one view or frame of a sequence.
template <class Moment>
struct LabelsOf {
  std::shared_ptr<const Labelling> labelling;  // not null
  std::string name;                            // of the files, without extension
  std::uint64_t number = 0;                    // from 0
  double time = 0;                             // seconds
  // For flow; null: none.
  std::shared_ptr<const Moment> previous, next;
};
using ViewLabels = LabelsOf<View>;
using FrameLabelling = LabelsOf<Frame>;

}  // namespace panwright::workspace
