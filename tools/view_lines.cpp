#include "tools/view_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/text.h"
#include "tools/words.h"
#include "workspace/sky_settings.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;
using server::SharedLayer;
using server::shared::NumberType;
using workspace::ImageReply;
using workspace::SettingId;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t layer_mask(image::FileLayer layer) {
  return 1u << static_cast<unsigned>(layer);
}

// The first of the order of exit_code() that occurs.
int worse(int a, int b) {
  constexpr int kOrder[] = {130, 70, 2, 3, 4, 1, 0};
  for (const int code : kOrder)
    if (a == code || b == code) return code;
  return a;
}

const char* name_of(NumberType type) {
  constexpr const char* kNames[] = {"float32", "uint32", "uint16"};
  return kNames[static_cast<std::size_t>(type)];
}

// The layers of an image that a view asks for, as files have them.
std::vector<SharedLayer> layers_of(const image::Image& image, const image::FileOptions& options) {
  using image::FileLayer;
  std::vector<SharedLayer> out;
  const auto add = [&](FileLayer layer, const auto& values, NumberType type) {
    if (values.empty() || !options.has(layer)) return;
    const auto channels = static_cast<std::uint32_t>(values.size() / image.pixels());
    out.push_back({image::kLayerNames[static_cast<std::size_t>(layer)], type, channels,
                   std::as_bytes(std::span(values))});
  };
  add(FileLayer::radiance, image.radiance, NumberType::float32);
  add(FileLayer::coverage, image.coverage, NumberType::float32);
  add(FileLayer::depth, image.depth, NumberType::float32);
  add(FileLayer::range, image.range, NumberType::float32);
  add(FileLayer::normal, image.normal, NumberType::float32);
  add(FileLayer::target_id, image.target_id, NumberType::uint32);
  add(FileLayer::node_id, image.node_id, NumberType::uint32);
  add(FileLayer::material_id, image.material_id, NumberType::uint32);
  add(FileLayer::standard_error, image.standard_error, NumberType::float32);
  add(FileLayer::dn, image.dn, NumberType::uint16);
  add(FileLayer::electrons, image.electrons, NumberType::float32);
  return out;
}

// What a page shows of a product, and its exposure in stops.
std::pair<image::Image, double> colours_of(const workspace::Product& product) {
  const auto& from = std::get<workspace::ImageProduct>(product);
  image::Image out;
  out.width = from.image.width;
  out.height = from.image.height;
  out.radiance = from.image.radiance;
  return {std::move(out), from.exposure.stops};
}

}  // namespace

// Answer to one view.
class ViewLines::Reply {
 public:
  explicit Reply(std::size_t index) : index_(index) {}

  void take(const workspace::Written& image) { image_ = image; }
  double seconds() const { return seconds_since(start_); }

  // An image that comes with the answer.
  void take(workspace::Kept& kept, ImageReply way, server::SharedImages& shared,
            DiagnosticLog& log) {
    const auto& product = std::get<workspace::ImageProduct>(kept.product);
    const image::Image& image = product.image;
    const std::vector<SharedLayer> layers = layers_of(image, product.files);
    std::optional<server::SharedImages::Place> place;
    if (way == ImageReply::shared) {
      auto written = shared.write(image.width, image.height, layers, log);
      if (!written) return;
      place = *std::move(written);
      shared_ = {{"name", place->name}, {"number", place->number}, {"slot", place->slot}};
    }
    layers_ = Json::array();
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const SharedLayer& layer = layers[i];
      Json shape = {image.height, image.width};
      if (layer.channels > 1) shape.push_back(layer.channels);
      Json entry = {{"name", layer.name}, {"type", name_of(layer.type)}, {"shape", shape}};
      if (place)
        entry["offset"] = place->offsets[i];
      else
        entry["base64"] =
            base64({reinterpret_cast<const char*>(layer.bytes.data()), layer.bytes.size()});
      layers_.push_back(std::move(entry));
    }
    image_ = kept.what;
  }

  std::string text(const workspace::View& view, const DiagnosticLog& log) const {
    Json reply;
    reply["index"] = index_;
    if (view.settings.name) reply["name"] = *view.settings.name;
    reply["ok"] = image_.has_value() && !log.has_errors();
    reply["outputs"] = Json::array();
    if (image_) {
      reply["outputs"] = *view.settings.outputs;
      describe_image(*image_, reply);
      reply["settings"] = Json::parse(image_->record)["view"];
    }
    // all of it, from the line to the files
    reply["ms"] = 1e3 * seconds();
    if (!shared_.is_null()) reply["shared"] = shared_;
    if (!layers_.is_null()) reply["layers"] = layers_;
    reply["errors"] = log.errors();
    reply["warnings"] = log.warnings();
    reply["diagnostics"] = Json::array();
    const Json all = Json::parse(to_json(log));
    for (const Json& each : all["diagnostics"]) {
      Json entry;
      for (const char* key : {"code", "severity", "message", "hint"})
        if (each.contains(key) && each[key] != "") entry[key] = each[key];
      reply["diagnostics"].push_back(std::move(entry));
    }
    return reply.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

 private:
  std::size_t index_;
  Clock::time_point start_ = Clock::now();
  std::optional<workspace::Written> image_;
  Json shared_, layers_;
};

ViewLines::ViewLines(workspace::ViewSession& session, ViewLineOptions options,
                     const DiagnosticLog& log)
    : session_(session), options_(std::move(options)), log_(log), files_(log.files()) {
  options_.listener.step = {};  // a stream may go on for as long as it likes: nothing is kept
}

DiagnosticLog ViewLines::next_log() {
  DiagnosticLog log = log_.apart();
  // an output may be that of an earlier line, but no input
  files_ = files_->next_run();
  log.set_files(files_);
  return log;
}

bool ViewLines::read(std::string_view line, workspace::View& view, DiagnosticLog& log) const {
  if (!workspace::parse_view(line, index_, options_.defaults, view, log)) return false;
  const auto refuse = [&](const char* message) {
    log.report(Code("E0203"), {}, view.label + ": " + message);
    return false;
  };
  if (!view.settings.outputs && view.reply == ImageReply::files)
    return refuse(options_.foreign && options_.folder.empty()
                      ? "no output, expected \"image\": \"inline\" or \"shared\""
                      : "no output, expected a file name, as \"output\": \"a.png\"");
  if (!view.settings.targets && !workspace::shows_sky(view.settings))
    return refuse("no targets, and none are given on the command line");
  return !options_.foreign || is_allowed(view, log);
}

// Files to read are those of the defaults: no one else names any.
bool ViewLines::is_allowed(const workspace::View& view, DiagnosticLog& log) const {
  const workspace::Settings& settings = view.settings;
  const auto names_file = [](const std::pair<std::string, std::string>& planet) {
    return std::ranges::any_of(
        std::initializer_list<const char*>{"map=", "clouds=", "night="},
        [&](const char* key) { return planet.second.find(key) != std::string::npos; });
  };
  bool good = true;
  if (*settings.max_image_memory > *options_.defaults.max_image_memory) {
    good = false;
    log.report(Code("E0203"), {},
               fmt::format("{}: max-image-memory is above that of this server", view.label));
  }
  const auto compare = [&](SettingId id, bool names) {
    if (!names || setting_texts(id, settings) == setting_texts(id, options_.defaults)) return;
    good = false;
    log.report(Code("E0203"), {},
               fmt::format("{}: {} names files, which this server reads from its own command line "
                           "alone",
                           view.label, info_of(id).name));
  };
  compare(SettingId::targets, bool(settings.targets));
  compare(SettingId::camera_file, bool(settings.camera_file));
  compare(SettingId::star_catalogue, bool(settings.star_catalogue));
  compare(SettingId::planet, std::ranges::any_of(*settings.planet, names_file));
  return good;
}

// Outputs lie below the folder, links followed.
bool ViewLines::place(workspace::View& view, DiagnosticLog& log) const {
  if (!options_.foreign || !view.settings.outputs) return true;
  std::vector<std::string> placed;
  for (const std::string& output : *view.settings.outputs) {
    const std::filesystem::path path(output);
    std::error_code error;
    const auto folder = std::filesystem::canonical(options_.folder, error);
    const auto parent =
        std::filesystem::weakly_canonical(folder / path.parent_path(), error).lexically_normal();
    const auto [end, ignored] =
        std::mismatch(folder.begin(), folder.end(), parent.begin(), parent.end());
    const bool inside = !options_.folder.empty() && !error && path.is_relative() &&
                        end == folder.end() && output.find('\0') == output.npos &&
                        !std::filesystem::is_symlink(parent / path.filename(), error);
    if (!inside) {
      log.report(Code("E0203"), {},
                 fmt::format("{}: {} is outside of the folder of this server{}", view.label,
                             in_quotes(output),
                             options_.folder.empty() ? ", which has none (--folder)" : ""));
      return false;
    }
    placed.push_back((parent / path.filename()).string());
  }
  view.settings.outputs = std::move(placed);
  return true;
}

void ViewLines::draw(workspace::View& view, Reply& reply, DiagnosticLog& log, const Job& job) {
  workspace::RunListener own = options_.listener;
  own.written = [&](const workspace::Written& image) { reply.take(image); };
  if (view.reply != ImageReply::files) {
    own.kept = [&](workspace::Kept& kept) { reply.take(kept, view.reply, shared_, log); };
    if (!view.settings.layers)
      view.settings.layers =
          layer_mask(image::FileLayer::radiance) | layer_mask(image::FileLayer::dn);
  }
  std::optional<server::Drawing> drawing;
  world::Camera camera;
  world::World world;
  if (options_.shown)
    own.seen = [&](const world::World& at_rest, const workspace::Frame& frame,
                   const workspace::Product& product) {
      auto [image, stops] = colours_of(product);
      drawing = server::Drawing{std::move(image), std::exp2(-stops)};
      camera = frame.camera();
      world = at_rest;
      workspace::show(frame, at_rest, world);
    };
  try {
    if (session_.run({&view, 1}, own, log, job) && drawing)
      options_.shown(*std::move(drawing), camera, world, 0, reply.seconds());
  } catch (const std::exception&) {
    report_exception(log);  // the next view may fit
  }
}

std::string ViewLines::finish(const Reply& reply, const workspace::View& view,
                              const DiagnosticLog& log) {
  if (log.has_errors()) code_ = worse(code_, exit_code(log));
  ++index_;
  return reply.text(view, log);
}

std::string ViewLines::answer(std::string_view line, const Job& job) {
  if (line.find_first_not_of(" \t\r") == line.npos) return {};
  Reply reply(index_);
  DiagnosticLog log = next_log();
  workspace::View view;
  if (read(line, view, log)) {
    const auto named = view.settings.outputs;
    if (place(view, log)) draw(view, reply, log, job);
    view.settings.outputs = named;
  }
  return finish(reply, view, log);
}

std::string ViewLines::answer_to_long_line() {
  const Reply reply(index_);
  DiagnosticLog log = next_log();
  workspace::View view;
  workspace::parse_view("{}", index_, options_.defaults, view, log);
  log.report(
      Code("E0203"), {},
      fmt::format("{}: the line has more than {} bytes", view.label, workspace::kMaxViewLine));
  return finish(reply, view, log);
}

}  // namespace panwright::tools
