#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/core.h>

#include <exception>
#include <initializer_list>
#include <stdexcept>

#include "image/exr.h"
#include "image/internal/writers.h"

namespace panwright::image {
namespace {

// OpenEXR writes where it likes; an atomic file takes that as well.
class FileStream final : public Imf::OStream {
 public:
  FileStream(AtomicFile& file, DiagnosticLog& log) : OStream("image"), file_(file), log_(log) {}
  void write(const char c[], int n) override {
    const auto bytes = as_bytes(std::string_view(c, static_cast<std::size_t>(n)));
    if (!file_.write_at(position_, bytes, log_)) {
      reported_ = true;
      throw std::runtime_error("writing failed");
    }
    position_ += static_cast<std::uint64_t>(n);
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  bool reported() const { return reported_; }

 private:
  AtomicFile& file_;
  DiagnosticLog& log_;
  std::uint64_t position_ = 0;
  bool reported_ = false;
};

class Layers {
 public:
  Layers(Imf::Header& header, std::size_t width) : header_(header), width_(width) {}
  // channel of an interleaved layer with `stride` values a pixel
  template <class T>
  void add(const char* name, const std::vector<T>& values, std::size_t channel,
           std::size_t stride) {
    constexpr auto kType = std::is_same_v<T, float> ? Imf::FLOAT : Imf::UINT;
    header_.channels().insert(name, Imf::Channel(kType));
    // note: OpenEXR takes a mutable pointer for reading as for writing, and only reads here
    auto* base = reinterpret_cast<char*>(const_cast<T*>(values.data() + channel));
    buffer_.insert(name, Imf::Slice(kType, base, sizeof(T) * stride, sizeof(T) * stride * width_));
  }
  const Imf::FrameBuffer& buffer() const { return buffer_; }

 private:
  Imf::Header& header_;
  Imf::FrameBuffer buffer_;
  std::size_t width_;
};

}  // namespace

bool write_exr(AtomicFile& file, const Image& image, const FileOptions& options,
               DiagnosticLog& log) {
  FileStream stream(file, log);
  try {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    header.insert("radianceUnit", Imf::StringAttribute(image.unit));
    for (const auto& [name, value] : image.metadata)
      header.insert(name.c_str(), Imf::StringAttribute(value));
    Layers layers(header, image.width);
    const auto add = [&](FileLayer layer, std::initializer_list<const char*> names,
                         const auto& values) {
      if (values.empty() || !options.has(layer)) return;
      std::size_t channel = 0;
      for (const char* name : names) layers.add(name, values, channel++, names.size());
    };
    add(FileLayer::radiance, {"R", "G", "B"}, image.radiance);
    add(FileLayer::coverage, {"A"}, image.coverage);
    add(FileLayer::standard_error, {"error.R", "error.G", "error.B"}, image.standard_error);
    add(FileLayer::depth, {"Z"}, image.depth);
    add(FileLayer::range, {"range"}, image.range);
    add(FileLayer::normal, {"N.X", "N.Y", "N.Z"}, image.normal);
    add(FileLayer::target_id, {"id.target"}, image.target_id);
    add(FileLayer::node_id, {"id.node"}, image.node_id);
    add(FileLayer::material_id, {"id.material"}, image.material_id);
    const std::vector<std::uint32_t> numbers(image.dn.begin(), image.dn.end());
    add(FileLayer::dn, {"dn"}, numbers);
    add(FileLayer::electrons, {"electrons"}, image.electrons);
    for (const auto& [name, values] : image.stages)
      if (options.has(FileLayer::stages)) layers.add(("stage." + name).c_str(), values, 0, 1);
    Imf::OutputFile output(stream, header);
    output.setFrameBuffer(layers.buffer());
    output.writePixels(static_cast<int>(image.height));
  } catch (const std::exception& problem) {
    if (!stream.reported())
      log.report_file(Code("E0103"), {}, fmt::format("the EXR encoder failed: {}", problem.what()));
    return false;
  }
  return true;
}

bool write_exr_file(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                    std::span<const ExrChannel> channels,
                    std::span<const std::pair<std::string, std::string>> attributes,
                    DiagnosticLog& log) {
  auto file = AtomicFile::create(path, log);
  if (!file) return false;
  {
    FileStream stream(*file, log);
    try {
      Imf::Header header(static_cast<int>(width), static_cast<int>(height));
      header.compression() = Imf::ZIP_COMPRESSION;
      for (const auto& [name, value] : attributes)
        header.insert(name.c_str(), Imf::StringAttribute(value));
      Layers layers(header, width);
      for (const ExrChannel& channel : channels)
        layers.add(channel.name.c_str(), channel.values, 0, 1);
      Imf::OutputFile output(stream, header);
      output.setFrameBuffer(layers.buffer());
      output.writePixels(static_cast<int>(height));
    } catch (const std::exception& problem) {
      if (!stream.reported())
        log.report_file(Code("E0103"), path.string(),
                        fmt::format("the EXR encoder failed: {}", problem.what()));
      return false;
    }
  }
  return file->publish(log);
}

}  // namespace panwright::image
