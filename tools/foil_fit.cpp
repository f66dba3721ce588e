#include "tools/foil_fit.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/print.h"
#include "workspace/quantities.h"

namespace panwright::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Row {
  const char* name;
  std::optional<double> asked;
  mli::Spread fitted, checked;
  bool is_length;
};

std::vector<Row> rows(const mli::Fit& fit, const mli::FitTarget& target) {
  const mli::FitStatistics &a = fit.fitted, &b = fit.checked;
  return {{"slope_rms", target.slope_rms, a.slope_rms, b.slope_rms, false},
          {"correlation", target.correlation, a.correlation, b.correlation, true},
          {"height_rms", target.height_rms, a.height_rms, b.height_rms, true}};
}

// Attributes of an operation, or its content.
struct OperationText {
  static std::string number(double value) { return format_double(value); }
  static std::string length(double value) {
    if (value != 0 && std::fabs(value) < 0.1) {
      const double mm = value * 1000;
      // only where it reads back as the same
      const std::string text = fmt::format("{:.4g}", mm);
      if (workspace::parse_length(text + "mm") == value) return text + "mm";
    }
    return format_double(value);
  }
  static std::string content(std::string_view name, const std::string& text) {
    return fmt::format("<{0}> {1} </{0}>", name, text);
  }

  std::string operator()(const mli::Random& op) const {
    return content("random", length(op.amplitude));
  }
  std::string operator()(const mli::Smooth& op) const {
    return content("smooth", std::to_string(op.passes));
  }
  std::string operator()(const mli::Constant& op) const {
    return content("constant", length(op.height));
  }
  std::string operator()(const mli::Taper& op) const {
    return content("taper", fmt::format("{} {} {} {}", length(op.x0), length(op.x1), length(op.y0),
                                        length(op.y1)));
  }
  std::string operator()(const mli::Wrinkle& op) const {
    return fmt::format(
        R"(<wrinkle wavelength="{}" amplitude="{}" direction="{}rad" anisotropy="{}"/>)",
        length(op.wavelength), length(op.amplitude), number(op.direction), number(op.anisotropy));
  }
  std::string operator()(const mli::Crease& op) const {
    return fmt::format(
        R"(<crease density="{}" depth="{}" length="{}" spread="{}" tail="{}" tail_share="{}"/>)",
        number(op.density), length(op.depth), length(op.length), number(op.spread), number(op.tail),
        number(op.tail_share));
  }
  std::string operator()(const mli::Fractal& op) const {
    return fmt::format(R"(<fractal hurst="{}" rms="{}"{}/>)", number(op.hurst), length(op.rms),
                       op.longest > 0 ? fmt::format(R"( longest="{}")", length(op.longest)) : "");
  }
  std::string operator()(const mli::Emboss& op) const {
    return fmt::format(R"(<emboss pattern="{}" pitch="{}" depth="{}"/>)",
                       op.pattern == mli::Pattern::quilt ? "quilt" : "diamond", length(op.pitch),
                       length(op.depth));
  }
  std::string operator()(const mli::Seam& op) const {
    return fmt::format(
        R"(<seam along="{}" position="{}" width="{}" height="{}" stitch="{}" pucker="{}"/>)",
        op.along_x ? "x" : "y", length(op.position), length(op.width), length(op.height),
        length(op.stitch), length(op.pucker));
  }
  std::string operator()(const mli::Button& op) const {
    return fmt::format(R"(<button pitch="{}" radius="{}" reach="{}" pucker="{}"/>)",
                       length(op.pitch), length(op.radius), length(op.reach), length(op.pucker));
  }
  std::string operator()(const mli::Crush& op) const {
    return fmt::format(R"(<crush size="{}" depth="{}"/>)", length(op.size), length(op.depth));
  }
  std::string operator()(const mli::SlopeRms& op) const {
    return content("slope_rms", number(op.slope));
  }
};

bool refuse(std::string_view item, DiagnosticLog& log) {
  log.report(Code("E0201"), {},
             fmt::format("--fit: {} is not valid, expected slope_rms=NUMBER, correlation=LENGTH "
                         "and height_rms=LENGTH, separated by blanks, each once",
                         in_quotes(item)),
             "as in --fit \"slope_rms=0.15 correlation=2cm\"");
  return false;
}

bool take(std::string_view item, mli::FitTarget& target, DiagnosticLog& log) {
  const std::size_t equals = item.find('=');
  if (equals == std::string_view::npos) return refuse(item, log);
  const std::string_view name = item.substr(0, equals), value = item.substr(equals + 1);
  std::optional<double>* const out = name == "slope_rms"     ? &target.slope_rms
                                     : name == "correlation" ? &target.correlation
                                     : name == "height_rms"  ? &target.height_rms
                                                             : nullptr;
  if (!out || *out) return refuse(item, log);
  *out = name == "slope_rms" ? parse_double(value) : workspace::parse_length(value);
  return *out ? true : refuse(item, log);
}

// To a tenth, and never -0.
double rounded_percent(double share) { return std::round(share * 1000) / 10 + 0.0; }

std::string value_text(const Row& row, double value) {
  return row.is_length ? fmt::format("{:.4g} mm", value * 1000) : fmt::format("{:.4f}", value);
}

}  // namespace

std::optional<mli::FitTarget> fit_target(std::string_view text, DiagnosticLog& log) {
  constexpr std::string_view kBetween = " ,\t\n";
  mli::FitTarget target;
  bool any = false;
  for (std::size_t at = text.find_first_not_of(kBetween); at != std::string_view::npos;
       at = text.find_first_not_of(kBetween, at)) {
    const std::size_t end = std::min(text.find_first_of(kBetween, at), text.size());
    if (!take(text.substr(at, end - at), target, log)) return std::nullopt;
    any = true;
    at = end;
  }
  if (any) return target;
  refuse(text, log);
  return std::nullopt;
}

std::string recipe_text(const mli::Recipe& recipe, std::string_view material, bool from_library) {
  std::string out;
  if (from_library) out = fmt::format("<material name=\"{0}\" preset=\"{0}\"/>\n", material);
  out += fmt::format("<mli type=\"flat\" seed=\"{}\"", recipe.seed);
  // note: the material of what names none
  if (!material.empty() && material != "default") out += fmt::format(" material=\"{}\"", material);
  out += ">\n  <mli_settings>\n";
  for (const std::string& each :
       {OperationText::content("width", OperationText::number(recipe.width)),
        OperationText::content("height", OperationText::number(recipe.height)),
        OperationText::content("xgrid", std::to_string(recipe.xgrid))})
    out += "    " + each + "\n";
  out += "  </mli_settings>\n  <mli_operations>\n";
  for (const mli::Operation& each : recipe.operations)
    out += "    " + std::visit(OperationText{}, each) + "\n";
  return out + "  </mli_operations>\n</mli>\n";
}

Json fit_json(const mli::Fit& fit, const mli::FitTarget& target, const std::string& text) {
  Json out;
  const auto sheets = [](const mli::FitStatistics& s) {
    return Json{{"first_seed", s.first_seed}, {"sheets", s.sheets}};
  };
  out["fitted"] = sheets(fit.fitted);
  out["checked"] = sheets(fit.checked);
  out["statistics"] = Json::array();
  for (const Row& row : rows(fit, target)) {
    Json one{{"name", row.name}, {"asked", nullptr}, {"fitted", row.fitted.mean}};
    if (row.asked) one["asked"] = *row.asked;
    one["checked"] = row.checked.mean;
    one["standard_error"] = row.checked.error(fit.checked.sheets);
    one["deviation"] = row.checked.deviation;
    out["statistics"].push_back(std::move(one));
  }
  out["pxn"] = text;
  return out;
}

void print_fit(const mli::Fit& fit, const mli::FitTarget& target, const std::string& text) {
  print("\nfitted to the mean of seeds {} to {}, checked with the next {}:\n",
        fit.fitted.first_seed, fit.fitted.first_seed + fit.fitted.sheets - 1, fit.checked.sheets);
  for (const Row& row : rows(fit, target)) {
    const double error = row.checked.error(fit.checked.sheets);
    print("  {:<12}{}, checked {} ± {}{}; one sheet ± {:.0f} %\n", row.name,
          row.asked ? fmt::format("asked {}, fitted {}", value_text(row, *row.asked),
                                  value_text(row, row.fitted.mean))
                    : fmt::format("fitted {}", value_text(row, row.fitted.mean)),
          value_text(row, row.checked.mean), value_text(row, error),
          row.asked
              ? fmt::format(" ({:+.1f} %)", rounded_percent(row.checked.mean / *row.asked - 1))
              : std::string(),
          100 * row.checked.deviation / row.checked.mean);
  }
  print("\n{}", text);
}

}  // namespace panwright::tools
