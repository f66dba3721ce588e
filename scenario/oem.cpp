#include "scenario/oem.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/text.h"
#include "scenario/internal/ccsds.h"
#include "scenario/internal/segment_source.h"

namespace panwright::scenario {

namespace {

constexpr std::array<std::string_view, 12> kOemKeys = {
    "OBJECT_NAME",       "OBJECT_ID",   "CENTER_NAME",   "REF_FRAME",
    "REF_FRAME_EPOCH",   "TIME_SYSTEM", "START_TIME",    "USEABLE_START_TIME",
    "USEABLE_STOP_TIME", "STOP_TIME",   "INTERPOLATION", "INTERPOLATION_DEGREE"};
constexpr std::array<std::string_view, 3> kOemExpected = {"OBJECT_NAME", "OBJECT_ID",
                                                          "CENTER_NAME"};
constexpr std::array<std::string_view, 3> kOemShared = {"OBJECT_NAME", "CENTER_NAME", "REF_FRAME"};
constexpr double kKilometre = 1000;
constexpr std::size_t kDefaultDegree = 7;

// Reader of the blocks.
class OemReader {
 public:
  OemReader(const OemOptions& options, Input& input) : options_(options), input_(input) {}

  bool read(const Message& message) {
    for (const Block& block : message.blocks)
      if (!read_block(block, message.blocks.front())) return false;
    return input_.errors() == 0;
  }

  SourcePtr source() {
    std::vector<TimeSpan> spans;
    for (const auto& segment : segments_) spans.push_back(segment.span);
    auto pieces = block_pieces(spans, places_, input_, options_.strict);
    info_.name = input_.name();
    return segment_source(std::move(info_), options_.target, std::move(segments_),
                          std::move(pieces));
  }

 private:
  bool read_block(const Block& block, const Block& first) {
    check_present(block, kOemExpected, input_, options_.strict);
    const Field* const frame = required(block, "REF_FRAME", input_);
    BlockTimes times;
    MethodRead method;
    if (!read_times(block, times, input_) || frame == nullptr ||
        !same_metadata(block, first, kOemShared, input_) ||
        !read_method(block, "INTERPOLATION", method, input_))
      return false;
    Samples<Vec3> samples;
    std::vector<std::size_t> kept;
    if (!read_record_times(block, times.system, info_.epoch, samples.times, kept, input_,
                           options_.strict) ||
        !read_states(block, kept, samples))
      return false;
    if (!method.stated) {
      method = {true, Method::hermite, kDefaultDegree};
      method.degree = std::min(kDefaultDegree, 2 * samples.times.size() - 1);
      if (!assumed_)
        input_.report(
            Code("N8010"), block.begin,
            fmt::format("the metadata have no INTERPOLATION: Hermite of degree {}", method.degree));
      assumed_ = true;
    } else if (method.method != Method::linear) {
      check_degree(block, method,
                   method.method == Method::hermite ? (method.degree + 2) / 2 : method.degree + 1,
                   samples.times.size(), input_);
    }
    samples.method = method.method;
    samples.degree = method.degree;
    if (!end_block(block, times, *info_.epoch, samples, input_, options_.strict)) return false;
    info_.system = times.system;
    info_.frame = frame_name(frame->value);
    if (const Field* const centre = block.find("CENTER_NAME"))
      info_.centre = capitals(centre->value);
    segments_.push_back(std::move(samples));
    places_.push_back(block.begin);
    return true;
  }

  bool read_states(const Block& block, const std::vector<std::size_t>& kept,
                   Samples<Vec3>& samples) {
    constexpr std::size_t kState = 6, kWithAcceleration = 9;
    for (const std::size_t i : kept) {
      const Record& record = block.records[i];
      if (record.count != kState && record.count != kWithAcceleration) {
        input_.error(
            Code("E8001"), record.line,
            fmt::format("a record has an epoch and 6 or 9 numbers, found {}", record.count));
        if (!input_.more()) return false;
        continue;
      }
      const double* const n = &block.numbers[record.first];
      samples.values.push_back(Vec3(n[0], n[1], n[2]) * kKilometre);
      samples.velocities.push_back(Vec3(n[3], n[4], n[5]) * kKilometre);
    }
    return samples.values.size() == kept.size();
  }

  const OemOptions& options_;
  Input& input_;
  SourceInfo info_;
  std::vector<Samples<Vec3>> segments_;
  std::vector<std::string_view> places_;
  bool assumed_ = false;
};

}  // namespace

Result<SourcePtr> read_oem(const Text& text, const OemOptions& options, DiagnosticLog& log) {
  Input input(text, log);
  const Grammar grammar{"CCSDS_OEM_VERS", 3, kOemKeys, false};
  const auto message = read_message(input, grammar);
  if (!message) return failed;
  OemReader reader(options, input);
  if (!reader.read(*message)) return failed;
  SourcePtr source = reader.source();
  if (input.errors() > 0) return failed;
  return source;
}

}  // namespace panwright::scenario
