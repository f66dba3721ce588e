#include "terrain/internal/albedo_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hash.h"
#include "base/text.h"
#include "terrain/internal/stored_map.h"

namespace panwright::terrain::internal {

namespace {

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

bool is_value(double number, VoidKind kind) {
  return kind == VoidKind::none && std::isfinite(number);
}

// Numbers of a map, by area.
struct Found {
  double sum = 0, area = 0, most = 0;
  std::uint64_t negative = 0;
};

bool look_at(const Dem& dem, Found& found, DiagnosticLog& log, const Job& job) {
  const DemInfo& info = dem.info();
  const bool polar = info.map.kind == Map::Kind::polar;
  Phase phase(job, "looking at albedos", info.height);
  return dem.read(
      0, info.height,
      [&](const Rows& rows) {
        for (std::uint32_t r = 0; r < rows.count; ++r) {
          const double row = rows.first + r + 0.5;
          const auto area = [&](double column) {
            const Vec2 metres = info.map.spacing(column, row);
            return metres.x * metres.y;
          };
          double weight = area(0.5 * info.width);
          for (std::uint32_t x = 0; x < info.width; ++x) {
            const std::size_t at = std::size_t{r} * info.width + x;
            if (!is_value(rows.heights[at], rows.voids[at])) continue;
            if (polar) weight = area(x + 0.5);
            found.negative += rows.heights[at] < 0;
            const double value = std::max(rows.heights[at], 0.0);
            found.sum += weight * value;
            found.area += weight;
            found.most = std::max(found.most, value);
          }
        }
        phase.advance(rows.count);
        return true;
      },
      log, job);
}

// Rows of pixels into tiles of all levels, as they come.
class AlbedoLevels {
 public:
  AlbedoLevels(const AlbedoRecord& map, double most, std::span<AlbedoTile> tiles,
               const BytesReceiver& to)
      : channels_(map.channels), most_(most), tiles_(tiles), to_(to) {
    std::size_t first = 0;
    for (std::uint32_t k = 0; k < map.levels; ++k) {
      Level& level = levels_.emplace_back();
      level.across = albedo_side(map.width, k);
      level.down = albedo_side(map.height, k);
      level.first = first;
      first += std::size_t{level.across.tiles} * level.down.tiles;
    }
  }

  // Takes the next row, kNoValue where a pixel has no value.
  bool push(std::span<const float> row, std::uint32_t level = 0) {
    Level& here = levels_[level];
    here.rows.insert(here.rows.end(), row.begin(), row.end());
    const std::uint32_t number = here.taken++;
    const bool last = here.taken == here.down.pixels;
    if ((here.taken % kAlbedoPixels == 0 || last) && !flush(here, number / kAlbedoPixels))
      return false;
    if (level + 1 == levels_.size()) return true;
    if (number % 2 == 0 && !last) {
      here.even.assign(row.begin(), row.end());
      return true;
    }
    const std::vector<float> halved = means(number % 2 == 0 ? row : here.even, row);
    return push(halved, level + 1);
  }

 private:
  struct Level {
    AlbedoSide across, down;
    std::size_t first = 0;    // tile
    std::vector<float> rows;  // of the tiles that are being filled
    std::vector<float> even;  // the last row of an even number
    std::uint32_t taken = 0;  // rows
  };

  // Means of two rows and two columns; of what is left at the end of both.
  std::vector<float> means(std::span<const float> upper, std::span<const float> lower) const {
    const std::size_t width = upper.size() / channels_, half = (width + 1) / 2;
    const std::size_t rows = upper.data() == lower.data() ? 1 : 2;
    std::vector<float> out(half * channels_);
    for (std::size_t i = 0; i < half; ++i)
      for (std::uint32_t c = 0; c < channels_; ++c) {
        double sum = 0;
        int count = 0;
        for (std::size_t j = 0; j < rows; ++j)
          for (std::size_t x = 2 * i; x < std::min(2 * i + 2, width); ++x) {
            const float value = (j == 0 ? upper : lower)[x * channels_ + c];
            if (!(value == value)) continue;
            sum += double(value);
            ++count;
          }
        out[i * channels_ + c] = count > 0 ? static_cast<float>(sum / count) : kNoValue;
      }
    return out;
  }

  bool flush(Level& level, std::uint32_t tile_row) {
    const std::size_t stride = std::size_t{level.across.pixels} * channels_;
    const std::size_t rows = level.rows.size() / stride;
    std::vector<std::uint16_t> codes;
    for (std::uint32_t t = 0; t < level.across.tiles; ++t) {
      codes.assign(std::size_t{level.across.stride} * level.down.stride * channels_, kNoAlbedo);
      const std::size_t begin = std::size_t{t} * kAlbedoPixels;
      const std::size_t columns = std::min<std::size_t>(kAlbedoPixels, level.across.pixels - begin);
      bool any = false;
      for (std::size_t y = 0; y < rows; ++y)
        for (std::size_t i = 0; i < columns * channels_; ++i) {
          const float value = level.rows[y * stride + begin * channels_ + i];
          if (!(value == value)) continue;
          any = true;
          codes[y * level.across.stride * channels_ + i] =
              static_cast<std::uint16_t>(std::nearbyint((kNoAlbedo - 1) * (double(value) / most_)));
        }
      if (!any) continue;
      const auto bytes = std::as_bytes(std::span(codes));
      const auto offset = to_(bytes);
      if (!offset) return false;
      tiles_[level.first + std::size_t{tile_row} * level.across.tiles + t] = {*offset,
                                                                              hash64(bytes)};
    }
    level.rows.clear();
    return true;
  }

  std::uint32_t channels_;
  double most_;
  std::span<AlbedoTile> tiles_;
  const BytesReceiver& to_;
  std::vector<Level> levels_;
};

AlbedoRecord record_of(const DemInfo& info, std::uint32_t channels) {
  AlbedoRecord out{};
  const Map& map = info.map;
  store_map(map, out);
  out.left = map.left;
  out.top = map.top;
  out.flags = (map.north ? kAlbedoNorth : 0) | (map.is_whole_turn(info.width) ? kAlbedoWraps : 0);
  out.width = info.width;
  out.height = info.height;
  out.channels = channels;
  out.levels = albedo_levels(info.width, info.height);
  return out;
}

// Gives the rows of all bands together.
bool read_rows(const AlbedoPart& part, AlbedoLevels& to, DiagnosticLog& log, const Job& job) {
  constexpr std::uint32_t kAtOnce = 256;
  const DemInfo& info = part.bands[0].info();
  const std::size_t channels = part.bands.size(), width = info.width;
  std::vector<float> pixels;
  Phase phase(job, "albedo maps", info.height);
  for (std::uint32_t first = 0; first < info.height; first += kAtOnce) {
    const std::uint32_t count = std::min(kAtOnce, info.height - first);
    pixels.assign(width * count * channels, kNoValue);
    for (std::size_t c = 0; c < channels; ++c) {
      const bool all = part.bands[c].read(
          first, count,
          [&](const Rows& rows) {
            const std::size_t at = std::size_t{rows.first - first} * width;
            for (std::size_t i = 0; i < width * rows.count; ++i)
              if (is_value(rows.heights[i], rows.voids[i]))
                pixels[(at + i) * channels + c] =
                    static_cast<float>(std::max(rows.heights[i], 0.0));
            return true;
          },
          log, job);
      if (!all) return false;
    }
    for (std::size_t i = 0; i < pixels.size(); i += channels) {
      const std::span pixel(pixels.data() + i, channels);
      if (std::ranges::any_of(pixel, [](float v) { return !(v == v); }))
        std::ranges::fill(pixel, kNoValue);
    }
    for (std::uint32_t r = 0; r < count; ++r)
      if (!to.push(std::span(pixels).subspan(r * width * channels, width * channels))) return false;
    phase.advance(count);
  }
  return true;
}

}  // namespace

bool write_albedo(const AlbedoPart& part, bool placed, std::vector<AlbedoRecord>& maps,
                  std::vector<AlbedoTile>& tiles, const BytesReceiver& to, DiagnosticLog& log,
                  const Job& job) {
  const DemInfo& info = part.bands[0].info();
  const std::string at = part.place.empty() ? "" : part.place + ": ";
  const std::string name = at + in_quotes(info.files.front());
  const auto refuse = [&](const std::string& problem, std::string hint = {}) {
    log.report(Code("E9612"), {}, name + ": " + problem, std::move(hint));
    return false;
  };
  if (info.map.is_placed() != placed)
    return placed ? refuse("it has no places on a body, which the terrain has",
                           "a file with a map projection, or an image twice as wide as high")
                  : refuse("it has places on a body, but the terrain is a plane");
  Found found;
  for (const Dem& band : part.bands)
    if (!look_at(band, found, log, job)) return false;
  if (!(found.area > 0) || !(found.sum > 0)) return refuse("it has no albedo above 0");
  const double mean = found.sum / found.area, white = part.white.value_or(mean);
  if (found.negative > 0)
    log.report(Code("W9603"), {},
               fmt::format("{}: {} numbers are negative: 0 is taken", name, found.negative));
  constexpr double kMostFactor = 2;  // of bright ground at opposition
  if (part.white && found.most * part.scale > kMostFactor)
    log.report(Code("W9603"), {},
               fmt::format("{}: its largest radiance factor is {:.4g}, of white about 1", name,
                           found.most * part.scale),
               "scale= makes radiance factors of its numbers");
  if (!part.white)
    log.report(Code("N9604"), {},
               fmt::format("{}: its numbers are relative: their mean by area, {:.6g}, stands for "
                           "the ground's own colour",
                           name, mean),
               "reflectance= says what they are");
  AlbedoRecord record = record_of(info, static_cast<std::uint32_t>(part.bands.size()));
  record.unit = found.most / white / (kNoAlbedo - 1);
  record.mean = mean / white;
  record.first_tile = static_cast<std::uint32_t>(tiles.size());
  std::vector<AlbedoTile> own(albedo_tiles(record));
  AlbedoLevels levels(record, found.most, own, to);
  if (!read_rows(part, levels, log, job)) return false;
  tiles.insert(tiles.end(), own.begin(), own.end());
  maps.push_back(record);
  return true;
}

}  // namespace panwright::terrain::internal
