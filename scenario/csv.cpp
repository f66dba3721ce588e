#include "scenario/csv.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "scenario/internal/columns.h"
#include "scenario/internal/tracks.h"

namespace panwright::scenario {

namespace {

// Columns that are one vector or quaternion, or one number.
struct ColumnGroup {
  ColumnKind kind = ColumnKind::ignored;
  std::string target;
  std::string joint;
  std::size_t component = 0;                              // of a joint or lens
  std::array<std::ptrdiff_t, 4> columns{-1, -1, -1, -1};  // by component
  std::size_t size() const {
    return kind == ColumnKind::rotation ? 4
           : kind == ColumnKind::position || kind == ColumnKind::velocity ||
                   kind == ColumnKind::sun_direction
               ? 3
               : 1;
  }
};

class CsvReader {
 public:
  CsvReader(const CsvOptions& options, Input& input) : options_(options), input_(input) {}

  Result<SourcePtr> read() {
    if (!read_header()) return failed;
    std::string_view line;
    while (next_row(line))
      if (split(line)) read_row();
    if (input_.errors() > 0) return failed;
    if (tracks_.frames == 0) {
      input_.error(Code("E8001"), input_.bytes().substr(0, 0),
                   "no row follows the names of columns");
      return failed;
    }
    if (timed_) report_gap(tracks_.times, input_, columns_[time_].header);
    info_.name = input_.name();
    tracks_.method = options_.method;
    tracks_.degree = options_.degree;
    return track_source(std::move(info_), std::move(tracks_));
  }

 private:
  bool next_row(std::string_view& line) {
    while (input_.next_line(line)) {
      const std::string_view content = trimmed(line);
      if (!content.empty() && !content.starts_with('#')) return true;
    }
    return false;
  }

  bool read_header() {
    std::string_view line;
    if (!next_row(line)) {
      input_.error(Code("E8001"), input_.bytes().substr(0, 0),
                   "expected a line with the names of columns, found none");
      return false;
    }
    for (const char mark : {',', ';', '\t'})
      if (line.find(mark) != line.npos) {
        delimiter_ = mark;
        break;
      }
    if (!split(line)) return false;
    for (const std::string_view header : fields_)
      columns_.push_back(column_of(header, input_, options_.strict).value_or(Column{}));
    if (input_.errors() > 0) return false;
    for (std::size_t i = 0; i < columns_.size(); ++i) add_to_group(i);
    for (const ColumnGroup& group : groups_) check(group);
    if (std::ranges::all_of(groups_,
                            [](const ColumnGroup& g) {
                              return g.kind == ColumnKind::time || g.kind == ColumnKind::epoch;
                            }) &&
        input_.errors() == 0)
      input_.error(Code("E8001"), line, "no column holds a member of frames");
    if (input_.errors() > 0) return false;
    for (const ColumnGroup& group : groups_) add_track(group);
    return true;
  }

  void add_to_group(std::size_t index) {
    const Column& column = columns_[index];
    if (column.kind == ColumnKind::ignored) return;
    const bool time = column.kind == ColumnKind::time || column.kind == ColumnKind::epoch;
    const bool single = column.kind == ColumnKind::joint || column.kind == ColumnKind::lens;
    const auto same = [&](const ColumnGroup& g) {
      const bool both_times = g.kind == ColumnKind::time || g.kind == ColumnKind::epoch;
      return (g.kind == column.kind || (time && both_times)) && g.target == column.target &&
             g.joint == column.joint && (!single || g.component == column.component);
    };
    auto found = std::ranges::find_if(groups_, same);
    if (found == groups_.end()) {
      groups_.push_back({column.kind, column.target, column.joint, column.component});
      found = std::prev(groups_.end());
    }
    std::ptrdiff_t& place = found->columns[found->size() > 1 ? column.component : 0];
    if (place >= 0)
      input_.error(Code("E8008"), column.header,
                   fmt::format("column {} gives what {} gives", in_quotes(column.header),
                               in_quotes(columns_[static_cast<std::size_t>(place)].header)));
    place = static_cast<std::ptrdiff_t>(index);
  }

  void check(const ColumnGroup& group) {
    const Column* first = nullptr;
    for (std::size_t i = 0; i < group.size(); ++i)
      if (group.columns[i] >= 0 && first == nullptr)
        first = &columns_[static_cast<std::size_t>(group.columns[i])];
    for (std::size_t i = 0; i < group.size(); ++i) {
      if (group.columns[i] < 0) {
        input_.error(
            Code("E8001"), first->header,
            fmt::format("column {} stands without its component {}", in_quotes(first->header),
                        group.size() == 4 ? "wxyz"[i] : "xyz"[i]));
        return;
      }
      const Column& column = columns_[static_cast<std::size_t>(group.columns[i])];
      if (column.inverse != first->inverse) {
        input_.error(Code("E8001"), column.header,
                     fmt::format("column {} has another direction than {}",
                                 in_quotes(column.header), in_quotes(first->header)));
        return;
      }
    }
    if (group.kind == ColumnKind::velocity &&
        std::ranges::none_of(groups_, [&](const ColumnGroup& g) {
          return g.kind == ColumnKind::position && g.target == group.target;
        }))
      input_.error(
          Code("E8001"), first->header,
          fmt::format("column {} is a velocity without a position", in_quotes(first->header)));
  }

  void add_track(const ColumnGroup& group) {
    const Column& column = columns_[static_cast<std::size_t>(group.columns[0])];
    switch (group.kind) {
      case ColumnKind::time:
      case ColumnKind::epoch:
        timed_ = true;
        time_ = static_cast<std::size_t>(group.columns[0]);
        info_.epoch = column.epoch;
        info_.system = column.system;
        break;
      case ColumnKind::position:
        tracks_.positions.push_back({group.target, {}, {}});
        break;
      case ColumnKind::rotation:
        tracks_.rotations.push_back({group.target, {}});
        break;
      case ColumnKind::joint:
        tracks_.joints.push_back({group.target, group.joint, group.component, {}});
        break;
      case ColumnKind::lens:
        tracks_.lens.push_back({static_cast<LensNumber>(group.component), {}});
        break;
      default:
        break;
    }
  }

  // Fields of a line; reports a wrong number of them.
  bool split(std::string_view line) {
    fields_.clear();
    std::size_t at = 0;
    for (;;) {
      while (at < line.size() && line[at] != delimiter_ && is_blank_char(line[at])) ++at;
      std::size_t end = 0;
      if (at < line.size() && line[at] == '"') {
        end = at + 1;
        while (end < line.size() &&
               (line[end] != '"' || (end + 1 < line.size() && line[end + 1] == '"')))
          end += line[end] == '"' ? 2 : 1;
        if (end >= line.size()) {
          input_.error(Code("E8001"), line.substr(at), "the quotes that begin here are not closed");
          return false;
        }
        fields_.push_back(line.substr(at + 1, end - at - 1));
        end = std::min(line.find(delimiter_, end), line.size());
      } else {
        end = std::min(line.find(delimiter_, at), line.size());
        fields_.push_back(trimmed(line.substr(at, end - at)));
      }
      if (end >= line.size()) break;
      at = end + 1;
    }
    if (columns_.empty() || fields_.size() == columns_.size()) return true;
    input_.error(Code("E8001"), line,
                 fmt::format("the row has {}, expected {}", counted(fields_.size(), "field"),
                             columns_.size()));
    return false;
  }

  // Time of the row; false: reported.
  bool read_time(double& time) {
    const Column& column = columns_[time_];
    const std::string_view field = fields_[time_];
    if (column.kind == ColumnKind::epoch) {
      std::string problem;
      const auto epoch = parse_epoch(field, column.system, problem);
      if (!epoch) {
        input_.error(Code("E8001"), field, problem);
        return false;
      }
      if (!info_.epoch) info_.epoch = epoch;
      time = seconds_between(*info_.epoch, *epoch);
    } else {
      const auto value = input_.number(field, column.header);
      if (!value) return false;
      time = *value * column.factor;
    }
    if (tracks_.times.empty() || time > tracks_.times.back()) return true;
    input_.error(Code("E8004"), field,
                 fmt::format("time {} is not after that of the row above", in_quotes(field)));
    return false;
  }

  std::optional<double> value(std::ptrdiff_t index) {
    const Column& column = columns_[static_cast<std::size_t>(index)];
    const std::string_view field = fields_[static_cast<std::size_t>(index)];
    const auto number = input_.number(field, column.header);
    return number ? std::optional(*number * column.factor) : std::nullopt;
  }

  void read_row() {
    double time = 0;
    if (timed_ && !read_time(time)) return;
    std::size_t position = 0, rotation = 0, joint = 0, lens = 0;
    for (const ColumnGroup& group : groups_) {
      std::array<double, 4> n{};
      const bool numbers = group.kind != ColumnKind::time && group.kind != ColumnKind::epoch &&
                           group.kind != ColumnKind::name && group.kind != ColumnKind::seed;
      for (std::size_t i = 0; numbers && i < group.size(); ++i) {
        const auto number = value(group.columns[i]);
        if (!number) return;
        n[i] = *number;
      }
      const Vec3 vector(n[0], n[1], n[2]);
      const std::string_view field = fields_[static_cast<std::size_t>(group.columns[0])];
      if (group.kind == ColumnKind::position) {
        tracks_.positions[position++].values.push_back(vector);
      } else if (group.kind == ColumnKind::velocity) {
        std::ranges::find(tracks_.positions, group.target, &PositionTrack::target)
            ->velocities.push_back(vector);
      } else if (group.kind == ColumnKind::rotation) {
        auto q = unit_quaternion(Quat(n[0], n[1], n[2], n[3]), input_, field);
        if (!q) return;
        if (columns_[static_cast<std::size_t>(group.columns[0])].inverse) q = conjugate(*q);
        tracks_.rotations[rotation++].values.push_back(*q);
      } else if (group.kind == ColumnKind::joint) {
        tracks_.joints[joint++].values.push_back(n[0]);
      } else if (group.kind == ColumnKind::lens) {
        tracks_.lens[lens++].values.push_back(n[0]);
      } else if (group.kind == ColumnKind::sun_direction) {
        const double length = glm::length(vector);
        if (!(length > 0) || !std::isfinite(length)) {
          input_.error(Code("E8001"), field, "the direction of the Sun has no length");
          return;
        }
        tracks_.sun_directions.push_back(vector / length);
      } else if (!read_other(group.kind, n[0], field)) {
        return;
      }
    }
    if (timed_) tracks_.times.push_back(time);
    ++tracks_.frames;
  }

  bool read_other(ColumnKind kind, double number, std::string_view field) {
    if (kind == ColumnKind::sun_distance) {
      if (!(number > 0)) {
        input_.error(Code("E8001"), field, "the distance of the Sun is not above 0");
        return false;
      }
      tracks_.sun_distances.push_back(number);
    } else if (kind == ColumnKind::name) {
      std::string name(field);
      for (std::size_t at = 0; (at = name.find("\"\"", at)) != name.npos; ++at) name.erase(at, 1);
      tracks_.names.push_back(std::move(name));
    } else if (kind == ColumnKind::seed) {
      std::uint64_t seed = 0;
      const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), seed);
      if (error != std::errc() || end != field.data() + field.size()) {
        input_.error(
            Code("E8001"), field,
            fmt::format("expected a whole number for the seed, found {}", in_quotes(field)));
        return false;
      }
      tracks_.seeds.push_back(seed);
    }
    return true;
  }

  const CsvOptions& options_;
  Input& input_;
  char delimiter_ = ',';
  std::vector<std::string_view> fields_;
  std::vector<Column> columns_;
  std::vector<ColumnGroup> groups_;
  bool timed_ = false;
  std::size_t time_ = 0;
  SourceInfo info_;
  Tracks tracks_;
};

}  // namespace

Result<SourcePtr> read_csv(const Text& text, const CsvOptions& options, DiagnosticLog& log) {
  Input input(text, log);
  return CsvReader(options, input).read();
}

}  // namespace panwright::scenario
