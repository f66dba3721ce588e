#include "terrain/tiles.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/hash.h"
#include "base/parallel.h"
#include "base/text.h"
#include "terrain/internal/stored_map.h"

namespace panwright::terrain {

namespace {

constexpr char kMagic[8] = {'P', 'W', 'T', 'E', 'R', 'R', 'A', 0};
constexpr std::uint32_t kMostCharts = 1024;
constexpr std::uint64_t kPosts = std::uint64_t{kTilePosts} * kTilePosts;
constexpr std::uint64_t kMipBytes = std::uint64_t{2} * kMipBlocks * kMipBlocks;

// Bytes of a tile's posts: those of u16 end on a multiple of 4.
std::uint64_t post_bytes(TileForm form) {
  return form == TileForm::codes ? (2 * kPosts + 3) / 4 * 4 : 4 * kPosts;
}

// Bytes of a tile before its slopes, and of these.
std::uint64_t slopes_at(TileForm form) { return post_bytes(form) + kMipBytes; }
std::uint64_t slope_bytes(std::uint32_t level, std::uint32_t version) {
  constexpr std::uint64_t kBytes =
      sizeof(float) + std::uint64_t{kSlopeBlocks} * kSlopeBlocks * sizeof(SlopeBlock);
  return version >= 2 && level >= kSlopeLevel ? kBytes : 0;
}

std::uint64_t tile_total(const ChartRecord& chart) {
  std::uint64_t sum = 0;
  for (std::uint32_t level = 0; level < chart.levels; ++level)
    sum +=
        std::uint64_t{level_side(chart.width, level).tiles} * level_side(chart.height, level).tiles;
  return sum;
}

bool all_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
}

// What is wrong with a chart, if anything.
std::optional<std::string> problem_of(const ChartRecord& chart, std::uint64_t first_tile) {
  if (chart.kind > std::uint32_t(Map::Kind::polar)) return "its projection is unknown";
  if (chart.width == 0 || chart.height == 0 || chart.width > 1u << 30 || chart.height > 1u << 30)
    return fmt::format("it has {} x {} posts", chart.width, chart.height);
  if (chart.levels != level_count(chart.width, chart.height) || chart.first_tile != first_tile ||
      chart.tile_count != tile_total(chart))
    return fmt::format("it has {} levels and {} tiles, which its {} x {} posts contradict",
                       chart.levels, chart.tile_count, chart.width, chart.height);
  if (!all_finite({&chart.radius, 12}) || !(chart.dx > 0) || !(chart.dy > 0) || chart.step < 0 ||
      chart.error < 0)
    return "a number of its map is not finite or out of range";
  if (chart.kind != std::uint32_t(Map::Kind::none) &&
      (!(chart.radius > 0) || !(chart.polar_radius > 0)))
    return "it has no radius";
  if (chart.domain != 180 && chart.domain != 360) return "its longitudes have no domain";
  return {};
}

// What is wrong with a tile, if anything. end: bytes of all tiles.
std::optional<std::string> problem_of(const TileRecord& tile, const ChartRecord& chart,
                                      std::uint32_t version, std::uint64_t end) {
  const auto form = static_cast<TileForm>(tile.form);
  if (tile.form > std::uint32_t(TileForm::floats) || (form == TileForm::codes && !(chart.step > 0)))
    return fmt::format("has the form {}", tile.form);
  const std::uint64_t length =
      form == TileForm::nothing ? 0 : slopes_at(form) + slope_bytes(tile.level, version);
  if (tile.length != length || tile.offset % 64 != 0 || tile.offset > end ||
      length > end - tile.offset)
    return fmt::format("has {} bytes at {} of {}", tile.length, tile.offset, end);
  if (!std::isfinite(tile.low) || !std::isfinite(tile.high) || tile.low > tile.high ||
      !(tile.error >= 0) ||
      !std::ranges::all_of(tile.slope, [](float v) { return std::isfinite(v); }))
    return "has bounds that are not finite or not in order";
  return {};
}

}  // namespace

LevelSide level_side(std::uint32_t posts, std::uint32_t level) {
  const std::uint64_t cells = posts - 1, unit = std::uint64_t{1} << level;
  const std::uint64_t here = (cells + unit - 1) / unit;
  return {static_cast<std::uint32_t>(here + 1), static_cast<std::uint32_t>(std::max<std::uint64_t>(
                                                    1, (here + kTileCells - 1) / kTileCells))};
}

std::uint32_t level_count(std::uint32_t width, std::uint32_t height) {
  std::uint32_t level = 0;
  while (level_side(width, level).tiles > 1 || level_side(height, level).tiles > 1) ++level;
  return level + 1;
}

double TileView::height(std::uint32_t column, std::uint32_t row) const {
  const std::size_t at = std::size_t{row} * kTilePosts + column;
  if (codes.empty()) return floats[at];
  const std::uint16_t code = codes[at];
  if (code == kVoidCode) return std::numeric_limits<double>::quiet_NaN();
  return step * (double(record->base) + code);
}

std::string_view field_text(std::span<const char> field) {
  return {field.data(), strnlen(field.data(), field.size())};
}

Result<Tiles> Tiles::open(const std::filesystem::path& path, DiagnosticLog& log) {
  auto model = pan::Model::open(path, log);
  if (!model) return failed;
  auto tiles = of(std::make_shared<const pan::Model>(*std::move(model)), log);
  if (!tiles) return failed;
  if (*tiles) return **std::move(tiles);
  log.report_file(Code("E9610"), path.string(), "the pan file has no terrain");
  return failed;
}

Result<std::optional<Tiles>> Tiles::of(std::shared_ptr<const pan::Model> model,
                                       DiagnosticLog& log) {
  const auto sections = model->directory();
  const auto entry = std::ranges::find(sections, kTilesSection, &pan::layout::DirectoryEntry::kind);
  if (entry == sections.end()) return std::optional<Tiles>();
  const auto refuse = [&](const std::string& problem) {
    log.report_file(Code("E9610"), model->name(), problem,
                    "make the file again with this version of panwright");
    return failed;
  };
  if (entry->codec != 0 || entry->stride != 1) return refuse("section 'tiles' is compressed");
  Tiles out;
  out.bytes_ = model->bytes().subspan(entry->offset, entry->raw_length);
  TilesTail tail;
  if (out.bytes_.size() < sizeof tail) return refuse("section 'tiles' has no tail");
  const std::uint64_t tail_at = out.bytes_.size() - sizeof tail;
  std::memcpy(&tail, out.bytes_.data() + tail_at, sizeof tail);
  if (std::memcmp(tail.magic, kMagic, sizeof kMagic) != 0) return refuse("its tail is damaged");
  if (tail.version == 0 || tail.version > kTilesVersion)
    return refuse(
        fmt::format("its terrain has version {}, expected 1 to {}", tail.version, kTilesVersion));
  out.version_ = tail.version;
  if (tail.chart_count == 0 || tail.chart_count > kMostCharts || tail.charts_offset % 64 != 0 ||
      tail.tile_count > tail_at / sizeof(TileRecord) || tail.charts_offset > tail_at ||
      tail.tiles_offset != tail.charts_offset + tail.chart_count * sizeof(ChartRecord) ||
      tail.tiles_offset + tail.tile_count * sizeof(TileRecord) > tail_at)
    return refuse("the lengths of its lists of charts and tiles contradict one another");
  const auto lists = out.bytes_.subspan(tail.charts_offset, tail_at - tail.charts_offset);
  Hasher hasher;
  hasher.update(lists);
  hasher.update(std::as_bytes(std::span(&tail, 1)).first(offsetof(TilesTail, hash)));
  if (hasher.digest64() != tail.hash) return refuse("its list of tiles does not match its hash");
  out.charts_ = {reinterpret_cast<const ChartRecord*>(lists.data()), tail.chart_count};
  out.records_ = {reinterpret_cast<const TileRecord*>(out.bytes_.data() + tail.tiles_offset),
                  static_cast<std::size_t>(tail.tile_count)};
  const std::uint64_t end = tail.tiles_offset + tail.tile_count * sizeof(TileRecord);
  const auto no_albedo =
      tail.version < 3
          ? (end == tail_at ? std::nullopt : std::optional<std::string>("its tail is damaged"))
          : AlbedoMaps::open(out.bytes_.first(tail.charts_offset),
                             out.bytes_.subspan(end, tail_at - end), out.albedo_);
  if (no_albedo) return refuse(*no_albedo);
  std::uint64_t next = 0;
  for (std::size_t c = 0; c < out.charts_.size(); ++c) {
    const ChartRecord& chart = out.charts_[c];
    auto problem = problem_of(chart, next);
    if (!problem && chart.tile_count > tail.tile_count - next) problem = "its tiles are missing";
    if (problem) return refuse(fmt::format("chart {}: {}", c, *problem));
    std::uint32_t level = 0, column = 0, row = 0;
    for (std::uint32_t t = 0; t < chart.tile_count; ++t) {
      const TileRecord& tile = out.records_[next + t];
      const auto wrong = tile.level != level || tile.column != column || tile.row != row
                             ? std::optional<std::string>("is out of order")
                             : problem_of(tile, chart, tail.version, tail.charts_offset);
      if (wrong) return refuse(fmt::format("tile {} of chart {} {}", t, c, *wrong));
      if (++column < level_side(chart.width, level).tiles) continue;
      column = 0;
      if (++row < level_side(chart.height, level).tiles) continue;
      row = 0;
      ++level;
    }
    next += chart.tile_count;
  }
  if (next != tail.tile_count) return refuse("it has tiles of no chart");
  out.state_.reset(new std::atomic<std::uint8_t>[out.records_.size()]());
  out.model_ = std::move(model);
  return std::optional<Tiles>(std::move(out));
}

std::uint32_t Tiles::index(std::uint32_t chart, std::uint32_t level, std::uint32_t column,
                           std::uint32_t row) const {
  const ChartRecord& c = charts_[chart];
  std::uint32_t first = c.first_tile;
  for (std::uint32_t k = 0; k < level; ++k)
    first += level_side(c.width, k).tiles * level_side(c.height, k).tiles;
  return first + row * level_side(c.width, level).tiles + column;
}

std::uint32_t Tiles::chart_of(std::uint32_t tile) const {
  auto chart = static_cast<std::uint32_t>(charts_.size() - 1);
  while (charts_[chart].first_tile > tile) --chart;
  return chart;
}

std::optional<TileView> Tiles::view(std::uint32_t tile) const {
  const TileRecord& record = records_[tile];
  const auto form = static_cast<TileForm>(record.form);
  if (form == TileForm::nothing) return {};
  const auto bytes = bytes_.subspan(record.offset, record.length);
  std::uint8_t state = state_[tile].load(std::memory_order_relaxed);
  if (state == kUnknown) {
    state = hash64(bytes) == record.hash ? kGood : kDamaged;
    state_[tile].store(state, std::memory_order_relaxed);
  }
  if (state >= kDamaged) return {};
  TileView out;
  out.record = &record;
  out.step = charts_[chart_of(tile)].step;
  if (form == TileForm::codes)
    out.codes = {reinterpret_cast<const std::uint16_t*>(bytes.data()), kPosts};
  else
    out.floats = {reinterpret_cast<const float*>(bytes.data()), kPosts};
  out.mips = {reinterpret_cast<const std::uint16_t*>(bytes.data() + post_bytes(form)),
              std::size_t{kMipBlocks} * kMipBlocks};
  if (slope_bytes(record.level, version_) == 0) return out;
  float unit = 0;
  std::memcpy(&unit, bytes.data() + slopes_at(form), sizeof unit);
  out.slope_unit = double(unit);
  out.slopes = {reinterpret_cast<const SlopeBlock*>(bytes.data() + slopes_at(form) + sizeof unit),
                std::size_t{kSlopeBlocks} * kSlopeBlocks};
  return out;
}

void Tiles::report_damaged(DiagnosticLog& log) const {
  constexpr std::size_t kNamed = 8;
  std::size_t found = 0;
  for (std::uint32_t i = 0; i < records_.size(); ++i) {
    std::uint8_t state = kDamaged;
    if (state_[i].load(std::memory_order_relaxed) != kDamaged ||
        !state_[i].compare_exchange_strong(state, kReported) || ++found > kNamed)
      continue;
    log.report_file(Code("W9615"), name(),
                    tile_words(*this, i) + " does not match its hash: it is left out",
                    "panwright check names all that are damaged");
  }
  if (found > kNamed)
    log.report_file(Code("W9615"), name(),
                    fmt::format("{} more tiles are left out", found - kNamed),
                    "panwright check names all that are damaged");
  albedo_.report_damaged(name(), log);
}

bool Tiles::check_padding(DiagnosticLog& log) const {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> runs;  // begin, end
  for (const TileRecord& record : records_)
    runs.emplace_back(record.offset, record.offset + record.length);
  for (std::size_t i = 0; i < albedo_.tiles().size(); ++i) {
    const std::uint64_t at = albedo_.tiles()[i].offset;
    runs.emplace_back(at, at + albedo_.bytes(i).size());
  }
  const auto end = static_cast<std::uint64_t>(reinterpret_cast<const std::byte*>(charts_.data()) -
                                              bytes_.data());
  runs.emplace_back(end, end);
  std::ranges::sort(runs);
  std::uint64_t at = 0;
  for (const auto& [begin, next] : runs) {
    for (; at < begin; ++at) {
      if (bytes_[at] == std::byte{0}) continue;
      log.report_file(
          Code("E9611"), name(),
          fmt::format("byte {} of section 'tiles', before the tile at {}, is not 0", at, begin));
      return false;
    }
    at = std::max(at, next);
  }
  return true;
}

bool Tiles::check(DiagnosticLog& log, const Job& job) const {
  return run_job(job, log, [&] {
    Phase phase(job, "checking tiles", records_.size());
    parallel_for(
        records_.size(),
        [&](std::size_t i) {
          state_[i].store(kUnknown);
          view(static_cast<std::uint32_t>(i));
          // note: tiles share pages with their neighbours, which are read again where they are used
          model_->release(bytes_.subspan(records_[i].offset, records_[i].length));
          phase.advance();
        },
        job);
    bool good = check_padding(log);
    good = check_albedo(log, job) && good;
    for (std::uint32_t i = 0; i < records_.size(); ++i) {
      if (!is_damaged(i)) continue;
      good = false;
      log.report_file(Code("E9611"), name(),
                      fmt::format("{} (bytes {} to {} of section 'tiles') does not match its hash",
                                  tile_words(*this, i), records_[i].offset,
                                  records_[i].offset + records_[i].length));
    }
    return good;
  });
}

bool Tiles::check_albedo(DiagnosticLog& log, const Job& job) const {
  const std::size_t count = albedo_.tiles().size();
  std::vector<std::uint8_t> good(count);
  Phase phase(job, "checking albedo maps", count);
  parallel_for(
      count,
      [&](std::size_t i) {
        good[i] = albedo_.check(i);
        model_->release(albedo_.bytes(i));
        phase.advance();
      },
      job);
  for (std::size_t i = 0; i < count; ++i)
    if (!good[i])
      log.report_file(Code("E9611"), name(),
                      fmt::format("tile {} of the albedo maps (bytes {} to {} of section 'tiles') "
                                  "does not match its hash",
                                  i, albedo_.tiles()[i].offset,
                                  albedo_.tiles()[i].offset + albedo_.bytes(i).size()));
  return std::ranges::find(good, 0) == good.end();
}

Map map_of(const ChartRecord& chart) {
  Map map = internal::stored_map(chart);
  map.north = chart.flags & kChartNorth;
  map.left = chart.left - chart.dx / 2;
  map.top = chart.top + chart.dy / 2;
  return map;
}

std::string tile_words(const Tiles& tiles, std::uint32_t tile) {
  const TileRecord& record = tiles.records()[tile];
  return fmt::format("the tile of level {}, column {}, row {} of chart {}", record.level,
                     record.column, record.row, tiles.chart_of(tile));
}

}  // namespace panwright::terrain
