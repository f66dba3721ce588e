#include "scenario/internal/ccsds.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/text.h"

namespace panwright::scenario {

namespace {

constexpr std::array<std::string_view, 4> kHeaderKeys = {"CREATION_DATE", "ORIGINATOR",
                                                         "MESSAGE_ID", "CLASSIFICATION"};
constexpr std::size_t kMaxRecordNumbers = 10;
constexpr std::size_t kMaxBlocks = 10'000;

// Reader of the lines of one message.
class MessageReader {
 public:
  MessageReader(Input& input, const Grammar& grammar) : input_(input), grammar_(grammar) {}

  Result<Message> read() {
    std::string_view line;
    while (input_.next_line(line)) {
      line = trimmed(line);
      if (line.empty() || line == "COMMENT" || line.starts_with("COMMENT ") ||
          line.starts_with("COMMENT\t"))
        continue;
      if (state_ == State::version) {
        if (!read_version(line)) return failed;
      } else {
        read_line(line);
      }
    }
    if (state_ == State::version)
      input_.error(
          Code("E8001"), input_.bytes().substr(0, 0),
          fmt::format("expected {} in the first line, found an empty text", grammar_.version_key));
    else if (state_ != State::body && state_ != State::records)
      input_.error(Code("E8001"), last_mark_, "the text ends within the section that begins here");
    else if (message_.blocks.empty())
      input_.error(Code("E8001"), input_.bytes().substr(0, 0),
                   "no block of metadata and data: expected META_START");
    if (input_.errors() > 0) return failed;
    return std::move(message_);
  }

 private:
  enum class State { version, body, meta, records, data, covariance };

  bool read_version(std::string_view line) {
    const auto [key, value] = field_of(line);
    if (key != grammar_.version_key) {
      input_.error(
          Code("E8001"), line,
          fmt::format("expected '{} = …' first, found {}", grammar_.version_key, in_quotes(line)));
      return false;
    }
    for (int version = 1; version <= grammar_.versions; ++version)
      if (value == fmt::format("{}.0", version)) message_.version = version;
    if (message_.version == 0) {
      input_.error(Code("E8001"), value,
                   fmt::format("{} is {}; versions 1.0 to {}.0 are read", key, in_quotes(value),
                               grammar_.versions));
      return false;
    }
    state_ = State::body;
    return true;
  }

  static Field field_of(std::string_view line) {
    const std::size_t at = line.find('=');
    if (at == line.npos) return {};
    return {trimmed(line.substr(0, at)), trimmed(line.substr(at + 1))};
  }

  void read_line(std::string_view line) {
    if (line.find('=') != line.npos) {
      read_field(line);
    } else if (line.ends_with("_START") || line.ends_with("_STOP")) {
      read_mark(line);
    } else if (state_ == State::covariance) {
      read_covariance(line);
    } else if (state_ == (grammar_.data_marks ? State::data : State::records)) {
      read_record(line);
    } else {
      input_.error(Code("E8001"), line,
                   fmt::format("unexpected line {} {}", in_quotes(line), place()));
    }
  }

  const char* place() const {
    switch (state_) {
      case State::meta:
        return "in metadata, where KEYWORD = VALUE stands";
      case State::records:
        return "between the metadata and DATA_START";
      default:
        return "outside a block";
    }
  }

  void read_field(std::string_view line) {
    const Field field = field_of(line);
    if (field.value.empty() || field.key.empty()) {
      input_.error(Code("E8001"), line, "expected KEYWORD = VALUE, found " + in_quotes(line));
      return;
    }
    if (state_ == State::body && message_.blocks.empty()) {
      check_key(field, kHeaderKeys);
    } else if (state_ == State::meta) {
      if (!check_key(field, grammar_.keys)) return;
      Block& block = message_.blocks.back();
      if (!block.fields.emplace(field.key, field).second)
        input_.error(Code("E8001"), field.key, fmt::format("{} stands twice", field.key));
    } else if (state_ == State::covariance) {
      if (field.key == "EPOCH") finish_matrix(line);
      if (field.key != "EPOCH" && field.key != "COV_REF_FRAME")
        input_.error(Code("E8001"), field.key,
                     fmt::format("unknown keyword {} in a covariance, expected EPOCH or "
                                 "COV_REF_FRAME",
                                 in_quotes(field.key)));
    } else {
      input_.error(
          Code("E8001"), field.key,
          fmt::format("keyword {} stands outside of header and metadata", in_quotes(field.key)));
    }
  }

  bool check_key(const Field& field, std::span<const std::string_view> known) {
    if (std::ranges::find(known, field.key) != known.end()) return true;
    const auto near = nearest_name(field.key, known);
    input_.error(Code("E8001"), field.key, "unknown keyword " + in_quotes(field.key),
                 near ? fmt::format("did you mean '{}'?", *near) : std::string());
    return false;
  }

  void read_mark(std::string_view mark) {
    const bool between = state_ == State::body || (state_ == State::records && !needs_data());
    if (mark == "META_START" && between && message_.blocks.size() >= kMaxBlocks) {
      input_.error(Code("E8001"), mark, fmt::format("the message has over {} blocks", kMaxBlocks));
      return;
    }
    if (mark == "META_START" && between) {
      state_ = State::meta;
      message_.blocks.emplace_back().begin = mark;
    } else if (mark == "META_STOP" && state_ == State::meta) {
      state_ = State::records;
    } else if (mark == "DATA_START" && grammar_.data_marks && state_ == State::records) {
      state_ = State::data;
    } else if (mark == "DATA_STOP" && state_ == State::data) {
      state_ = State::body;
    } else if (mark == "COVARIANCE_START" && !grammar_.data_marks && state_ == State::records) {
      state_ = State::covariance;
      row_ = kWholeMatrix;
    } else if (mark == "COVARIANCE_STOP" && state_ == State::covariance) {
      finish_matrix(mark);
      state_ = State::records;
    } else {
      input_.error(Code("E8001"), mark, fmt::format("unexpected {}", in_quotes(mark)));
      return;
    }
    last_mark_ = mark;
  }

  // Whether DATA_START must follow.
  bool needs_data() const { return grammar_.data_marks; }

  void read_record(std::string_view line) {
    Block& block = message_.blocks.back();
    split_words(line, words_);
    if (words_.size() - 1 > kMaxRecordNumbers) {
      input_.error(Code("E8001"), line,
                   fmt::format("a record has an epoch and at most {} numbers, found {} words",
                               kMaxRecordNumbers, words_.size()));
      return;
    }
    Record record{line, words_[0], block.numbers.size(), words_.size() - 1};
    for (std::size_t i = 1; i < words_.size(); ++i)
      block.numbers.push_back(input_.number(words_[i], "a record").value_or(0));
    block.records.push_back(record);
  }

  // Rows of the lower triangle of 6 × 6; they are checked and not kept.
  void read_covariance(std::string_view line) {
    split_words(line, words_);
    if (row_ >= kWholeMatrix) {
      input_.error(Code("E8001"), line, "a covariance has 6 rows and begins with EPOCH = …");
      return;
    }
    ++row_;
    if (words_.size() != row_)
      input_.error(Code("E8001"), line,
                   fmt::format("row {} of a covariance has {}, found {}", row_,
                               counted(row_, "number"), words_.size()));
    for (const std::string_view word : words_) (void)input_.number(word, "a covariance");
  }

  void finish_matrix(std::string_view at) {
    if (row_ != kWholeMatrix)
      input_.error(Code("E8001"), at, fmt::format("a covariance has 6 rows, found {}", row_));
    row_ = 0;
  }

  static constexpr std::size_t kWholeMatrix = 6;
  Input& input_;
  const Grammar& grammar_;
  Message message_;
  State state_ = State::version;
  std::string_view last_mark_;
  std::size_t row_ = kWholeMatrix;
  std::vector<std::string_view> words_;
};

std::optional<Epoch> optional_epoch(const Block& block, std::string_view key, TimeSystem system,
                                    Input& input) {
  const Field* const field = block.find(key);
  return field == nullptr ? std::nullopt : read_epoch(field->value, system, input);
}

}  // namespace

const Field* Block::find(std::string_view key) const {
  const auto found = fields.find(key);
  return found == fields.end() ? nullptr : &found->second;
}

Result<Message> read_message(Input& input, const Grammar& grammar) {
  const std::string_view text = input.bytes();
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first != text.npos && text[first] == '<') return read_xml_message(input, grammar);
  return MessageReader(input, grammar).read();
}

std::string capitals(std::string_view name) {
  std::string out(name);
  for (char& c : out)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return out;
}

std::string frame_name(std::string_view name) {
  std::string out = capitals(name);
  return out == "J2000" ? "EME2000" : out;
}

const Field* required(const Block& block, std::string_view key, Input& input) {
  const Field* const field = block.find(key);
  if (field == nullptr)
    input.error(Code("E8001"), block.begin, fmt::format("the metadata have no {}", key));
  return field;
}

void check_present(const Block& block, std::span<const std::string_view> keys, Input& input,
                   bool strict) {
  for (const std::string_view key : keys)
    if (block.find(key) == nullptr)
      input.deviation(strict, block.begin, fmt::format("the metadata have no {}", key));
}

bool same_metadata(const Block& block, const Block& first, std::span<const std::string_view> keys,
                   Input& input) {
  const auto other = [&](std::string_view key) -> std::pair<const Field*, const Field*> {
    const Field* const a = block.find(key);
    const Field* const b = first.find(key);
    if (a == nullptr || b == nullptr || frame_name(a->value) == frame_name(b->value)) return {};
    return {a, b};
  };
  for (const std::string_view key : keys)
    if (const auto [a, b] = other(key); a != nullptr) {
      input.error(Code("E8001"), a->value,
                  fmt::format("{} is {}, and {} in the first block", key, in_quotes(a->value),
                              in_quotes(b->value)),
                  "divide the file: one object in one frame is a source");
      return false;
    }
  if (const auto [a, b] = other("TIME_SYSTEM"); a != nullptr) {
    input.error(Code("E8007"), a->value,
                fmt::format("TIME_SYSTEM is {}, and {} in the first block; one message has one",
                            in_quotes(a->value), in_quotes(b->value)));
    return false;
  }
  return true;
}

std::optional<Epoch> read_epoch(std::string_view text, TimeSystem system, Input& input) {
  std::string problem;
  const auto epoch = parse_epoch(text, system, problem);
  if (!epoch) input.error(Code("E8001"), text, problem);
  return epoch;
}

bool read_times(const Block& block, BlockTimes& out, Input& input) {
  const std::size_t before = input.errors();
  const Field* const system = required(block, "TIME_SYSTEM", input);
  if (system == nullptr) return false;
  const auto named = time_system_named(system->value);
  if (!named) {
    input.error(Code("E8007"), system->value,
                fmt::format("time system {} is not read, expected UTC, TAI, TT, TDB or GPS",
                            in_quotes(system->value)));
    return false;
  }
  out.system = *named;
  for (const std::string_view key : {"START_TIME", "STOP_TIME"}) (void)required(block, key, input);
  out.start = optional_epoch(block, "START_TIME", *named, input);
  out.stop = optional_epoch(block, "STOP_TIME", *named, input);
  out.useable_start = optional_epoch(block, "USEABLE_START_TIME", *named, input);
  out.useable_stop = optional_epoch(block, "USEABLE_STOP_TIME", *named, input);
  if (out.start && out.stop && *out.stop < *out.start)
    input.error(Code("E8004"), block.find("STOP_TIME")->value, "STOP_TIME is before START_TIME");
  return input.errors() == before;
}

bool read_record_times(const Block& block, TimeSystem system, std::optional<Epoch>& epoch,
                       std::vector<double>& times, std::vector<std::size_t>& kept, Input& input,
                       bool strict) {
  const std::size_t before = input.errors();
  std::optional<Epoch> last;
  for (std::size_t i = 0; i < block.records.size(); ++i) {
    const Record& record = block.records[i];
    const auto read = read_epoch(record.epoch, system, input);
    if (!read) {
      if (!input.more()) return false;
      continue;
    }
    if (last && *read < *last) {
      input.error(Code("E8004"), record.epoch,
                  fmt::format("epoch {} is before the one above", in_quotes(record.epoch)));
      if (!input.more()) return false;
    } else if (last && *read == *last) {
      const Record& same = block.records[kept.back()];
      const auto numbers = [&](const Record& r) {
        return std::span(block.numbers).subspan(r.first, r.count);
      };
      if (!std::ranges::equal(numbers(record), numbers(same)))
        input.error(
            Code("E8004"), record.epoch,
            fmt::format("epoch {} stands twice, with other values", in_quotes(record.epoch)));
      else
        input.deviation(strict, record.epoch, "the record repeats the one above");
    } else {
      if (!epoch) epoch = *read;
      times.push_back(seconds_between(*epoch, *read));
      kept.push_back(i);
      last = read;
    }
  }
  if (block.records.empty())
    input.error(Code("E8001"), block.begin, "no record follows these metadata");
  return input.errors() == before;
}

TimeSpan useable_span(const Block& block, const BlockTimes& block_times, const Epoch& epoch,
                      const std::vector<double>& times, Input& input, bool strict) {
  const TimeSpan records{times.front(), times.back()};
  const auto seconds = [&](const std::optional<Epoch>& at, double otherwise) {
    return at ? seconds_between(epoch, *at) : otherwise;
  };
  const TimeSpan stated{seconds(block_times.start, records.begin),
                        seconds(block_times.stop, records.end)};
  if (records.begin < stated.begin || records.end > stated.end)
    input.deviation(strict, block.begin,
                    "records lie outside of START_TIME to STOP_TIME; they are read");
  const TimeSpan useable{seconds(block_times.useable_start, records.begin),
                         seconds(block_times.useable_stop, records.end)};
  const TimeSpan out{std::max(useable.begin, records.begin), std::min(useable.end, records.end)};
  if (out.begin != useable.begin || out.end != useable.end)
    input.deviation(strict, block.begin,
                    fmt::format("the usable span is {} s to {} s, and the records cover {} s to {} "
                                "s; only times in both count",
                                useable.begin, useable.end, records.begin, records.end));
  return out;
}

bool read_method(const Block& block, std::string_view key, MethodRead& out, Input& input) {
  const std::size_t before = input.errors();
  const Field* const method = block.find(key);
  const Field* const degree = block.find("INTERPOLATION_DEGREE");
  if (method == nullptr) return true;
  out.stated = true;
  const std::string name = capitals(method->value);
  if (name == "HERMITE")
    out.method = Method::hermite;
  else if (name == "LAGRANGE")
    out.method = Method::lagrange;
  else if (name == "LINEAR")
    out.method = Method::linear;
  else
    input.error(Code("E8001"), method->value,
                fmt::format("unknown method {}, expected HERMITE, LAGRANGE or LINEAR",
                            in_quotes(method->value)));
  if (degree != nullptr) {
    const auto value = parse_double(degree->value);
    if (!value || *value != std::floor(*value) || *value < 1 || *value > 1000)
      input.error(Code("E8001"), degree->value,
                  fmt::format("INTERPOLATION_DEGREE is {}, expected a whole number from 1 on",
                              in_quotes(degree->value)));
    else
      out.degree = static_cast<std::size_t>(*value);
  } else if (out.method != Method::linear) {
    input.error(Code("E8001"), method->value, fmt::format("{} needs INTERPOLATION_DEGREE", key));
  }
  if (out.method == Method::linear) out.degree = 1;
  return input.errors() == before;
}

void check_degree(const Block& block, const MethodRead& method, std::size_t needed,
                  std::size_t records, Input& input) {
  if (needed <= records && needed <= kMaxNodes) return;
  input.report(Code("W8012"), block.begin,
               fmt::format("degree {} needs {}; of {} used, the degree is lower", method.degree,
                           counted(needed, "record"), std::min(records, kMaxNodes)));
}

std::vector<Piece> block_pieces(const std::vector<TimeSpan>& spans,
                                const std::vector<std::string_view>& places, Input& input,
                                bool strict) {
  std::size_t overlaps = 0;
  std::vector<Piece> out = pieces_of(spans, overlaps);
  if (overlaps < spans.size())
    input.deviation(strict, places[overlaps],
                    fmt::format("the usable span of this block, {} s to {} s, overlaps that of a "
                                "block before, which counts there",
                                spans[overlaps].begin, spans[overlaps].end));
  return out;
}

}  // namespace panwright::scenario
