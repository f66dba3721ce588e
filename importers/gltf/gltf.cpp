#include "importers/gltf/gltf.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "base/text.h"
#include "importers/gltf/animation.h"
#include "importers/gltf/base64.h"
#include "importers/gltf/build.h"
#include "importers/gltf/container.h"
#include "importers/gltf/document.h"
#include "importers/gltf/primitives.h"
#include "importers/gltf/structs.h"

namespace panwright::importers::gltf {

namespace {

constexpr std::uint32_t kJsonDepth = 128;
// bytes of memory that a value of the JSON takes, with its struct
constexpr std::uint64_t kValueBytes = 256;

// Extensions that a file may require: those that are read, and those that change no surface.
constexpr std::array kRead = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                              "KHR_meshopt_compression",    "KHR_mesh_quantization",
                              "EXT_mesh_gpu_instancing",    "KHR_texture_transform",
                              "EXT_texture_webp",           "AGI_articulations"};
constexpr std::array kHarmless = {"KHR_texture_basisu",    "KHR_lights_punctual",
                                  "KHR_animation_pointer", "KHR_xmp",
                                  "KHR_xmp_json_ld",       "KHR_techniques_webgl",
                                  "EXT_texture_avif",      "EXT_lights_image_based",
                                  "EXT_lights_ies",        "MSFT_texture_dds",
                                  "AGI_stk_metadata",      "CESIUM_primitive_outline",
                                  "GOOGLE_texture_basis"};

bool reads(const std::string& extension) {
  return std::find(kRead.begin(), kRead.end(), extension) != kRead.end();
}
bool is_harmless(const std::string& extension) {
  return extension.starts_with("KHR_materials_") ||
         std::find(kHarmless.begin(), kHarmless.end(), extension) != kHarmless.end();
}

class Reader {
 public:
  Reader(Files& files, const InputFile& file, const Options& options, DiagnosticLog& log)
      : d_(files, file, options, log) {}

  Result<Imported> read() {
    std::string_view json;
    if (!find_json(json) || !parse(json) || !accept_version()) return failed;
    collect_extensions();
    check_schema(d_);
    for (const Json& image : d_.root.list("images"))
      if (const Json* uri = image.find("uri"); uri != nullptr && !is_data_uri(uri->text))
        declare(d_.files, d_.file.path, uri->text, true);
    if (!accept_extensions()) return failed;
    load_buffers(d_);
    check_accessors(d_);
    check_nodes(d_);
    check_meshes(d_);
    tinygltf::Model model;
    std::string problem;
    if (!structs_of(d_, model, problem)) {
      d_.report(Code("E6204"), nullptr, "", fmt::format("it cannot be read: {}", problem));
      return failed;
    }
    const auto posing = pose_nodes(d_, model, {d_.options.animation, d_.options.time});
    if (!posing) return failed;
    return scene_of(d_, model, *posing);
  }

 private:
  bool find_json(std::string_view& json) {
    const std::string_view bytes = *d_.file.bytes;
    d_.text = !is_glb(bytes);
    d_.source =
        d_.log.sources().add({d_.file.name, d_.text ? d_.file.bytes : nullptr,
                              d_.text ? Encoding::utf8 : Encoding::binary, d_.file.included_at});
    if (d_.text) {
      json = bytes;
      drop_mark(json);
      return true;
    }
    if (bytes.size() >= 8 && bytes.substr(4, 4) == std::string_view("\1\0\0\0", 4)) {
      d_.report(Code("E6202"), nullptr, "", "binary glTF 1.0; glTF 2.x is read",
                "convert it to glTF 2.0 first");
      return false;
    }
    const Container container = chunks_of(bytes);
    for (const std::string& problem : container.problems)
      d_.report(Code("E6201"), nullptr, "", problem);
    if (container.extra > 0)
      d_.report(Code("W6215"), nullptr, "",
                fmt::format("{} after the end of the container", counted(container.extra, "byte")));
    json = container.json;
    if (container.binary) {
      d_.binary = *container.binary;
      d_.has_binary = true;
    }
    if (json.empty() && container.problems.empty())
      d_.report(Code("E6201"), nullptr, "", "no JSON chunk");
    drop_mark(json);
    return !json.empty();
  }

  // Read on after it: nothing is lost.
  void drop_mark(std::string_view& json) {
    if (!json.starts_with("\xef\xbb\xbf")) return;
    d_.report(Code("E6203"), nullptr, "", "a byte order mark before the JSON");
    json.remove_prefix(3);
    if (d_.text) d_.json_begin = 3;
  }

  bool parse(std::string_view json) {
    if (const std::size_t zero = json.find('\0'); zero != json.npos) {
      d_.report(Code("E6203"), static_cast<std::uint32_t>(zero), "",
                "a zero byte in the JSON; the rest is not read");
      json = json.substr(0, zero);
    }
    const std::uint64_t values = std::max<std::uint64_t>(d_.options.limits.memory / kValueBytes, 1);
    ParsedJson parsed = parsed_json(json, kJsonDepth, values);
    if (parsed.problem) {
      d_.report(Code("E6203"), static_cast<std::uint32_t>(parsed.problem->offset), "",
                fmt::format("byte {}: {}", d_.json_begin + parsed.problem->offset,
                            parsed.problem->message));
      return false;
    }
    d_.root = std::move(parsed.root);
    for (const JsonProblem& repeated : parsed.repeated)
      d_.report(Code("W6215"), static_cast<std::uint32_t>(repeated.offset), "", repeated.message);
    if (!d_.root.is(Json::Kind::object)) {
      d_.report(Code("E6204"), &d_.root, "", "the file is not one object");
      return false;
    }
    return true;
  }

  bool refuse_version(const Json* at, const std::string& version, std::string_view read = "2.x") {
    d_.report(Code("E6202"), at, "/asset/version",
              fmt::format("version {} of glTF; {} is read", in_quotes(version), read),
              "convert it to glTF 2.0 first");
    return false;
  }

  using Version = std::pair<int, int>;

  // "2.0" → 2 and 0.
  static std::optional<Version> version_of(std::string_view text) {
    Version version;
    const char* const end = text.data() + text.size();
    const auto major = std::from_chars(text.data(), end, version.first);
    if (major.ec != std::errc() || major.ptr == end || *major.ptr != '.') return std::nullopt;
    const auto minor = std::from_chars(major.ptr + 1, end, version.second);
    if (minor.ec != std::errc() || minor.ptr != end) return std::nullopt;
    if (version.first < 0 || version.second < 0) return std::nullopt;
    return version;
  }

  bool accept_version() {
    const Json* asset = d_.root.find("asset");
    const Json* version = asset ? asset->find("version") : nullptr;
    // lists of glTF 2 are objects of names in glTF 1
    const Json* meshes = d_.root.find("meshes");
    if (!version && meshes && meshes->is(Json::Kind::object)) return refuse_version(meshes, "1.0");
    if (!version) return true;
    if (!version->is(Json::Kind::string)) return true;
    const std::optional<Version> written = version_of(version->text);
    if (!written || written->first != 2) return refuse_version(version, version->text);
    const Json* least = asset->find("minVersion");
    if (!least || !least->is(Json::Kind::string)) return true;
    const std::optional<Version> needed = version_of(least->text);
    if (!needed || *needed > Version{2, 1}) return refuse_version(least, least->text, "2.0 or 2.1");
    if (*needed > *written)
      d_.report(Code("E6204"), least, "/asset/minVersion",
                fmt::format("it needs version {} and is version {}", in_quotes(least->text),
                            in_quotes(version->text)));
    return true;
  }

  void collect_extensions() {
    for (const auto& [key, set] :
         {std::pair("extensionsUsed", &d_.used), std::pair("extensionsRequired", &d_.required)})
      for (const Json& name : d_.root.list(key))
        if (name.is(Json::Kind::string)) set->insert(name.text);
  }

  bool accept_extensions() {
    bool accepted = true;
    for (const std::string& name : d_.required) {
      if (!d_.used.contains(name))
        d_.report(Code("E6204"), nullptr, "/extensionsRequired",
                  fmt::format("{} is required and not listed as used", in_quotes(name)));
      if (reads(name) || is_harmless(name)) continue;
      d_.report(Code("E6209"), d_.root.find("extensionsRequired"), "/extensionsRequired",
                fmt::format("the file requires {}, which is not read", in_quotes(name)));
      accepted = false;
    }
    for (const std::string& name : d_.used) {
      if (name == "KHR_mesh_quantization" && !d_.required.contains(name))
        d_.report(Code("W6215"), d_.root.find("extensionsUsed"), "/extensionsUsed",
                  "KHR_mesh_quantization is used and not required");
      if (reads(name) || is_harmless(name) || d_.required.contains(name)) continue;
      d_.report(Code("N6213"), d_.root.find("extensionsUsed"), "/extensionsUsed",
                fmt::format("the extension {} is left out", in_quotes(name)));
    }
    return accepted;
  }

  Document d_;
};

}  // namespace

Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log) {
  return Reader(files, file, options, log).read();
}

}  // namespace panwright::importers::gltf
