#include "image/arrays.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <exception>
#include <optional>
#include <utility>

#include "base/file.h"
#include "base/text.h"
#include "image/image.h"
#include "image/internal/zip.h"
#include "image/npy.h"

namespace panwright::image {
namespace {

constexpr std::string_view kNpyMagic("\x93NUMPY\x01\x00", 8);
constexpr std::string_view kArrayTypes[] = {"|u1", "<u2", "<u4", "<i4", "<f4", "<f8"};

std::uint64_t element_bytes(std::string_view type) {
  return static_cast<std::uint64_t>(type[2] - '0');
}

// Shape of a header's text, which numpy and this program write in one form.
std::optional<std::vector<std::uint64_t>> shape_in(std::string_view header) {
  constexpr std::string_view kShape = "'shape': (";
  const std::size_t begin = header.find(kShape);
  if (begin == std::string_view::npos) return std::nullopt;
  std::string_view rest = header.substr(begin + kShape.size());
  std::vector<std::uint64_t> shape;
  while (!rest.empty() && rest[0] != ')') {
    std::uint64_t side = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), side);
    constexpr std::size_t kMostSides = 8;
    constexpr std::uint64_t kMostSide = 1ull << 40;
    if (error != std::errc() || side > kMostSide || shape.size() == kMostSides) return std::nullopt;
    shape.push_back(side);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    while (!rest.empty() && (rest[0] == ',' || rest[0] == ' ')) rest.remove_prefix(1);
  }
  if (rest.empty()) return std::nullopt;
  return shape;
}

// An array without its data, which begins at `data` of the bytes of an .npy file; none: of another
// form, or not whole.
struct ArrayHead {
  Array array;
  std::size_t data = 0;
};
std::optional<ArrayHead> head_of(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kNpyMagic) || text.size() < 10) return std::nullopt;
  const std::size_t length =
      std::to_integer<std::size_t>(bytes[8]) | std::to_integer<std::size_t>(bytes[9]) << 8;
  if (length > text.size() - 10) return std::nullopt;
  const std::string_view header = text.substr(10, length);
  if (header.find("'fortran_order': False") == std::string_view::npos) return std::nullopt;
  Array array;
  for (const std::string_view type : kArrayTypes)
    if (header.find(fmt::format("'descr': '{}'", type)) != std::string_view::npos)
      array.type = type;
  auto shape = shape_in(header);
  if (array.type.empty() || !shape) return std::nullopt;
  std::uint64_t size = element_bytes(array.type);
  const std::uint64_t rest = text.size() - 10 - length;
  for (const std::uint64_t side : *shape)
    if (__builtin_mul_overflow(size, side, &size)) return std::nullopt;
  if (size != rest) return std::nullopt;
  array.shape = *std::move(shape);
  return ArrayHead{std::move(array), 10 + length};
}

// An array of the bytes of an .npy file; none: of another form, or not whole.
std::optional<Array> array_of(std::string name, const std::vector<std::byte>& bytes) {
  auto head = head_of(bytes);
  if (!head) return std::nullopt;
  head->array.name = std::move(name);
  head->array.data.assign(bytes.begin() + static_cast<std::ptrdiff_t>(head->data), bytes.end());
  return std::move(head->array);
}

Result<std::vector<float>> depth_of_exr(const std::filesystem::path& path, std::uint32_t width,
                                        std::uint32_t height, DiagnosticLog& log) {
  try {
    Imf::InputFile file(path.c_str(), 1);
    const auto window = file.header().dataWindow();
    const Imf::Channel* channel = file.header().channels().findChannel("Z");
    if (channel == nullptr) return std::vector<float>{};
    if (window.min.x != 0 || window.min.y != 0 ||
        std::int64_t{window.max.x} + 1 != std::int64_t{width} ||
        std::int64_t{window.max.y} + 1 != std::int64_t{height} || channel->xSampling != 1 ||
        channel->ySampling != 1) {
      log.report_file(Code("E0102"), path.string(),
                      fmt::format("the image is not of {} x {} pixels", width, height));
      return failed;
    }
    std::vector<float> depth(std::size_t{width} * height);
    Imf::FrameBuffer buffer;
    buffer.insert("Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(depth.data()), sizeof(float),
                                  sizeof(float) * width));
    file.setFrameBuffer(buffer);
    file.readPixels(0, static_cast<int>(height) - 1);
    return depth;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& problem) {
    log.report_file(Code("E0102"), path.string(),
                    fmt::format("the EXR decoder failed: {}", problem.what()));
    return failed;
  }
}

}  // namespace

bool is_whole_npy(std::span<const std::byte> file) { return head_of(file).has_value(); }

bool write_arrays(const std::filesystem::path& path, std::span<const Array> arrays,
                  DiagnosticLog& log, double* sync_seconds) {
  auto file = AtomicFile::create(path, log);
  if (!file) return false;
  ZipWriter zip(*file);
  for (const Array& array : arrays) {
    const std::string shape = array.shape.size() == 1
                                  ? fmt::format("({},)", array.shape[0])
                                  : fmt::format("({})", fmt::join(array.shape, ", "));
    if (!zip.add(array.name + ".npy", as_bytes(npy_header(array.type, shape)), array.data, log,
                 true))
      return false;
  }
  return zip.finish(log) && file->commit(log, sync_seconds);
}

Result<std::vector<Array>> read_arrays(const std::filesystem::path& path,
                                       std::span<const std::string_view> names,
                                       std::uint64_t max_bytes, DiagnosticLog& log) {
  const auto file = MappedFile::open(path, log);
  if (!file) return failed;
  const auto fail = [&](Code code, std::string message) {
    log.report_file(code, path.string(), std::move(message));
    return failed;
  };
  ZipReader zip(file->bytes());
  if (!zip.good()) return fail(Code("E0102"), "the file is no whole zip archive");
  std::vector<Array> out;
  for (const ZipReader::Entry& entry : zip.entries()) {
    constexpr std::string_view kExtension = ".npy";
    if (!entry.name.ends_with(kExtension)) continue;
    const std::string name = entry.name.substr(0, entry.name.size() - kExtension.size());
    if (!names.empty() && std::ranges::find(names, name) == names.end()) continue;
    if (entry.size > max_bytes)
      return fail(Code("E0104"), fmt::format("array {} exceeds the limit", in_quotes(name)));
    max_bytes -= entry.size;
    const auto bytes = zip.content(entry);
    auto array = bytes ? array_of(name, *bytes) : std::nullopt;
    if (!array)
      return fail(Code("E0102"), fmt::format("array {} is damaged, or of another form than numbers "
                                             "in C order",
                                             in_quotes(name)));
    out.push_back(*std::move(array));
  }
  return out;
}

Result<std::vector<float>> read_depth(const std::filesystem::path& path, std::uint32_t width,
                                      std::uint32_t height, DiagnosticLog& log) {
  if (image_format(path) == ImageFormat::exr) return depth_of_exr(path, width, height, log);
  constexpr std::uint64_t kHeaders = 1 << 16;
  constexpr std::string_view kDepth[] = {kLayerNames[static_cast<std::size_t>(FileLayer::depth)]};
  const std::uint64_t size = std::uint64_t{width} * height * sizeof(float);
  const auto arrays = read_arrays(path, kDepth, size + kHeaders, log);
  if (!arrays) return failed;
  if (arrays->empty()) return std::vector<float>{};
  const Array& array = arrays->front();
  if (array.type != "<f4" || array.shape != std::vector<std::uint64_t>{height, width}) {
    log.report_file(Code("E0102"), path.string(),
                    fmt::format("the depth is not of {} x {} pixels", width, height));
    return failed;
  }
  std::vector<float> depth(array.data.size() / sizeof(float));
  std::memcpy(depth.data(), array.data.data(), array.data.size());
  return depth;
}

}  // namespace panwright::image
