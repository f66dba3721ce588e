#include "scenario/simulators.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text.h"
#include "scenario/internal/tracks.h"

namespace panwright::scenario {

namespace {

// Row of numbers and its line.
struct NumberRow {
  std::array<double, 4> n{};
  std::string_view line;
};

// Lines of `count` numbers each. False: E8001.
bool read_numbers(Input& input, std::size_t count, std::vector<NumberRow>& rows) {
  std::vector<std::string_view> words;
  std::string_view line;
  while (input.next_line(line)) {
    split_words(line, words);
    if (words.empty()) continue;
    if (words.size() != count) {
      input.error(
          Code("E8001"), line,
          fmt::format("expected {} in a line, found {}", counted(count, "number"), words.size()));
      continue;
    }
    NumberRow row{{}, line};
    for (std::size_t i = 0; i < count; ++i) {
      row.n[i] = input.number(words[i], "a column").value_or(0);
    }
    rows.push_back(row);
  }
  return input.errors() == 0;
}

bool ascends(const std::vector<NumberRow>& rows, Input& input) {
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (!(rows[i].n[0] > rows[i - 1].n[0]))
      input.error(Code("E8004"), rows[i].line, "the time is not after that of the line above");
  return input.errors() == 0;
}

bool same_number(std::size_t lines, std::size_t times, Input& input) {
  if (lines == times) return true;
  input.error(
      Code("E8001"), input.bytes().substr(0, 0),
      fmt::format("the file has {}, and the one of times {}", counted(lines, "line"), times));
  return false;
}

// Step of seven digits of the largest number, metres.
double printed_step(const std::vector<NumberRow>& rows) {
  double most = 0;
  for (const NumberRow& row : rows)
    for (std::size_t i = 0; i < 3; ++i) most = std::max(most, std::abs(row.n[i]));
  double step = 1e-6;
  for (; step * 1e7 <= most; step *= 10) continue;
  return step;
}

Quat from_rodrigues(const Vec3& s) {
  const double squared = dot(s, s);
  const double scale = 1 / (1 + squared);
  return normalize(Quat((1 - squared) * scale, 2 * scale * s.x, 2 * scale * s.y, 2 * scale * s.z));
}

// Columns of a table of Basilisk: time, r x y z, sigma x y z.
constexpr std::size_t kBasiliskColumns = 7;

class BasiliskReader {
 public:
  BasiliskReader(const std::string& target, Input& input) : target_(target), input_(input) {
    columns_.fill(-1);
  }

  Result<SourcePtr> read() {
    std::string_view line;
    while (input_.next_line(line)) {
      if (trimmed(line).empty()) continue;
      if (fields_in_row_ == 0) {
        if (!read_header(line)) return failed;
      } else if (!trimmed(line).starts_with('#')) {
        read_row(line);
      }
    }
    if (input_.errors() == 0 && tracks_.frames == 0)
      input_.error(Code("E8001"), input_.bytes().substr(0, 0), "the table has no row");
    if (input_.errors() > 0) return failed;
    if (!positions_.values.empty()) tracks_.positions.push_back(std::move(positions_));
    if (!rotations_.values.empty()) tracks_.rotations.push_back(std::move(rotations_));
    report_gap(tracks_.times, input_, input_.bytes().substr(0, 0));
    SourceInfo info;
    info.name = input_.name();
    return track_source(std::move(info), std::move(tracks_));
  }

 private:
  void split(std::string_view line) {
    if (line.find(',') == line.npos) return split_words(line, fields_);
    fields_.clear();
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t end = std::min(line.find(',', at), line.size());
      fields_.push_back(trimmed(line.substr(at, end - at)));
      at = end + 1;
    }
  }

  // Index of a component behind a name: "[0]", "_0", "_x".
  static std::optional<std::size_t> component(std::string_view rest) {
    if (rest.size() == 3 && rest[0] == '[' && rest[2] == ']')
      rest = rest.substr(1, 1);
    else if (rest.size() == 2 && rest[0] == '_')
      rest = rest.substr(1);
    else
      return std::nullopt;
    const std::size_t digit = std::string_view("012").find(rest[0]);
    const std::size_t letter = std::string_view("xyz").find(rest[0]);
    if (digit == std::string_view::npos && letter == std::string_view::npos) return std::nullopt;
    return std::min(digit, letter);
  }

  bool read_header(std::string_view line) {
    line = trimmed(line);
    if (line.starts_with('#')) line = trimmed(line.substr(1));
    split(line);
    fields_in_row_ = fields_.size();
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const std::string_view name = fields_[i];
      std::optional<std::size_t> column;
      if (name == "time[s]" || name == "time_s") {
        column = 0;
      } else if (name == "time[ns]" || name == "time_ns" || name == "time" || name == "times") {
        column = 0;
        time_factor_ = 1e-9;
        if (name.starts_with("time") && name.size() <= 5)
          input_.report(Code("N8010"), name, "times without a unit are taken as nanoseconds",
                        "name the column time[ns] or time[s]");
      } else if (name.starts_with("r_BN_N")) {
        if (const auto k = component(name.substr(6))) column = 1 + *k;
      } else if (name.starts_with("sigma_BN")) {
        if (const auto k = component(name.substr(8))) column = 4 + *k;
      }
      if (!column) {
        input_.report(Code("W8002"), name, fmt::format("column {} is skipped", in_quotes(name)));
      } else if (columns_[*column] >= 0) {
        input_.error(Code("E8008"), name, fmt::format("column {} stands twice", in_quotes(name)));
      } else {
        columns_[*column] = static_cast<std::ptrdiff_t>(i);
      }
    }
    return check_header(line);
  }

  bool check_header(std::string_view line) {
    const auto count = [&](std::size_t from) {
      return std::count_if(columns_.begin() + static_cast<std::ptrdiff_t>(from),
                           columns_.begin() + static_cast<std::ptrdiff_t>(from) + 3,
                           [](std::ptrdiff_t c) { return c >= 0; });
    };
    if (columns_[0] < 0)
      input_.error(Code("E8001"), line,
                   "the first line names no column of times: time[s] or time[ns]");
    for (const auto& [from, name] : {std::pair{1u, "r_BN_N"}, std::pair{4u, "sigma_BN"}})
      if (count(from) != 0 && count(from) != 3)
        input_.error(
            Code("E8001"), line,
            fmt::format("the first line names {} of the columns {}[0] to [2]", count(from), name));
    if (count(1) + count(4) == 0)
      input_.error(Code("E8001"), line, "the first line names neither r_BN_N[0] nor sigma_BN[0]");
    positions_.target = target_;
    rotations_.target = target_;
    return input_.errors() == 0;
  }

  void read_row(std::string_view line) {
    split(line);
    if (fields_.size() != fields_in_row_) {
      input_.error(Code("E8001"), line,
                   fmt::format("the row has {}, expected {}", counted(fields_.size(), "field"),
                               fields_in_row_));
      return;
    }
    std::array<double, kBasiliskColumns> n{};
    for (std::size_t i = 0; i < kBasiliskColumns; ++i) {
      if (columns_[i] < 0) continue;
      const std::string_view field = fields_[static_cast<std::size_t>(columns_[i])];
      const auto number = input_.number(field, "a column");
      if (!number) return;
      n[i] = *number;
    }
    const double time = n[0] * time_factor_;
    if (!tracks_.times.empty() && !(time > tracks_.times.back())) {
      input_.error(Code("E8004"), line, "the time is not after that of the row above");
      return;
    }
    const Vec3 sigma(n[4], n[5], n[6]);
    if (!(dot(sigma, sigma) < 1e200)) {
      input_.error(Code("E8005"), line, "the Rodrigues parameters are too large");
      return;
    }
    tracks_.times.push_back(time);
    ++tracks_.frames;
    if (columns_[1] >= 0) positions_.values.emplace_back(n[1], n[2], n[3]);
    if (columns_[4] >= 0) rotations_.values.push_back(from_rodrigues(sigma));
  }

  const std::string& target_;
  Input& input_;
  std::array<std::ptrdiff_t, kBasiliskColumns> columns_;
  std::size_t fields_in_row_ = 0;
  double time_factor_ = 1;
  std::vector<std::string_view> fields_;
  Tracks tracks_;
  PositionTrack positions_;
  RotationTrack rotations_;
};

}  // namespace

Result<SourcePtr> read_42(const FortyTwoTexts& texts, DiagnosticLog& log) {
  Input input(texts.time, log);
  std::vector<NumberRow> times;
  if (!read_numbers(input, 1, times) || !ascends(times, input)) return failed;
  if (times.empty() || (!texts.position && !texts.rotation)) {
    input.error(
        Code("E8001"), input.bytes().substr(0, 0),
        times.empty() ? "the file has no time" : "neither positions nor rotations are given");
    return failed;
  }
  Tracks tracks;
  tracks.frames = times.size();
  for (const NumberRow& row : times) tracks.times.push_back(row.n[0]);
  report_gap(tracks.times, input, input.bytes().substr(0, 0));
  if (texts.position) {
    Input positions(*texts.position, log);
    std::vector<NumberRow> rows;
    if (!read_numbers(positions, 3, rows) || !same_number(rows.size(), times.size(), positions))
      return failed;
    PositionTrack track{texts.target, {}, {}};
    for (const NumberRow& row : rows) track.values.emplace_back(row.n[0], row.n[1], row.n[2]);
    if (const double step = printed_step(rows); step > 1e-3)
      positions.report(Code("W8012"), positions.bytes().substr(0, 0),
                       fmt::format("positions of 7 digits are rounded to {:.0e} m", step),
                       "take PosR.42, relative to the reference orbit");
    tracks.positions.push_back(std::move(track));
  }
  if (texts.rotation) {
    Input rotations(*texts.rotation, log);
    std::vector<NumberRow> rows;
    if (!read_numbers(rotations, 4, rows) || !same_number(rows.size(), times.size(), rotations))
      return failed;
    RotationTrack track{texts.target, {}};
    for (const NumberRow& row : rows) {
      const auto q =
          unit_quaternion(Quat(row.n[3], row.n[0], row.n[1], row.n[2]), rotations, row.line);
      track.values.push_back(q.value_or(Quat(1, 0, 0, 0)));
      if (!rotations.more()) break;
    }
    if (rotations.errors() > 0) return failed;
    tracks.rotations.push_back(std::move(track));
  }
  SourceInfo info;
  info.name = texts.time.name;
  return track_source(std::move(info), std::move(tracks));
}

Result<SourcePtr> read_basilisk(const Text& text, const std::string& target, DiagnosticLog& log) {
  Input input(text, log);
  return BasiliskReader(target, input).read();
}

}  // namespace panwright::scenario
