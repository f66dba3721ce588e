#include "terrain/tile_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/text.h"
#include "pan/writer.h"
#include "terrain/internal/tile_levels.h"

namespace panwright::terrain {

namespace {

void fill(std::span<char> field, const std::string& text) {
  std::copy_n(text.begin(), std::min(text.size(), field.size()), field.begin());
}

// Whether the columns of a map go once round the body.
bool is_whole_turn(const DemInfo& info) {
  if (info.map.kind != Map::Kind::cylindrical) return false;
  const double turn = 2 * kPi * info.map.radius * det::cos(info.map.standard_latitude * kDegree);
  return std::fabs(info.width * info.map.dx / turn - 1) < 1e-6;
}

ChartRecord chart_of(const DemInfo& info, double step) {
  ChartRecord chart{};
  fill(chart.body, info.target);
  fill(chart.frame, info.frame);
  const Map& map = info.map;
  const bool placed = map.is_placed();
  chart.kind = static_cast<std::uint32_t>(placed ? map.kind : Map::Kind::none);
  chart.radius = placed ? map.radius : 0;
  chart.polar_radius = !placed ? 0 : map.polar_radius > 0 ? map.polar_radius : map.radius;
  chart.center_longitude = map.center_longitude;
  chart.standard_latitude = map.standard_latitude;
  chart.dx = map.dx > 0 ? map.dx : 1;
  chart.dy = map.dy > 0 ? map.dy : 1;
  chart.left = map.left + chart.dx / 2;
  chart.top = map.top - chart.dy / 2;
  chart.step = step;
  chart.low = std::numeric_limits<double>::infinity();
  chart.high = -chart.low;
  const bool wraps = is_whole_turn(info);
  chart.flags = (map.north ? kChartNorth : 0) | (wraps ? kChartWraps : 0);
  chart.width = info.width + (wraps ? 1 : 0);
  chart.height = info.height;
  chart.levels = level_count(chart.width, chart.height);
  chart.domain = static_cast<std::uint32_t>(map.domain);
  return chart;
}

// The largest power of two whose half is within an error; 0 for floats.
double step_of(double error) {
  if (!(error > 0)) return 0;
  return std::ldexp(1.0, std::ilogb(2 * error));
}

// Rows of one elevation file into tiles.
class ChartWriter {
 public:
  ChartWriter(const Dem& dem, double step, pan::Writer& out, std::uint64_t& place,
              DiagnosticLog& log, const Job& job)
      : dem_(dem),
        chart_(chart_of(dem.info(), step)),
        out_(out),
        place_(place),
        log_(log),
        job_(job),
        levels_(chart_, records_) {}

  bool run() {
    const std::string& name = dem_.info().files.front();
    Phase phase(job_, "tiling", dem_.info().height);
    bool sound = true;
    const bool all = dem_.read(
        0, dem_.info().height,
        [&](const Rows& rows) {
          for (std::uint32_t r = 0; r < rows.count && sound; ++r)
            sound = take(
                rows.heights.subspan(std::size_t{r} * dem_.info().width, dem_.info().width),
                rows.voids.subspan(std::size_t{r} * dem_.info().width, dem_.info().width), name);
          phase.advance(rows.count);
          return sound;
        },
        log_, job_);
    if (!all || !sound) return false;
    if (!(chart_.low <= chart_.high)) return complain(name, "it has no post with a height");
    std::ranges::sort(records_, [](const TileRecord& a, const TileRecord& b) {
      if (a.level != b.level) return a.level < b.level;
      return a.row != b.row ? a.row < b.row : a.column < b.column;
    });
    chart_.tile_count = static_cast<std::uint32_t>(records_.size());
    return true;
  }

  ChartRecord& chart() { return chart_; }
  std::vector<TileRecord>& records() { return records_; }

 private:
  bool complain(const std::string& name, const std::string& problem, std::string hint = {}) {
    log_.report_file(Code("E9612"), name, problem, std::move(hint));
    return false;
  }

  // One row of heights.
  bool take(std::span<const double> heights, std::span<const VoidKind> voids,
            const std::string& name) {
    row_.resize(chart_.width);
    constexpr double kMostSteps = 1 << 24;  // floats hold these multiples
    for (std::size_t x = 0; x < heights.size(); ++x) {
      const double h = heights[x];
      if (voids[x] != VoidKind::none || !std::isfinite(h)) {
        row_[x] = std::numeric_limits<float>::quiet_NaN();
        continue;
      }
      const double stored =
          chart_.step > 0 ? chart_.step * std::nearbyint(h / chart_.step) : double(float(h));
      if (!(std::fabs(stored) <= (chart_.step > 0 ? kMostSteps * chart_.step : 1e30)))
        return complain(
            name,
            fmt::format("a height of {:.6g} m is beyond what steps of {} m hold", h, chart_.step),
            "--error 0 stores floats");
      row_[x] = static_cast<float>(stored);
      chart_.error = std::max(chart_.error, std::fabs(stored - h));
      chart_.low = std::min(chart_.low, stored);
      chart_.high = std::max(chart_.high, stored);
    }
    kinds_.assign(voids.begin(), voids.end());
    if (chart_.flags & kChartWraps) {
      row_.back() = row_.front();
      kinds_.push_back(kinds_.front());
    }
    return levels_.push(
        row_, kinds_, job_, [&](TileRecord& record, std::span<const std::byte> bytes) {
          record.offset = place_;
          record.hash = hash64(bytes);
          record.length = static_cast<std::uint32_t>(bytes.size());
          static constexpr std::byte kZeros[64] = {};
          const std::size_t pad = (64 - bytes.size() % 64) % 64;
          place_ += bytes.size() + pad;
          return out_.append(bytes, log_) && out_.append(std::span(kZeros).first(pad), log_);
        });
  }

  const Dem& dem_;
  ChartRecord chart_;
  pan::Writer& out_;
  std::uint64_t& place_;
  DiagnosticLog& log_;
  const Job& job_;
  std::vector<TileRecord> records_;
  internal::TileLevels levels_;
  std::vector<float> row_;
  std::vector<VoidKind> kinds_;
};

bool same_name(std::string_view a, std::string_view b) {
  const auto folded = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, {}, folded, folded);
}

bool same_body(std::span<const Dem> dems, DiagnosticLog& log) {
  const DemInfo* first = nullptr;
  for (const Dem& dem : dems) {
    const DemInfo& info = dem.info();
    if (info.quantity == Quantity::plain) {
      log.report_file(Code("E9612"), info.files.front(), "its numbers are no elevations",
                      "--values height or radius says that they are");
      return false;
    }
    if (info.target.empty()) continue;
    if (first && !same_name(first->target, info.target)) {
      log.report_file(Code("E9612"), info.files.front(),
                      fmt::format("it is of {}, but {} of {}", in_quotes(info.target),
                                  first->files.front(), in_quotes(first->target)));
      return false;
    }
    first = &info;
  }
  return true;
}

// A pan file of one node, for its tables.
Result<pan::Contents> frame_of(std::span<const Dem> dems, const TilesOptions& options,
                               DiagnosticLog& log) {
  pan::Contents contents;
  contents.version = "panwright " PANWRIGHT_VERSION;
  contents.options = fmt::format("terrain error={}", options.error);
  contents.nodes.emplace_back();
  contents.nodes.back().name = "terrain";
  for (const Dem& dem : dems)
    for (const std::string& file : dem.info().files) {
      const auto mapped = MappedFile::open(file, log);
      if (!mapped) return failed;
      // note: the memory of a part is given back before the next one is read
      constexpr std::size_t kPart = std::size_t{1} << 24;
      Hasher hasher;
      for (std::size_t at = 0; at < mapped->bytes().size(); at += kPart) {
        const auto rest = mapped->bytes().subspan(at);
        const auto part = rest.first(std::min(kPart, rest.size()));
        hasher.update(part);
        mapped->release(part);
      }
      contents.inputs.push_back({std::filesystem::path(file).filename().string(),
                                 hasher.digest128(), mapped->bytes().size()});
    }
  return contents;
}

bool write_tail(std::span<const ChartRecord> charts, std::span<const TileRecord> records,
                std::uint64_t place, pan::Writer& out, DiagnosticLog& log) {
  TilesTail tail{};
  std::memcpy(tail.magic, "PWTERRA", 8);
  tail.version = kTilesVersion;
  tail.chart_count = static_cast<std::uint32_t>(charts.size());
  tail.tile_count = records.size();
  tail.charts_offset = place;
  tail.tiles_offset = place + charts.size_bytes();
  Hasher hasher;
  hasher.update(std::as_bytes(charts));
  hasher.update(std::as_bytes(records));
  hasher.update(std::as_bytes(std::span(&tail, 1)).first(offsetof(TilesTail, hash)));
  tail.hash = hasher.digest64();
  return out.append(std::as_bytes(charts), log) && out.append(std::as_bytes(records), log) &&
         out.append(std::as_bytes(std::span(&tail, 1)), log);
}

}  // namespace

Result<TilesReport> write_tiles(std::span<const Dem> dems, const std::filesystem::path& path,
                                const TilesOptions& options, DiagnosticLog& log, const Job& job) {
  if (!same_body(dems, log)) return failed;
  return run_job(job, log, [&]() -> Result<TilesReport> {
    const auto contents = frame_of(dems, options, log);
    if (!contents) return failed;
    auto writer = pan::Writer::create(path, log);
    if (!writer || !writer->begin(kTilesSection, 1, true, log)) return failed;
    TilesReport report;
    std::vector<ChartRecord> charts;
    std::vector<TileRecord> records;
    std::uint64_t place = 0;
    for (const Dem& dem : dems) {
      if (!(dem.info().map.dx > 0))
        log.report_file(Code("W9671"), dem.info().files.front(),
                        "the distance of pixels is not known: 1 m is taken", "--spacing METRES");
      ChartWriter chart(dem, step_of(options.error), *writer, place, log, job);
      if (!chart.run()) return failed;
      chart.chart().first_tile = static_cast<std::uint32_t>(records.size());
      charts.push_back(chart.chart());
      records.insert(records.end(), chart.records().begin(), chart.records().end());
      report.error = std::max(report.error, chart.chart().error);
    }
    if (!write_tail(charts, records, place, *writer, log) || !writer->end(log)) return failed;
    // the tables of a model of one node, as they are
    auto rest = pan::Model::from_bytes(pan::write_to_memory(*contents), path.string(), log);
    if (!rest) return failed;
    for (const pan::layout::DirectoryEntry& entry : rest->directory())
      if (!writer->begin(entry.kind, entry.stride, entry.flags & pan::layout::kSectionOptional,
                         log) ||
          !writer->append(rest->bytes().subspan(entry.offset, entry.raw_length), log) ||
          !writer->end(log))
        return failed;
    if (!writer->finish(rest->build_id(), log, nullptr, &job)) return failed;
    report.bytes = writer->bytes();
    report.tiles = records.size();
    for (const TileRecord& record : records)
      report.float_tiles += record.form == std::uint32_t(TileForm::floats);
    return report;
  });
}

}  // namespace panwright::terrain
