#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "base/file.h"
#include "base/number_rows.h"
#include "base/text.h"
#include "instruments/lookup.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "workspace/session.h"
#include "workspace/targets.h"

namespace panwright::tools {

namespace command_lookup {
namespace {

using instruments::SurfacePoint;
using Json = nlohmann::ordered_json;
using workspace::SettingId;
using Rows = std::vector<double>;

struct Options {
  CommonOptions common;
  ReadOptions read;
  ViewOptions view;
  std::vector<std::string> targets;  // FILE or NAME=FILE
  std::vector<std::string> pixels, rays, sights, elevations, nearest;
  bool keypoints = false;
  double slack = 1e-4;
  std::string output;
};

void declare_questions(Arguments& arguments, Options& options) {
  constexpr const char* kGroup = "Questions";
  const auto add = [&](const char* name, std::vector<std::string>& texts, const char* help,
                       const char* type) {
    arguments.add(name, texts, help).one_value().numbers().type(type).group(kGroup);
  };
  add("--pixel", options.pixels,
      "Surface at a place of the image: column and row, or a file with one place a line (.csv); "
      "may be repeated, as all questions",
      "\"X Y\"|FILE");
  add("--ray", options.rays, "Surface that a ray meets: origin and direction, world axes, metres",
      "\"X Y Z DX DY DZ\"|FILE");
  add("--sight", options.sights, "Whether nothing stands between two points",
      "\"X Y Z X Y Z\"|FILE");
  add("--elevation", options.elevations, "Highest surface at a place, along the world's z axis",
      "\"X Y\"|FILE");
  add("--nearest", options.nearest, "Point of a surface that is nearest to a point",
      "\"X Y Z\"|FILE");
  arguments
      .flag("--keypoints", options.keypoints,
            "Keypoints of the targets: pixels, and whether they are hidden and lit")
      .group(kGroup);
  arguments
      .add("--slack", options.slack,
           "Metres at both ends of a line of sight, and beside a keypoint, where surfaces do not "
           "count (default 0.0001)")
      .not_negative()
      .length()
      .type("METRES")
      .group(kGroup);
}

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("input", options.targets,
           "Targets: .pan, .pxn or CAD files; NAME=FILE names a target (default: the file's name)")
      .required()
      .type("[NAME=]FILE…");
  declare_questions(arguments, options);
  arguments.add("-o,--output", options.output, "Write the answers as a table, one a line")
      .type("FILE.csv");
  for (const SettingId id :
       {SettingId::camera, SettingId::look_at, SettingId::up, SettingId::quat,
        SettingId::camera_frame, SettingId::fov, SettingId::ifov, SettingId::intrinsics,
        SettingId::distortion, SettingId::camera_file, SettingId::ortho, SettingId::size,
        SettingId::pose, SettingId::joint, SettingId::sun})
    declare(arguments, options.view, id);
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

Vec3 vec3_at(const Rows& rows, std::size_t at) { return {rows[at], rows[at + 1], rows[at + 2]}; }

std::string words(const Vec3& v) {
  return fmt::format("{} {} {}", format_double(v.x), format_double(v.y), format_double(v.z));
}

// Questions and answers of one run.
class LookupRun {
 public:
  LookupRun(const Options& options, CommandContext& context)
      : options_(options), context_(context), log_(context.log()) {}

  bool run() {
    if (!read_questions() || !open()) return false;
    context_.step("look up");
    ask();
    lookups_.report_damaged(log_);
    if (!options_.output.empty()) {
      if (!write_file(options_.output, as_bytes(table_), log_)) return false;
      context_.wrote(options_.output);
    }
    return true;
  }

 private:
  bool json() const { return options_.common.json; }

  bool rows_of(const std::vector<std::string>& texts, std::size_t columns, const char* option,
               Rows& rows) {
    for (const std::string& text : texts) {
      auto numbers = numbers_in(text);
      if (text.ends_with(".csv") || text.ends_with(".txt")) {
        context_.files().will_read(text);
        const auto read = read_number_rows(text, columns, Code("E0262"), log_);
        if (!read) return false;
        numbers = *read;
      } else if (!numbers || numbers->size() != columns) {
        log_.report(Code("E0201"), {},
                    fmt::format("{} is {}, expected {}, or a file with as many in each line (.csv)",
                                option, in_quotes(text), counted(columns, "number")));
        return false;
      }
      rows.insert(rows.end(), numbers->begin(), numbers->end());
    }
    return true;
  }

  bool read_questions() {
    if (!rows_of(options_.pixels, 2, "--pixel", pixels_) ||
        !rows_of(options_.rays, 6, "--ray", rays_) ||
        !rows_of(options_.sights, 6, "--sight", sights_) ||
        !rows_of(options_.elevations, 2, "--elevation", elevations_) ||
        !rows_of(options_.nearest, 3, "--nearest", nearest_))
      return false;
    const std::size_t count = pixels_.size() + rays_.size() + sights_.size() + elevations_.size() +
                              nearest_.size() + (options_.keypoints ? 1 : 0);
    if (count == 0)
      log_.report(Code("E0201"), {},
                  "no question is given, expected --pixel, --ray, --sight, --elevation, --nearest "
                  "or --keypoints");
    for (std::size_t i = 0; i < rays_.size(); i += 6)
      if (vec3_at(rays_, i + 3) == Vec3(0)) {
        log_.report(Code("E0201"), {}, "--ray has the direction 0 0 0, expected another");
        break;
      }
    return !log_.has_errors() &&
           (options_.output.empty() || context_.files().will_write(options_.output, "-o", log_));
  }

  bool open() {
    auto read = options_.read.opening(log_);
    auto settings = options_.view.settings(log_);
    if (!read || !settings) return false;
    settings->targets = options_.targets;
    if (!read->parameters.empty()) settings->define = std::exchange(read->parameters, {});
    read->prune = false;  // as `render`
    const workspace::View view(*std::move(settings));
    if (!workspace::check(view, log_)) return false;
    workspace::ViewSession session(*std::move(read), preview::ContextKind::automatic);
    const world::World* world = session.world(view, {}, log_, context_.job());
    if (world == nullptr || log_.has_errors()) return false;
    const auto frame = session.frame(view, log_);
    if (!frame) return false;
    camera_ = frame->camera();
    world::World shown = *world;
    workspace::show(*frame, *world, shown);
    lookups_.update(shown, context_.job());
    return true;
  }

  std::string name_of(const trace::Ids& ids) const {
    if (ids.target == 0) return "";
    return lookups_.world()[ids.target - 1].name();
  }

  std::string node_of(const trace::Ids& ids) const {
    if (ids.target == 0) return "";
    return lookups_.world()[ids.target - 1].model()->node_path(ids.node - 1);
  }

  std::string material_of(const trace::Ids& ids) const {
    if (ids.target == 0) return "";
    if (ids.material == 0) return "terrain";
    return std::string(lookups_.world()[ids.target - 1].model()->material_name(ids.material - 1));
  }

  void line(const std::string& text) {
    if (!json()) print("{}\n", text);
  }

  void head(const char* columns) {
    if (heads_++ > 0) table_ += "\n";
    table_ += columns;
    table_ += "\n";
  }

  void answer(const char* kind, std::span<const double> question, const SurfacePoint& found) {
    const std::string asked = fmt::format("{}", fmt::join(question, " "));
    table_ += fmt::format("{},{}", kind, fmt::join(question, ","));
    if (!found) {
      table_ += ",,,,,,,,0,0,0,0\n";
      line(fmt::format("{} {}: nothing", kind, asked));
    } else {
      table_ += fmt::format(",{},{},{},{},{},{},{},{},{},{},{}\n", found.distance, found.position.x,
                            found.position.y, found.position.z, found.normal.x, found.normal.y,
                            found.normal.z, found.ids.target, found.ids.node, found.ids.material,
                            found.ids.instance);
      line(fmt::format("{} {}: {} m, at {}, normal {:.6f} {:.6f} {:.6f}, {} {} {}", kind, asked,
                       format_double(found.distance), words(found.position), found.normal.x,
                       found.normal.y, found.normal.z, name_of(found.ids), node_of(found.ids),
                       material_of(found.ids)));
    }
    if (!json()) return;
    Json out{{"kind", kind}, {"asked", std::vector<double>(question.begin(), question.end())}};
    out["found"] = static_cast<bool>(found);
    if (found) {
      const auto list = [](const Vec3& v) { return Json{v.x, v.y, v.z}; };
      out["distance"] = found.distance;
      out["position"] = list(found.position);
      out["in_model"] = list(found.in_model);
      out["facet"] = list(found.facet);
      out["normal"] = list(found.normal);
      out["target"] = name_of(found.ids);
      out["node"] = node_of(found.ids);
      out["material"] = material_of(found.ids);
      out["ids"] = {found.ids.target, found.ids.node, found.ids.material, found.ids.instance};
    }
    context_.result()["surfaces"].push_back(std::move(out));
  }

  void answers(const char* kind, const char* columns, const Rows& rows, std::size_t width,
               std::span<const SurfacePoint> found) {
    if (found.empty()) return;
    head(fmt::format("kind,{},distance,x,y,z,nx,ny,nz,target_id,node_id,material_id,instance_id",
                     columns)
             .c_str());
    for (std::size_t i = 0; i < found.size(); ++i)
      answer(kind, std::span(rows).subspan(i * width, width), found[i]);
  }

  void ask() {
    const Job& job = context_.job();
    context_.result()["surfaces"] = Json::array();
    context_.result()["sights"] = Json::array();
    std::vector<SurfacePoint> found(pixels_.size() / 2);
    std::vector<Vec2> places;
    for (std::size_t i = 0; i < pixels_.size(); i += 2)
      places.emplace_back(pixels_[i], pixels_[i + 1]);
    lookups_.pixels(camera_, places, found, job);
    answers("pixel", "column,row", pixels_, 2, found);

    std::vector<geometry::Ray> rays;
    for (std::size_t i = 0; i < rays_.size(); i += 6) {
      const Vec3 along = vec3_at(rays_, i + 3);
      const double largest = std::max({std::fabs(along.x), std::fabs(along.y), std::fabs(along.z)});
      rays.push_back({vec3_at(rays_, i), glm::normalize(along / largest)});
    }
    found.assign(rays.size(), {});
    lookups_.rays(rays, found, job);
    answers("ray", "ox,oy,oz,dx,dy,dz", rays_, 6, found);

    places.clear();
    for (std::size_t i = 0; i < elevations_.size(); i += 2)
      places.emplace_back(elevations_[i], elevations_[i + 1]);
    found.assign(places.size(), {});
    lookups_.elevations(places, found, job);
    answers("elevation", "px,py", elevations_, 2, found);

    std::vector<Vec3> points;
    for (std::size_t i = 0; i < nearest_.size(); i += 3) points.push_back(vec3_at(nearest_, i));
    found.assign(points.size(), {});
    lookups_.nearest(points, found, job);
    answers("nearest", "px,py,pz", nearest_, 3, found);
    ask_sights();
    if (options_.keypoints) ask_keypoints();
  }

  void ask_sights() {
    std::vector<instruments::Sight> sights;
    for (std::size_t i = 0; i < sights_.size(); i += 6)
      sights.push_back({vec3_at(sights_, i), vec3_at(sights_, i + 3)});
    if (sights.empty()) return;
    std::vector<std::uint8_t> open(sights.size());
    lookups_.sights(sights, options_.slack, open, context_.job());
    head("kind,x1,y1,z1,x2,y2,z2,open");
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const auto asked = std::span(sights_).subspan(6 * i, 6);
      table_ += fmt::format("sight,{},{}\n", fmt::join(asked, ","), open[i]);
      line(fmt::format("sight {}: {}", fmt::join(asked, " "), open[i] ? "open" : "blocked"));
      context_.result()["sights"].push_back(
          {{"asked", std::vector<double>(asked.begin(), asked.end())}, {"open", open[i] != 0}});
    }
  }

  void ask_keypoints() {
    const auto all = lookups_.keypoints(camera_, options_.slack);
    Json& list = context_.result()["keypoints"] = Json::array();
    head("kind,target,name,x,y,z,column,row,truncated,occluded,lit");
    for (std::size_t target = 0; target < all.size(); ++target)
      for (const labels::Keypoint& each : all[target]) {
        const std::string& name = lookups_.world()[target].name();
        const std::string pixel =
            each.pixel ? fmt::format("{},{}", each.pixel->x, each.pixel->y) : ",";
        table_ += fmt::format("keypoint,{},{},{},{},{},{},{:d},{:d},{:d}\n", name, each.name,
                              each.position.x, each.position.y, each.position.z, pixel,
                              each.truncated, each.occluded, each.lit);
        line(fmt::format("keypoint {} {}: {}{}{}{}", name, each.name,
                         each.pixel
                             ? fmt::format("pixel {:.3f} {:.3f}", each.pixel->x, each.pixel->y)
                             : "no pixel",
                         each.truncated ? ", outside the image" : "",
                         each.occluded ? ", hidden" : ", visible", each.lit ? ", lit" : ""));
        Json out{{"target", name},
                 {"name", each.name},
                 {"position", {each.position.x, each.position.y, each.position.z}}};
        if (each.pixel) out["pixel"] = {each.pixel->x, each.pixel->y};
        out["truncated"] = each.truncated;
        out["occluded"] = each.occluded;
        out["lit"] = each.lit;
        list.push_back(std::move(out));
      }
  }

  const Options& options_;
  CommandContext& context_;
  DiagnosticLog& log_;
  Rows pixels_, rays_, sights_, elevations_, nearest_;  // one after the other
  instruments::Lookups lookups_;
  world::Camera camera_;
  std::string table_;
  int heads_ = 0;
};

int run(const Options& options, const Host& host) {
  CommandContext context("lookup", options.common, host);
  try {
    (void)LookupRun(options, context).run();
  } catch (const Cancelled&) {
    report_cancelled(context.log());
  }
  return context.finish();
}

}  // namespace
}  // namespace command_lookup

Command lookup_command() {
  return command("lookup", "Look up surfaces, lines of sight and keypoints of a model",
                 command_lookup::declare_all, command_lookup::run);
}

}  // namespace panwright::tools
