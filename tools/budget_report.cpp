#include "tools/budget_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "base/file.h"
#include "base/text.h"
#include "compiler/size.h"
#include "tools/report_page.h"
#include "tools/words.h"
#include "workspace/open.h"

namespace panwright::tools {

namespace {

using compiler::FitReport;
using compiler::length_in_words;
using compiler::PartReport;
using compiler::Report;
using Json = nlohmann::ordered_json;

constexpr std::size_t kTextRows = 20;

// What of the budget's terms was used, as far as there are bounds.
struct Spent {
  double pixel = 0;              // metres that a pixel sees at the nearest; 0: not stated
  double error_pixels = 0;       // the largest error of a shape or simplified mesh, at its nearest
  double centroid_left_out = 0;  // pixels
  std::uint64_t triangles = 0, bytes = 0;
  double seconds = 0;
};

Spent spent_of(const scene::Budget& budget, const Report& report) {
  Spent out;
  if (budget.nearest && budget.ifov) out.pixel = *budget.nearest * *budget.ifov;
  for (const PartReport& part : report.parts) {
    if (out.pixel > 0 && part.nearest > 0)
      out.error_pixels = std::max(out.error_pixels, part.achieved / (part.nearest * *budget.ifov));
    out.triangles += part.triangles;
    out.bytes += part.bytes;
    out.seconds += part.seconds;
  }
  for (const compiler::Simplified& mesh : report.fit.simplified) out.seconds += mesh.seconds;
  if (out.pixel > 0) out.centroid_left_out = report.fit.centroid_left_out / out.pixel;
  return out;
}

std::string angle_words(double radians) {
  return radians >= 1e-4 ? fmt::format("{:.4g} mrad", radians * 1e3)
                         : fmt::format("{:.4g} µrad", radians * 1e6);
}

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

// The terms, one line each: what was asked, and what came of it.
struct Line {
  std::string term, asked, achieved;
};

std::vector<Line> lines_of(const scene::Budget& budget, const Report& report) {
  const Spent spent = spent_of(budget, report);
  std::vector<Line> out;
  if (budget.tolerance)
    out.push_back({"distance", length_in_words(*budget.tolerance),
                   length_in_words(report.worst_error) + " at most"});
  if (spent.pixel > 0)
    out.push_back({"camera",
                   fmt::format("{} away, {} a pixel", length_in_words(*budget.nearest),
                               angle_words(*budget.ifov)),
                   fmt::format("a pixel sees {}", length_in_words(spent.pixel))});
  if (!budget.approach.empty())
    out.push_back(
        {"approach",
         fmt::format("along {}, within {:.4g}°", budget.approach, budget.corridor / kDegree), ""});
  if (budget.pixels)
    out.push_back({"silhouettes", fmt::format("{:.4g} px", *budget.pixels),
                   fmt::format("{:.3g} px at most", spent.error_pixels)});
  if (budget.flux) {
    const FitReport& fit = report.fit;
    out.push_back(
        {"flux", percent(*budget.flux),
         fmt::format("{}: parts left out {}, simplified meshes {}, shapes {}",
                     percent(fit.flux_left_out + fit.flux_simplified + report.flux_shapes),
                     percent(fit.flux_left_out), percent(fit.flux_simplified),
                     percent(report.flux_shapes))});
  }
  if (budget.centroid)
    out.push_back({"photocentre", fmt::format("{:.4g} px", *budget.centroid),
                   fmt::format("parts left out {:.3g} px at most", spent.centroid_left_out)});
  return out;
}

std::string time_words(double seconds) {
  return seconds >= 1 ? fmt::format("{:.3g} s", seconds) : fmt::format("{:.3g} ms", 1e3 * seconds);
}

double seconds_of(const PartReport& part, const Report& report) {
  double seconds = part.seconds;
  for (const compiler::Simplified& mesh : report.fit.simplified)
    if (mesh.name == part.name && mesh.after * part.instances == part.triangles)
      seconds += mesh.seconds;
  return seconds;
}

std::uint64_t without_fit(const Report& report) {
  std::uint64_t sum = report.fit.triangles_left_out;
  for (const compiler::Simplified& mesh : report.fit.simplified) sum += mesh.before - mesh.after;
  return sum;
}

}  // namespace

Json budget_json(const scene::Budget& budget, const Report& report) {
  const auto term = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  const Spent spent = spent_of(budget, report);
  Json out{
      {"asked",
       {{"tolerance", term(budget.tolerance)},
        {"nearest", term(budget.nearest)},
        {"ifov", term(budget.ifov)},
        {"pixels", term(budget.pixels)},
        {"flux", term(budget.flux)},
        {"centroid", term(budget.centroid)},
        {"approach", budget.approach.empty() ? Json(nullptr) : Json(budget.approach)},
        {"corridor", budget.approach.empty() ? Json(nullptr) : Json(budget.corridor)}}},
      {"achieved",
       {{"error", report.worst_error},
        {"pixels", spent.pixel > 0 ? Json(spent.error_pixels) : Json(nullptr)},
        {"flux_left_out", report.fit.flux_left_out},
        {"flux_simplified", report.fit.flux_simplified},
        {"flux_shapes", report.flux_shapes},
        {"centroid_left_out", spent.pixel > 0 ? Json(spent.centroid_left_out) : Json(nullptr)}}},
      {"pieces", report.fit.pieces},
      {"pieces_left_out", report.fit.pieces_left_out},
      {"triangles_left_out", report.fit.triangles_left_out},
      {"seconds", report.fit.seconds}};
  Json& parts = out["parts"] = Json::array();
  for (const PartReport& part : report.parts)
    parts.push_back({{"name", part.name},
                     {"mesh", part.mesh},
                     {"instances", part.instances},
                     {"triangles", part.triangles},
                     {"bytes", part.bytes},
                     {"nearest", part.nearest > 0 ? Json(part.nearest) : Json(nullptr)},
                     {"tolerance", part.asked > 0 ? Json(part.asked) : Json(nullptr)},
                     {"reason", part.reason},
                     {"error", part.achieved},
                     {"seconds", seconds_of(part, report)}});
  Json& left = out["left_out"] = Json::array();
  for (const compiler::LeftOut& part : report.fit.left_out)
    left.push_back({{"name", part.name},
                    {"pieces", part.pieces},
                    {"triangles", part.triangles},
                    {"area", part.area}});
  Json& simplified = out["simplified"] = Json::array();
  for (const compiler::Simplified& mesh : report.fit.simplified)
    simplified.push_back({{"name", mesh.name},
                          {"before", mesh.before},
                          {"after", mesh.after},
                          {"error", mesh.error},
                          {"flux", mesh.flux},
                          {"normals", mesh.normals},
                          {"seconds", mesh.seconds}});
  return out;
}

std::string budget_text(const std::string& model, const scene::Budget& budget,
                        const Report& report) {
  const Spent spent = spent_of(budget, report);
  std::string out =
      fmt::format("{}: {}, {} of meshes, made in {}\n", model, counted(spent.triangles, "triangle"),
                  bytes_words(spent.bytes), time_words(spent.seconds));
  if (!budget.any())
    return out + "no budget: every part within 1 mm, round ones within 3 % of their flux\n";
  for (const Line& line : lines_of(budget, report))
    out += fmt::format("  {:<12} {:<32} {}\n", line.term, line.asked, line.achieved);
  const FitReport& fit = report.fit;
  if (fit.pieces_left_out > 0) {
    out += fmt::format("left out: {} of {}\n", fit.pieces_left_out, counted(fit.pieces, "part"));
    for (std::size_t i = 0; i < std::min(kTextRows, fit.left_out.size()); ++i)
      out += fmt::format("  {:>9.3g} m²  {:>6}  {}\n", fit.left_out[i].area, fit.left_out[i].pieces,
                         fit.left_out[i].name);
  }
  if (!fit.simplified.empty()) out += "simplified: triangles before, after; error\n";
  for (std::size_t i = 0; i < std::min(kTextRows, fit.simplified.size()); ++i) {
    const compiler::Simplified& mesh = fit.simplified[i];
    out += fmt::format("  {:>9} {:>9}  {:>9}  {}\n", mesh.before, mesh.after,
                       length_in_words(mesh.error), mesh.name);
  }
  out += "parts: triangles, bytes, time; error of tolerance\n";
  for (std::size_t i = 0; i < std::min(kTextRows, report.parts.size()); ++i) {
    const PartReport& part = report.parts[i];
    out += fmt::format("  {:>9} {:>9} {:>8}  {} of {}  {}{}\n", part.triangles,
                       bytes_words(part.bytes), time_words(seconds_of(part, report)),
                       length_in_words(part.achieved),
                       part.asked > 0 ? length_in_words(part.asked) : "as given", part.name,
                       part.instances > 1 ? fmt::format(" (and {} more)", part.instances - 1) : "");
  }
  if (report.parts.size() > kTextRows)
    out += fmt::format("  and {} more\n", report.parts.size() - kTextRows);
  return out;
}

std::string budget_page(const std::string& model, const scene::Budget& budget,
                        const Report& report) {
  const Spent spent = spent_of(budget, report);
  Json all = budget_json(budget, report);
  Json out{{"summary",
            {{"triangles", spent.triangles},
             {"triangles_without_cuts", spent.triangles + without_fit(report)},
             {"bytes", spent.bytes},
             {"file_bytes", report.bytes},
             {"seconds", spent.seconds}}},
           {"asked_and_achieved", Json::array()}};
  for (const Line& line : lines_of(budget, report))
    out["asked_and_achieved"].push_back(
        {{"term", line.term}, {"asked", line.asked}, {"achieved", line.achieved}});
  if (!budget.any())
    out["asked_and_achieved"] =
        "The model has no budget: every part is within 1 mm of its shape, and round ones "
        "within 3 % of their flux.";
  for (Json& part : all["parts"])
    part["share_of_tolerance"] =
        part["tolerance"].is_null()
            ? Json()
            : Json(part["error"].get<double>() / part["tolerance"].get<double>());
  for (const char* name : {"parts", "simplified", "left_out"}) out[name] = std::move(all[name]);
  return report_page(std::filesystem::path(model).filename().string() + ": budget", out);
}

bool write_budget_report(const std::string& file, const std::string& model,
                         const scene::Budget& budget, const Report& report,
                         CommandContext& context) {
  const std::string extension = workspace::extension_of(file);
  const std::string text = extension == ".json" ? budget_json(budget, report).dump(2) + "\n"
                           : extension == ".html" || extension == ".htm"
                               ? budget_page(model, budget, report)
                               : budget_text(model, budget, report);
  if (!write_file(file, as_bytes(text), context.log())) return false;
  context.wrote(file);
  return true;
}

}  // namespace panwright::tools
