#include "scenario/internal/segment_source.h"

#include <type_traits>
#include <utility>

namespace panwright::scenario {

namespace {

template <class Value>
class SegmentSource final : public Source {
 public:
  SegmentSource(SourceInfo info, std::string target, std::vector<Samples<Value>> segments,
                std::vector<Piece> pieces)
      : Source(std::move(info)),
        target_(std::move(target)),
        segments_(std::move(segments)),
        pieces_(std::move(pieces)) {}

 private:
  const char* fill(double time, Frame& frame) const override {
    const Value value = value_at(segments_[segment_at(pieces_, time)], time);
    Placement& placement = target_.empty() ? frame.camera : frame.target(target_).placement;
    if constexpr (std::is_same_v<Value, Vec3>)
      placement.position = value;
    else
      placement.rotation = value;
    return nullptr;
  }
  std::string target_;
  std::vector<Samples<Value>> segments_;
  std::vector<Piece> pieces_;
};

template <class Value>
SourcePtr made(SourceInfo info, const std::string& target, std::vector<Samples<Value>> segments,
               std::vector<Piece> pieces) {
  info.spans = spans_of(pieces);
  info.channels = {
      {std::is_same_v<Value, Vec3> ? Quantity::position : Quantity::rotation, target, {}}};
  for (const Piece& piece : pieces)
    for (const double time : segments[piece.segment].times)
      if (piece.span.contains(time) && (info.times.empty() || time > info.times.back()))
        info.times.push_back(time);
  return std::make_shared<SegmentSource<Value>>(std::move(info), target, std::move(segments),
                                                std::move(pieces));
}

}  // namespace

SourcePtr segment_source(SourceInfo info, const std::string& target,
                         std::vector<Samples<Vec3>> segments, std::vector<Piece> pieces) {
  return made(std::move(info), target, std::move(segments), std::move(pieces));
}

SourcePtr segment_source(SourceInfo info, const std::string& target,
                         std::vector<Samples<Quat>> segments, std::vector<Piece> pieces) {
  return made(std::move(info), target, std::move(segments), std::move(pieces));
}

}  // namespace panwright::scenario
