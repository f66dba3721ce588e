// Source of one position or rotation, from samples in segments. Private to scenario.
#pragma once

#include <string>
#include <vector>

#include "scenario/internal/track.h"
#include "scenario/source.h"

namespace panwright::scenario {

// info: name, epoch, system, frame and centre; the rest follows.
//
//   target  empty: the camera's
//   pieces  of the segments; not empty
SourcePtr segment_source(SourceInfo info, const std::string& target,
                         std::vector<Samples<Vec3>> segments, std::vector<Piece> pieces);
SourcePtr segment_source(SourceInfo info, const std::string& target,
                         std::vector<Samples<Quat>> segments, std::vector<Piece> pieces);

}  // namespace panwright::scenario
