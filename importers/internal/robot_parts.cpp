#include "importers/internal/robot_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace panwright::importers {

namespace {

constexpr double kLargestNumber = 1e12;  // metres, angles and kilograms that anyone means

}  // namespace

std::optional<std::vector<double>> XmlValues::numbers(const pugi::xml_node& element,
                                                      const pugi::xml_attribute& attribute,
                                                      std::size_t least, std::size_t most) const {
  if (!attribute) return std::nullopt;
  std::vector<double> out;
  std::string_view rest = attribute.value();
  bool usable = true;
  constexpr std::string_view kSpace = " \t\r\n";
  while (usable) {
    rest.remove_prefix(std::min(rest.find_first_not_of(kSpace), rest.size()));
    if (rest.empty()) break;
    std::string_view word = rest.substr(0, rest.find_first_of(kSpace));
    rest.remove_prefix(word.size());
    if (word.size() > 1 && word[0] == '+') word.remove_prefix(1);
    const auto number = parse_double(word);
    usable = out.size() < most && number && std::fabs(*number) <= kLargestNumber;
    if (usable) out.push_back(*number);
  }
  if (usable && out.size() >= least) return out;
  wrong(text_.at(attribute),
        fmt::format("{} of <{}> is {}, expected {} of at most {:g}", attribute.name(),
                    element.name(), in_quotes(attribute.value()),
                    most == kAnyNumber ? "numbers"
                    : least == most    ? counted(most, "number")
                                       : fmt::format("{} to {} numbers", least, most),
                    kLargestNumber));
  return std::nullopt;
}

std::optional<Vec3> unit_vector(const Vec3& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  // in two steps, so that no square gets lost
  if (largest > 0 && std::isfinite(1 / largest)) return glm::normalize(v / largest);
  return std::nullopt;
}

std::string near_hint(std::string_view name, const std::vector<std::string_view>& names) {
  const auto near = nearest_name(name, names);
  return near ? fmt::format("did you mean {}?", in_quotes(*near)) : std::string();
}

std::string scene_name(const std::string& name) {
  std::string out = to_utf8(name, Encoding::utf8);
  std::ranges::replace(out, '/', '_');
  return out;
}

bool RobotScene::add_shape(const geometry::Shape& shape, std::int32_t node, const Cover& cover,
                           SourceSpan where) {
  if (const auto problem = geometry::problem_of(shape)) {
    c_.log.report(problem->code, where, fmt::format("{}; the part is left out", problem->message));
    return false;
  }
  scene().shapes.push_back(shape);
  place_shape(static_cast<std::int32_t>(scene().shapes.size() - 1), node, cover, where);
  return true;
}

void RobotScene::place_shape(std::int32_t shape, std::int32_t node, const Cover& cover,
                             SourceSpan where) {
  scene::Instance instance;
  instance.node = node;
  instance.shape = shape;
  instance.material =
      cover.material == scene::kNone ? assembly.plain_material(false) : cover.material;
  instance.texture = cover.texture;
  instance.source = assembly.source_of(where);
  scene().instances.push_back(std::move(instance));
}

Imported RobotScene::finished() {
  assembly.out().in_metres = true;
  c_.tell();
  std::vector<scene::Input>& inputs = scene().inputs;
  inputs = std::move(c_.inputs);
  for (scene::Input& input : meshes.take_inputs())
    if (std::ranges::none_of(inputs, [&](const auto& known) { return known.path == input.path; }))
      inputs.push_back(std::move(input));
  return std::move(assembly.out());
}

Result<Imported> read_robot_file(
    Files& files, const InputFile& file, const Options& options, DiagnosticLog& log,
    const std::function<std::optional<Imported>(XmlText&, meshes::ReaderContext&)>& made,
    const char* empty) {
  meshes::ReaderContext context(files, file, options, true, log);
  context.tolerated = Code("W6221");
  const std::size_t errors = log.errors();
  XmlText text;
  if (!text.parse(context)) return failed;
  std::optional<Imported> out = made(text, context);
  if (!out) {
    if (log.errors() == errors) log.report(Code("E6220"), text.at(text.top()), empty);
    context.tell();
    return failed;
  }
  return *std::move(out);
}

}  // namespace panwright::importers
