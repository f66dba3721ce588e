#include "terrain/tile_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>

#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/text.h"
#include "pan/writer.h"
#include "terrain/internal/albedo_writer.h"
#include "terrain/internal/blend.h"
#include "terrain/internal/stored_map.h"
#include "terrain/internal/tile_levels.h"

namespace panwright::terrain {

namespace {

void fill(std::span<char> field, const std::string& text) {
  std::copy_n(text.begin(), std::min(text.size(), field.size()), field.begin());
}

ChartRecord chart_of(const DemInfo& info, double step) {
  ChartRecord chart{};
  fill(chart.body, info.target);
  fill(chart.frame, info.frame);
  const Map& map = info.map;
  internal::store_map(map, chart);
  chart.left = map.left + chart.dx / 2;
  chart.top = map.top - chart.dy / 2;
  chart.step = step;
  chart.low = std::numeric_limits<double>::infinity();
  chart.high = -chart.low;
  const bool wraps = info.map.is_whole_turn(info.width);
  chart.flags = (map.north ? kChartNorth : 0) | (wraps ? kChartWraps : 0);
  chart.width = info.width + (wraps ? 1 : 0);
  chart.height = info.height;
  chart.levels = level_count(chart.width, chart.height);
  return chart;
}

// Appends bytes up to a multiple of 64.
bool append_padded(std::span<const std::byte> bytes, pan::Writer& out, std::uint64_t& place,
                   DiagnosticLog& log) {
  static constexpr std::byte kZeros[64] = {};
  const std::size_t pad = (64 - bytes.size() % 64) % 64;
  place += bytes.size() + pad;
  return out.append(bytes, log) && out.append(std::span(kZeros).first(pad), log);
}

// The largest power of two whose half is within an error; 0 for floats.
double step_of(double error) {
  if (!(error > 0)) return 0;
  return std::ldexp(1.0, std::ilogb(2 * error));
}

// Rows of one part into tiles.
class ChartWriter {
 public:
  ChartWriter(const DemPart& dem, double step, pan::Writer& out, std::uint64_t& place,
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
  // Before run(): what takes its rows, and what changes them.
  void add_window(internal::HeightWindow& window) { windows_.push_back(&window); }
  void set_blend(internal::Blend& blend) { blend_ = &blend; }

 private:
  bool complain(const std::string& name, const std::string& problem, std::string hint = {}) {
    log_.report_file(Code("E9612"), name, problem, std::move(hint));
    return false;
  }

  // One row of heights.
  bool take(std::span<const double> heights, std::span<const VoidKind> voids,
            const std::string& name) {
    row_.resize(chart_.width);
    if (blend_ != nullptr) {
      blended_.assign(heights.begin(), heights.end());
      for (std::size_t x = 0; x < heights.size(); ++x)
        if (voids[x] != VoidKind::none) blended_[x] = std::numeric_limits<double>::quiet_NaN();
      blend_->apply(row_number_, blended_);
      heights = blended_;
    }
    ++row_number_;
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
    for (internal::HeightWindow* window : windows_) window->push(row_);
    return levels_.push(row_, kinds_, job_,
                        [&](TileRecord& record, std::span<const std::byte> bytes) {
                          record.offset = place_;
                          record.hash = hash64(bytes);
                          record.length = static_cast<std::uint32_t>(bytes.size());
                          return append_padded(bytes, out_, place_, log_);
                        });
  }

  const DemPart& dem_;
  ChartRecord chart_;
  pan::Writer& out_;
  std::uint64_t& place_;
  DiagnosticLog& log_;
  const Job& job_;
  std::vector<TileRecord> records_;
  internal::TileLevels levels_;
  std::vector<float> row_;
  std::vector<VoidKind> kinds_;
  std::vector<double> blended_;
  std::uint32_t row_number_ = 0;
  std::vector<internal::HeightWindow*> windows_;
  internal::Blend* blend_ = nullptr;
};

// Says what a blend does that nobody may want.
void warn_of_blend(const DemPart& part, const internal::BlendReport& found, DiagnosticLog& log) {
  const std::string name =
      (part.place().empty() ? "" : part.place() + ": ") + in_quotes(part.info().files.front());
  const std::uint64_t border = found.posts + found.without;
  if (found.without > 0)
    log.report(Code("W9614"), {},
               fmt::format("{}: {} of {} posts of the border have nothing below to blend into",
                           name, found.without, border),
               "they keep their heights; a part that nothing lies below needs no blend");
  if (found.posts == 0) return;
  constexpr double kMostSlope = 0.1;
  // 3t² - 2t³ rises by 1.5 at most
  const double slope = 1.5 * found.step / part.blend();
  if (slope <= kMostSlope) return;
  const auto count = static_cast<double>(found.posts);
  const double mean = found.sum / count;
  const double rest = std::sqrt(std::max(0.0, found.squares / count - mean * mean));
  log.report(Code("W9614"), {},
             fmt::format("{}: the border is up to {:.3g} m off the terrain below, {:.3g} m in the "
                         "mean: the band of {:.6g} m has slopes of {:.2g} degrees of its own",
                         name, found.step, mean, part.blend(), det::atan(slope) / kDegree),
             std::fabs(mean) > 2 * rest
                 ? fmt::format("raise=\"{:.3g}m\" takes the mean away", -mean)
                 : "a wider band is flatter");
}

// Windows and blends of parts, the first first.
struct Blends {
  std::vector<std::vector<std::unique_ptr<internal::HeightWindow>>>
      windows;                                           // by part, of those below
  std::vector<std::unique_ptr<internal::Blend>> blends;  // by part; null: none

  // Fails: E9613.
  bool plan(std::span<const DemPart> parts, DiagnosticLog& log) {
    windows.resize(parts.size());
    blends.resize(parts.size());
    std::uint64_t held = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (!(parts[i].blend() > 0)) continue;
      const ChartRecord own = chart_of(parts[i].info(), 0);
      std::vector<const internal::HeightWindow*> below;
      for (std::size_t k = i + 1; k < parts.size(); ++k) {
        windows[i].push_back(std::make_unique<internal::HeightWindow>(chart_of(parts[k].info(), 0),
                                                                      own, parts[i].blend()));
        below.push_back(windows[i].back().get());
        held += below.back()->posts();
      }
      blends[i] = std::make_unique<internal::Blend>(own, parts[i].blend(), std::move(below));
    }
    if (held <= internal::HeightWindow::kMostPosts) return true;
    const auto first = std::ranges::find_if(parts, [](const DemPart& p) { return p.blend() > 0; });
    log.report(Code("E9613"), {},
               fmt::format("{}{}blending needs {} posts of the files below at once, more than {}",
                           first->place(), first->place().empty() ? "" : ": ", held,
                           internal::HeightWindow::kMostPosts),
               "a smaller part, or a file below that is reduced, needs fewer");
    return false;
  }
};

bool same_name(std::string_view a, std::string_view b) {
  const auto folded = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, {}, folded, folded);
}

bool same_body(std::span<const DemPart> dems, const std::vector<AlbedoPart>& albedo,
               DiagnosticLog& log) {
  std::vector<std::pair<const DemInfo*, std::string>> all;  // and their places
  for (const DemPart& dem : dems) {
    all.emplace_back(&dem.info(), dem.place());
    if (dem.info().quantity != Quantity::plain) continue;
    log.report_file(Code("E9612"), dem.info().files.front(), "its numbers are no elevations",
                    "--values height or radius says that they are");
    return false;
  }
  for (const AlbedoPart& part : albedo) all.emplace_back(&part.bands[0].info(), part.place);
  const DemInfo* first = nullptr;
  for (const auto& [info, place] : all) {
    if (info->target.empty()) continue;
    if (first && !same_name(first->target, info->target)) {
      log.report_file(
          Code("E9612"), info->files.front(),
          fmt::format("{}it is of {}, but {} of {}", place.empty() ? "" : place + ": ",
                      in_quotes(info->target), first->files.front(), in_quotes(first->target)));
      return false;
    }
    first = info;
  }
  return true;
}

// A pan file of one node, for its tables.
Result<pan::Contents> frame_of(std::span<const DemPart> dems, const TilesOptions& options,
                               DiagnosticLog& log) {
  pan::Contents contents;
  contents.version = "panwright " PANWRIGHT_VERSION;
  contents.options = fmt::format("terrain error={}", options.error);
  for (const DemPart& part : dems) contents.options += part.words();
  for (const AlbedoPart& part : options.albedo)
    contents.options += fmt::format(" albedo white={}", part.white.value_or(0));
  if (options.material) contents.materials.push_back(*options.material);
  contents.nodes.emplace_back();
  contents.nodes.back().name = "terrain";
  std::vector<std::string> files;
  const auto add = [&](const DemInfo& info) {
    files.insert(files.end(), info.files.begin(), info.files.end());
  };
  for (const DemPart& dem : dems) add(dem.info());
  for (const AlbedoPart& part : options.albedo) add(part.bands[0].info());
  for (const std::string& file : files) {
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
    contents.inputs.push_back({std::filesystem::path(file).filename().string(), hasher.digest128(),
                               mapped->bytes().size()});
  }
  return contents;
}

// Charts, tiles and albedo maps, in their order.
struct Written {
  std::vector<ChartRecord> charts;
  std::vector<TileRecord> records;
  std::vector<AlbedoRecord> maps;
  std::vector<AlbedoTile> albedo;
  std::uint64_t bytes = 0;  // of tiles
};

bool write_tail(const Written& written, pan::Writer& out, DiagnosticLog& log) {
  const std::span charts(written.charts);
  const std::span records(written.records);
  std::vector<std::span<const std::byte>> lists = {std::as_bytes(charts), std::as_bytes(records)};
  AlbedoHead head{};
  head.map_count = static_cast<std::uint32_t>(written.maps.size());
  head.tile_count = static_cast<std::uint32_t>(written.albedo.size());
  if (head.map_count > 0)
    lists.insert(lists.end(),
                 {std::as_bytes(std::span(&head, 1)), std::as_bytes(std::span(written.maps)),
                  std::as_bytes(std::span(written.albedo))});
  TilesTail tail{};
  std::memcpy(tail.magic, "PWTERRA", 8);
  tail.version = head.map_count > 0 ? kTilesVersion : kTilesVersion - 1;
  tail.chart_count = static_cast<std::uint32_t>(charts.size());
  tail.tile_count = records.size();
  tail.charts_offset = written.bytes;
  tail.tiles_offset = written.bytes + charts.size_bytes();
  Hasher hasher;
  for (const auto& list : lists) {
    hasher.update(list);
    if (!out.append(list, log)) return false;
  }
  hasher.update(std::as_bytes(std::span(&tail, 1)).first(offsetof(TilesTail, hash)));
  tail.hash = hasher.digest64();
  return out.append(std::as_bytes(std::span(&tail, 1)), log);
}

}  // namespace

Result<TilesReport> write_tiles(std::span<const Dem> dems, const std::filesystem::path& path,
                                const TilesOptions& options, DiagnosticLog& log, const Job& job) {
  std::vector<DemPart> parts;
  for (const Dem& dem : dems) parts.emplace_back(dem);
  return write_parts(parts, path, options, log, job);
}

namespace {

bool write_charts(std::span<const DemPart> parts, const TilesOptions& options, pan::Writer& writer,
                  Written& out, DiagnosticLog& log, const Job& job) {
  Blends all;
  if (!all.plan(parts, log)) return false;
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // what others lead to comes before them
  if (std::ranges::any_of(all.blends, [](const auto& blend) { return blend != nullptr; }))
    std::ranges::reverse(order);
  std::vector<ChartRecord> charts(parts.size());
  std::vector<std::vector<TileRecord>> records(parts.size());
  for (const std::size_t i : order) {
    const DemPart& part = parts[i];
    if (!(part.info().map.dx > 0))
      log.report_file(Code("W9671"), part.info().files.front(),
                      "the distance of pixels is not known: 1 m is taken", "--spacing METRES");
    ChartWriter chart(part, step_of(options.error), writer, out.bytes, log, job);
    if (all.blends[i]) chart.set_blend(*all.blends[i]);
    for (std::size_t above = 0; above < i; ++above)
      if (all.blends[above]) chart.add_window(*all.windows[above][i - above - 1]);
    if (!chart.run()) return false;
    if (all.blends[i]) warn_of_blend(part, all.blends[i]->report(), log);
    all.windows[i].clear();
    charts[i] = chart.chart();
    records[i] = std::move(chart.records());
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    charts[i].first_tile = static_cast<std::uint32_t>(out.records.size());
    out.charts.push_back(charts[i]);
    out.records.insert(out.records.end(), records[i].begin(), records[i].end());
  }
  return true;
}

bool write_albedos(const DemInfo& ground, const TilesOptions& options, pan::Writer& writer,
                   Written& out, DiagnosticLog& log, const Job& job) {
  const internal::BytesReceiver append =
      [&](std::span<const std::byte> bytes) -> std::optional<std::uint64_t> {
    const std::uint64_t at = out.bytes;
    return append_padded(bytes, writer, out.bytes, log) ? std::optional(at) : std::nullopt;
  };
  return std::ranges::all_of(options.albedo, [&](const AlbedoPart& part) {
    return internal::write_albedo(part, ground.map.is_placed(), out.maps, out.albedo, append, log,
                                  job);
  });
}

}  // namespace

Result<TilesReport> write_parts(std::span<const DemPart> parts, const std::filesystem::path& path,
                                const TilesOptions& options, DiagnosticLog& log, const Job& job) {
  if (!same_body(parts, options.albedo, log)) return failed;
  return run_job(job, log, [&]() -> Result<TilesReport> {
    const auto contents = frame_of(parts, options, log);
    if (!contents) return failed;
    auto writer = pan::Writer::create(path, log);
    if (!writer || !writer->begin(kTilesSection, 1, true, log)) return failed;
    Written written;
    if (!write_charts(parts, options, *writer, written, log, job)) return failed;
    if (!write_albedos(parts[0].info(), options, *writer, written, log, job) ||
        !write_tail(written, *writer, log) || !writer->end(log))
      return failed;
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
    TilesReport report;
    report.bytes = writer->bytes();
    report.tiles = written.records.size();
    report.albedo_tiles = written.albedo.size();
    for (const AlbedoRecord& map : written.maps)
      report.largest_albedo = std::max(report.largest_albedo, map.unit * (kNoAlbedo - 1));
    for (const ChartRecord& chart : written.charts)
      report.error = std::max(report.error, chart.error);
    for (const TileRecord& record : written.records)
      report.float_tiles += record.form == std::uint32_t(TileForm::floats);
    return report;
  });
}

}  // namespace panwright::terrain
