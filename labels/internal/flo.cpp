#include "labels/internal/flo.h"

#include <fmt/core.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/file.h"

namespace panwright::labels {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr float kUnknown = 1e10f;      // written
constexpr float kLeastUnknown = 1e9f;  // read
constexpr std::array<char, 4> kFloMagic = {'P', 'I', 'E', 'H'};

struct FloHeader {
  std::array<char, 4> magic = kFloMagic;
  std::uint32_t width = 0, height = 0;
};
static_assert(sizeof(FloHeader) == 12);

}  // namespace

std::uint64_t flo_bytes(std::uint32_t width, std::uint32_t height) {
  return sizeof(FloHeader) + std::uint64_t{2} * sizeof(float) * width * height;
}

bool write_flo(const std::filesystem::path& path, const Flow& flow, DiagnosticLog& log,
               double* sync_seconds) {
  const FloHeader header{kFloMagic, flow.width, flow.height};
  std::vector<float> values = flow.motion;
  for (float& value : values)
    if (std::isnan(value)) value = kUnknown;
  auto file = AtomicFile::create(path, log);
  return file && file->write(std::as_bytes(std::span(&header, 1)), log) &&
         file->write(std::as_bytes(std::span(values)), log) && file->commit(log, sync_seconds);
}

Result<Flow> read_flo(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                      DiagnosticLog& log) {
  const auto file = MappedFile::open(path, log);
  if (!file) return failed;
  const auto bytes = file->bytes();
  FloHeader header;
  const std::size_t count = std::size_t{2} * width * height;
  const bool whole = bytes.size() == flo_bytes(width, height);
  if (whole) std::memcpy(&header, bytes.data(), sizeof header);
  if (!whole || header.magic != kFloMagic || header.width != width || header.height != height) {
    log.report_file(Code("E9001"), path.string(),
                    fmt::format("the file is no flow of {} x {} pixels", width, height));
    return failed;
  }
  Flow flow{width, height, std::vector<float>(count)};
  std::memcpy(flow.motion.data(), bytes.data() + sizeof header, count * sizeof(float));
  for (float& value : flow.motion)
    if (!(std::fabs(value) <= kLeastUnknown)) value = std::numeric_limits<float>::quiet_NaN();
  return flow;
}

}  // namespace panwright::labels
