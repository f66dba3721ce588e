// Options of the engines, as typed.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "base/text.h"
#include "workspace/internal/forward.h"
#include "workspace/views.h"

namespace panwright::workspace {

namespace {

using Text = std::optional<std::string>;

constexpr double kWidestPsf = 64;  // pixels

// "2GB" as bytes; units are powers of 1024, as of other options.
std::optional<std::uint64_t> parse_bytes(std::string_view text) {
  constexpr std::string_view kUnits = "kmgtpe";
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  std::string_view rest = lower;
  if (rest.ends_with("ib"))
    rest.remove_suffix(2);
  else if (rest.ends_with('b'))
    rest.remove_suffix(1);
  double unit = 1;
  if (!rest.empty())
    if (const std::size_t power = kUnits.find(rest.back()); power != kUnits.npos) {
      unit = std::exp2(10.0 * static_cast<double>(power + 1));
      rest.remove_suffix(1);
    }
  while (rest.ends_with(' ')) rest.remove_suffix(1);
  const auto number = parse_double(rest);
  const double bytes = number ? *number * unit : -1;
  if (!(bytes >= 0 && bytes < 0x1p63)) return std::nullopt;
  return static_cast<std::uint64_t>(bytes);
}

class DrawReader {
 public:
  explicit DrawReader(DiagnosticLog& log) : log_(log) {}
  bool ok() const { return ok_; }

  void fail(const std::string& message) {
    log_.report(Code::E0201, {}, message);
    ok_ = false;
  }
  void refuse(const char* name, const Text& text, std::string_view expected) {
    fail(fmt::format("--{} is {}, expected {}", name, in_quotes(*text), expected));
  }

  template <class Integer>
  void whole(const char* name, const Text& text, Integer least, Integer most, Integer& value) {
    if (!text) return;
    Integer read = 0;
    const char* end = text->data() + text->size();
    const auto [stop, error] = std::from_chars(text->data(), end, read);
    if (error == std::errc() && stop == end && read >= least && read <= most)
      value = read;
    else
      refuse(name, text, fmt::format("a whole number from {} to {}", least, most));
  }

  void share(const char* name, const Text& text, const char* example, double& value) {
    if (!text) return;
    const auto read = parse_share(*text);
    if (read && *read > 0 && *read < 1)
      value = *read;
    else
      refuse(name, text, fmt::format("a share between 0 and 1, as {}", example));
  }

  void flag(const char* name, const Text& text, bool& value) {
    if (!text) return;
    if (*text == "true" || *text == "false")
      value = *text == "true";
    else
      refuse(name, text, "true or false");
  }

 private:
  DiagnosticLog& log_;
  bool ok_ = true;
};

// An option of the other engine that is given; nullptr: none.
const char* stray_option(const ViewText& text, bool traced) {
  const auto given = [](const Text& value) { return value && *value != "false"; };
  if (traced) {
    if (text.quality) return "quality";
    if (text.shadows) return "shadows";
    if (text.sun_points) return "sun-points";
    if (given(text.adaptive)) return "adaptive";
    if (text.pixel_error) return "pixel-error";
    if (text.levels) return "levels";
    if (text.imposters) return "imposters";
    if (text.flux_error) return "flux-error";
    if (text.specular_filter) return "specular-filter";
    return text.shadow_side ? "shadow-side" : nullptr;
  }
  if (text.until_error) return "until-error";
  if (text.bounces) return "bounces";
  if (text.seed) return "seed";
  if (text.max_samples) return "max-samples";
  return given(text.no_sun_disc) ? "no-sun-disc" : nullptr;
}

// Of images without a given error, in samples: about a second of two processors.
constexpr double kStandardWork = 1 << 20;

// The options of a quality, where none is given.
ViewText with_quality(ViewText text, DrawReader& reader) {
  if (!text.quality || *text.quality == "standard") return text;
  const auto fill = [](Text& option, const char* value) {
    if (!option) option = value;
  };
  const bool free = !text.samples && !text.pixel_error;
  if (*text.quality == "draft") {
    fill(text.samples, text.pixel_error ? "auto" : "4");
    if (text.samples != "auto") fill(text.adaptive, "true");
    if (!text.sun_points) fill(text.shadows, "hard");
    fill(text.flux_error, "1%");
  } else if (*text.quality == "exact") {
    if (free && text.adaptive != "true") fill(text.pixel_error, "1%");
    if (!text.shadows || text.shadows == "auto" || text.shadows == "soft")
      fill(text.sun_points, "64");
    fill(text.flux_error, "0.01%");
  } else {
    reader.refuse("quality", text.quality, "draft, standard or exact");
  }
  return text;
}

// N, or 0 for auto.
unsigned read_samples(const ViewText& text, bool traced, DrawReader& reader) {
  if (!text.samples) return traced ? 8u : 0u;
  if (*text.samples == "auto" && !traced) return 0u;
  const auto number = parse_numbers(*text.samples, 1);
  if (number && (*number)[0] >= 1 && (*number)[0] <= 64 && (*number)[0] == std::floor((*number)[0]))
    return static_cast<unsigned>((*number)[0]);
  reader.refuse("samples", text.samples,
                traced ? "a whole number from 1 to 64" : "a whole number from 1 to 64, or auto");
  return 1;
}

void read_imposters(const ViewText& text, DrawReader& reader, preview::RenderOptions& gl) {
  reader.share("flux-error", text.flux_error, "0.1%", gl.flux_error);
  if (!text.imposters || *text.imposters == "auto") return;
  const auto pixels = parse_numbers(*text.imposters, 1);
  if (*text.imposters == "off")
    gl.imposters = preview::Imposters::off;
  else if (*text.imposters == "always")
    gl.imposters = preview::Imposters::always;
  else if (pixels && (*pixels)[0] >= 0)
    gl.imposter_pixels = (*pixels)[0];
  else
    reader.refuse("imposters", text.imposters, "auto, off, always, or a number of pixels");
}

void read_shadows(const ViewText& text, DrawReader& reader, preview::RenderOptions& gl) {
  const bool off = text.shadows == "off";
  if (text.shadow_side)
    reader.whole("shadow-side", text.shadow_side, 16u, 16384u, gl.shadow_side.emplace());
  reader.whole("sun-points", text.sun_points, 2u, 256u, gl.sun_points);
  if (off && text.shadow_side) reader.fail("--shadow-side cannot be combined with --shadows off");
  if (off) gl.shadow_side = 0;
  if (text.shadows == "hard")
    gl.shadows = preview::Shadows::hard;
  else if (text.shadows == "soft")
    gl.shadows = preview::Shadows::soft;
  else if (text.shadows && text.shadows != "auto" && !off)
    reader.refuse("shadows", text.shadows, "auto, off, hard or soft");
  if (text.sun_points && (off || gl.shadows == preview::Shadows::hard))
    reader.fail("--sun-points needs --shadows auto or soft");
}

void read_gl(const ViewText& text, DrawReader& reader, DrawOptions& draw) {
  preview::RenderOptions& gl = draw.gl;
  gl.samples = draw.samples;
  if (draw.samples == 0 && !text.pixel_error) gl.work = kStandardWork;
  if (text.pixel_error && draw.samples > 0)
    reader.fail("--pixel-error requires --samples auto");
  else
    reader.share("pixel-error", text.pixel_error, "1%", gl.pixel_error);
  reader.flag("adaptive", text.adaptive, gl.adaptive);
  if (gl.adaptive && draw.samples == 0)
    reader.fail("--adaptive requires --samples N; auto is always adaptive");
  gl.specular_filter = text.specular_filter != "off";
  if (text.specular_filter && gl.specular_filter && *text.specular_filter != "auto")
    reader.refuse("specular-filter", text.specular_filter, "auto or off");
  read_shadows(text, reader, gl);
  read_imposters(text, reader, gl);
  if (!text.levels || *text.levels == "auto") return;
  gl.levels = *text.levels != "off";
  if (!gl.levels) return;
  const auto metres = parse_length(*text.levels);
  if (metres && *metres >= 0)
    gl.level_pixel = *metres;
  else
    reader.refuse("levels", text.levels, "auto, off, or a footprint, as 2cm or 0.02 (metres)");
}

void read_reference(const ViewText& text, DrawReader& reader, preview::ReferenceOptions& traced) {
  reader.share("until-error", text.until_error, "0.1%", traced.until_error);
  reader.whole("max-samples", text.max_samples, 32u, 1u << 30, traced.max_samples);
  reader.whole("bounces", text.bounces, 0u, 1000u, traced.bounces);
  reader.whole<std::uint64_t>("seed", text.seed, 0, ~std::uint64_t{0}, traced.seed);
  bool no_disc = false;
  reader.flag("no-sun-disc", text.no_sun_disc, no_disc);
  traced.sun_disc = !no_disc;
}

void read_psf(const ViewText& text, DrawReader& reader, DrawOptions& draw) {
  const auto sigma = parse_numbers(*text.psf, 1);
  if (sigma && (*sigma)[0] >= 0 && (*sigma)[0] <= kWidestPsf)
    draw.gl.psf_sigma = draw.reference.psf_sigma = (*sigma)[0];
  else
    reader.refuse("psf", text.psf, fmt::format("a number from 0 to {} pixels", kWidestPsf));
}

void read_files(const ViewText& text, DrawReader& reader, image::FileOptions& files) {
  reader.flag("compress", text.compress, files.compress);
  if (!text.layers) return;
  files.layers = 0;
  constexpr const char* kSeparators = " \t\r\n,";
  const std::string_view all = *text.layers;
  for (std::size_t at = all.find_first_not_of(kSeparators); at != all.npos;) {
    const std::size_t end = std::min(all.find_first_of(kSeparators, at), all.size());
    const std::string_view name = all.substr(at, end - at);
    const auto* found = std::ranges::find(image::kLayerNames, name);
    if (found == std::end(image::kLayerNames)) {
      const auto near = nearest_name(name, image::kLayerNames);
      return reader.refuse("layers", std::string(name),
                           fmt::format("names of layers: {}{}", fmt::join(image::kLayerNames, ", "),
                                       near ? fmt::format("; did you mean '{}'?", *near) : ""));
    }
    files.layers |= 1u << (found - std::begin(image::kLayerNames));
    at = all.find_first_not_of(kSeparators, end);
  }
  if (files.layers == 0) reader.refuse("layers", text.layers, "the name of one layer or more");
}

Result<DrawOptions> read(const ViewText& typed, preview::ContextKind context, DiagnosticLog& log) {
  DrawReader reader(log);
  DrawOptions draw;
  draw.context = context;
  const bool traced = typed.engine == "reference";
  if (typed.engine && !traced && *typed.engine != "gl") {
    reader.refuse("engine", typed.engine, "gl or reference");
    return failed;
  }
  const ViewText text = with_quality(typed, reader);
  if (const char* stray = stray_option(typed, traced)) {
    reader.fail(fmt::format("--{} requires --engine {}", stray, traced ? "gl" : "reference"));
    return failed;
  }
  draw.engine = traced ? Engine::reference : Engine::gl;
  draw.samples = read_samples(text, traced, reader);
  if (traced)
    read_reference(text, reader, draw.reference);
  else
    read_gl(text, reader, draw);
  if (text.psf) read_psf(text, reader, draw);
  draw.photo = text.tone == "photo";
  if (text.tone && !draw.photo && *text.tone != "linear")
    reader.refuse("tone", text.tone, "linear or photo");
  read_files(text, reader, draw.files);
  reader.flag("flat", text.flat, draw.gl.flat);
  draw.reference.flat = draw.gl.flat;
  if (text.max_image_memory) {
    if (const auto bytes = parse_bytes(*text.max_image_memory))
      draw.gl.max_bytes = draw.reference.max_bytes = *bytes;
    else
      reader.refuse("max-image-memory", text.max_image_memory, "a number of bytes, as 2GB");
  }
  if (!reader.ok()) return failed;
  return draw;
}

}  // namespace

Result<DrawOptions> draw_options(const ViewText& text, preview::ContextKind context,
                                 DiagnosticLog& log) {
  DiagnosticLog apart = log.apart();
  auto draw = read(text, context, apart);
  forward(apart, text.label, text.file, log);
  return draw;
}

}  // namespace panwright::workspace
