#include "scenario/aem.h"

#include <fmt/core.h>

#include <array>
#include <utility>

#include "base/text.h"
#include "scenario/internal/ccsds.h"
#include "scenario/internal/segment_source.h"

namespace panwright::scenario {

namespace {

constexpr std::array<std::string_view, 18> kAemKeys = {"OBJECT_NAME",
                                                       "OBJECT_ID",
                                                       "CENTER_NAME",
                                                       "REF_FRAME_A",
                                                       "REF_FRAME_B",
                                                       "ATTITUDE_DIR",
                                                       "TIME_SYSTEM",
                                                       "START_TIME",
                                                       "STOP_TIME",
                                                       "ATTITUDE_TYPE",
                                                       "USEABLE_START_TIME",
                                                       "USEABLE_STOP_TIME",
                                                       "EULER_ROT_SEQ",
                                                       "QUATERNION_TYPE",
                                                       "RATE_FRAME",
                                                       "ANGVEL_FRAME",
                                                       "INTERPOLATION_METHOD",
                                                       "INTERPOLATION_DEGREE"};
constexpr std::array<std::string_view, 2> kAemExpected = {"OBJECT_NAME", "OBJECT_ID"};
constexpr std::array<std::string_view, 3> kAemShared = {"OBJECT_NAME", "REF_FRAME_A",
                                                        "REF_FRAME_B"};
// local frames of a spacecraft (504.0-B-1, annex A; SANA registry)
constexpr std::array<std::string_view, 15> kBodyFrames = {
    "SC_BODY", "SC_BUS",     "ACC_",        "ACTUATOR", "AST_", "CSS_", "DSS_", "ESA_",
    "GYRO_",   "IMU_FRAME_", "INSTRUMENT_", "MTA_",     "RW_",  "SA_",  "TAM_"};
constexpr std::array<std::string_view, 12> kOuterFrames = {
    "ICRF", "GCRF", "EME2000", "J2000", "TOD", "TEME", "ITRF", "GTOD", "LVLH", "RSW", "RTN", "TNW"};

bool is_body(const std::string& frame) {
  for (const std::string_view start : kBodyFrames)
    if (frame.starts_with(start)) return true;
  return false;
}

bool is_outer(const std::string& frame) {
  for (const std::string_view start : kOuterFrames)
    if (frame.starts_with(start)) return true;
  return false;
}

Quat turn_about(char axis, double degrees) {
  const det::SinCos half = det::sincos(degrees * kDegree / 2);
  Quat q(half.cos, 0, 0, 0);
  (axis == 'X' ? q.x : axis == 'Y' ? q.y : q.z) = half.sin;
  return q;
}

// Reading of the records of one block.
struct AttitudeForm {
  bool quaternion = true;
  std::size_t count = 4;      // numbers of a record
  bool scalar_first = false;  // of a quaternion
  std::string axes;           // of Euler angles: "ZXZ"
  bool inverse = false;       // the product read is body_from_world
};

class AemReader {
 public:
  AemReader(const AemOptions& options, Input& input) : options_(options), input_(input) {}

  Result<SourcePtr> read(const Message& message) {
    version_ = message.version;
    for (const Block& block : message.blocks)
      if (!read_block(block, message.blocks.front())) return failed;
    if (segments_.empty() && input_.errors() == 0)
      input_.error(Code("E8001"), message.blocks.front().begin,
                   "no block has quaternions or Euler angles");
    if (input_.errors() > 0) return failed;
    std::vector<TimeSpan> spans;
    for (const auto& segment : segments_) spans.push_back(segment.span);
    auto pieces = block_pieces(spans, places_, input_, options_.strict);
    if (input_.errors() > 0) return failed;
    info_.name = input_.name();
    return segment_source(std::move(info_), options_.target, std::move(segments_),
                          std::move(pieces));
  }

 private:
  bool read_block(const Block& block, const Block& first) {
    check_present(block, kAemExpected, input_, options_.strict);
    const Field* const type = required(block, "ATTITUDE_TYPE", input_);
    if (type == nullptr) return false;
    if (type->value.starts_with("SPIN")) {
      input_.report(Code("W8002"), type->value,
                    fmt::format("attitude type {} is not read, and this block is skipped",
                                in_quotes(type->value)));
      return true;
    }
    AttitudeForm form;
    BlockTimes times;
    MethodRead method;
    if (!check_version(block) || !read_type(*type, form) || !read_form(block, form) ||
        !read_frames(block, form) || !read_times(block, times, input_) ||
        !same_metadata(block, first, kAemShared, input_) ||
        !read_method(block, "INTERPOLATION_METHOD", method, input_))
      return false;
    Samples<Quat> samples;
    std::vector<std::size_t> kept;
    if (!read_record_times(block, times.system, info_.epoch, samples.times, kept, input_,
                           options_.strict) ||
        !read_attitudes(block, form, kept, samples))
      return false;
    set_method(block, method, samples);
    if (!end_block(block, times, *info_.epoch, samples, input_, options_.strict)) return false;
    info_.system = times.system;
    segments_.push_back(std::move(samples));
    places_.push_back(block.begin);
    return true;
  }

  // Keywords that one of the versions lacks.
  bool check_version(const Block& block) {
    const auto absent = [&](std::string_view key) {
      const Field* const field = block.find(key);
      if (field == nullptr) return true;
      input_.error(Code("E8001"), field->key, fmt::format("version {}.0 has no {}", version_, key));
      return false;
    };
    if (version_ == 1) return absent("ANGVEL_FRAME");
    bool sound = absent("ATTITUDE_DIR");
    sound = absent("QUATERNION_TYPE") && sound;
    return absent("RATE_FRAME") && sound;
  }

  bool read_type(const Field& type, AttitudeForm& form) {
    const std::size_t slash = type.value.find('/');
    const std::string_view kind = type.value.substr(0, slash);
    const std::string_view rates = slash == kind.npos ? "" : type.value.substr(slash + 1);
    const bool known = rates.empty() || rates == "DERIVATIVE" || rates == "ANGVEL" ||
                       (rates == "RATE" && version_ == 1);
    form.quaternion = kind == "QUATERNION";
    if ((!form.quaternion && kind != "EULER_ANGLE") || !known) {
      input_.error(Code("E8001"), type.value,
                   fmt::format("unknown attitude type {}, expected QUATERNION or EULER_ANGLE, "
                               "alone or with /DERIVATIVE, /{}",
                               in_quotes(type.value), version_ == 1 ? "RATE" : "ANGVEL"));
      return false;
    }
    form.count = form.quaternion ? 4 : 3;
    if (!rates.empty()) form.count += form.quaternion && rates == "DERIVATIVE" ? 4 : 3;
    return true;
  }

  bool read_form(const Block& block, AttitudeForm& form) {
    if (!form.quaternion) return read_sequence(block, form);
    if (version_ != 1) return true;
    const Field* const order = required(block, "QUATERNION_TYPE", input_);
    if (order == nullptr) return false;
    form.scalar_first = order->value == "FIRST";
    if (form.scalar_first || order->value == "LAST") return true;
    input_.error(
        Code("E8001"), order->value,
        fmt::format("QUATERNION_TYPE is {}, expected FIRST or LAST", in_quotes(order->value)));
    return false;
  }

  bool read_sequence(const Block& block, AttitudeForm& form) {
    const Field* const sequence = required(block, "EULER_ROT_SEQ", input_);
    if (sequence == nullptr) return false;
    for (const char c : sequence->value)
      form.axes.push_back(c >= '1' && c <= '3' ? "XYZ"[c - '1'] : c);
    bool sound = form.axes.size() == 3;
    for (std::size_t i = 0; sound && i < 3; ++i)
      sound = form.axes[i] >= 'X' && form.axes[i] <= 'Z' &&
              (i == 0 || form.axes[i] != form.axes[i - 1]);
    if (!sound) {
      input_.error(Code("E8001"), sequence->value,
                   fmt::format("EULER_ROT_SEQ is {}, expected three axes as 312 or ZXZ",
                               in_quotes(sequence->value)));
    } else if (version_ == 1 && form.axes != "XYZ" && !said_) {
      said_ = true;
      input_.report(
          Code("N8010"), sequence->value,
          fmt::format("angles of a record are taken in the order of EULER_ROT_SEQ: {}", form.axes));
    }
    return sound;
  }

  // The body among the two frames, and the direction from one to the other.
  bool read_frames(const Block& block, AttitudeForm& form) {
    const Field* const a = required(block, "REF_FRAME_A", input_);
    const Field* const b = required(block, "REF_FRAME_B", input_);
    const Field* const direction =
        version_ == 1 ? required(block, "ATTITUDE_DIR", input_) : nullptr;
    if (a == nullptr || b == nullptr || (version_ == 1 && direction == nullptr)) return false;
    const bool from_a = direction == nullptr || direction->value == "A2B";
    if (!from_a && direction->value != "B2A") {
      input_.error(
          Code("E8001"), direction->value,
          fmt::format("ATTITUDE_DIR is {}, expected A2B or B2A", in_quotes(direction->value)));
      return false;
    }
    const std::string first = frame_name(a->value), second = frame_name(b->value);
    const bool a_body =
        is_body(first) || (!is_body(second) && is_outer(second) && !is_outer(first));
    if (is_body(first) == is_body(second) && is_outer(first) == is_outer(second))
      input_.deviation(options_.strict, b->value,
                       fmt::format("neither or both of {} and {} are known as a body: the second "
                                   "one is taken as the body",
                                   first, second),
                       "name the body SC_BODY_1");
    // numbers of A2B make a passive matrix from A to B: as a Hamilton quaternion A_from_B
    form.inverse = from_a == a_body;
    info_.frame = a_body ? second : first;
    return true;
  }

  bool read_attitudes(const Block& block, const AttitudeForm& form,
                      const std::vector<std::size_t>& kept, Samples<Quat>& samples) {
    for (const std::size_t i : kept) {
      const Record& record = block.records[i];
      if (record.count != form.count) {
        input_.error(Code("E8001"), record.line,
                     fmt::format("a record has an epoch and {} numbers, found {}", form.count,
                                 record.count));
        if (!input_.more()) return false;
        continue;
      }
      const double* const n = &block.numbers[record.first];
      std::optional<Quat> q;
      if (form.quaternion) {
        q = unit_quaternion(
            form.scalar_first ? Quat(n[0], n[1], n[2], n[3]) : Quat(n[3], n[0], n[1], n[2]), input_,
            record.line);
      } else {
        q = turn_about(form.axes[0], n[0]) * turn_about(form.axes[1], n[1]) *
            turn_about(form.axes[2], n[2]);
      }
      if (q) samples.values.push_back(form.inverse ? conjugate(*q) : *q);
      if (!input_.more()) return false;
    }
    return samples.values.size() == kept.size();
  }

  void set_method(const Block& block, const MethodRead& method, Samples<Quat>& samples) {
    samples.method = method.method;
    samples.degree = method.degree;
    if (method.method == Method::hermite) {
      input_.deviation(options_.strict, block.find("INTERPOLATION_METHOD")->value,
                       "attitudes turn evenly between records; rates are not used");
      samples.method = Method::linear;
    } else if (method.method == Method::lagrange) {
      check_degree(block, method, method.degree + 1, samples.times.size(), input_);
    }
  }

  const AemOptions& options_;
  Input& input_;
  int version_ = 1;
  bool said_ = false;
  SourceInfo info_;
  std::vector<Samples<Quat>> segments_;
  std::vector<std::string_view> places_;
};

}  // namespace

Result<SourcePtr> read_aem(const Text& text, const AemOptions& options, DiagnosticLog& log) {
  Input input(text, log);
  const Grammar grammar{"CCSDS_AEM_VERS", 2, kAemKeys, true};
  const auto message = read_message(input, grammar);
  if (!message) return failed;
  return AemReader(options, input).read(*message);
}

}  // namespace panwright::scenario
