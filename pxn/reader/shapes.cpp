#include "pxn/reader/shapes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "pxn/expression/formula.h"
#include "pxn/reader/loader.h"

namespace panwright::pxn {

namespace {

using schemas::ElementId;

// what a frame's axes may be off by
constexpr double kFrameTolerance = 1e-4;
// what rounding to 17 digits does to them is no reason for a note
constexpr double kFrameRounding = 1e-12;

std::optional<Vec3> read_vector(const xml::Document& document, std::uint32_t element,
                                ElementId holder, ElementId id, Values& values) {
  const std::uint32_t outer = child_of(document, element, holder);
  const std::uint32_t inner = outer == 0 ? 0 : child_of(document, outer, id);
  Vec3 v(0);
  if (inner == 0 || !values.numbers(inner, std::span(&v.x, 3))) return std::nullopt;
  return v;
}

// The rotation nearest to a matrix that is almost one: Newton's iteration for the polar
// decomposition (Higham, "Computing the polar decomposition—with applications", 1986).
Mat3 nearest_rotation(Mat3 m) {
  // converges quadratically from 1e-4: three steps reach rounding, the others change nothing
  for (int step = 0; step < 6; ++step) m = 0.5 * (m + cofactor(m) / glm::determinant(m));
  return m;
}

// How far the columns are from unit length and right angles.
double deviation(const Mat3& m) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      worst = std::max(worst, std::abs(glm::dot(m[i], m[j]) - (i == j ? 1 : 0)));
  return worst;
}

}  // namespace

bool check_name(const xml::Document& document, std::uint32_t element, SourceSpan where,
                const std::string& name, Reporter& reporter) {
  if (is_name(name)) {
    if (!is_built_in(name)) return true;
    reporter.report(Code("E1210"), where, document, element, [&]() -> Reporter::Text {
      const bool constant = name == "pi" || name == "tau";
      return {fmt::format("{} is a {} of the language", in_quotes(name),
                          constant ? "constant" : "function"),
              "give it another name"};
    });
    return true;
  }
  reporter.report(Code("E1221"), where, document, element, [&] {
    return Reporter::Text(
        fmt::format("{} is not allowed in expressions; names are letters, digits and underscores, "
                    "not beginning "
                    "with a digit",
                    in_quotes(name)));
  });
  return false;
}

std::optional<PartFrame> read_frame_axes(const xml::Document& document, std::uint32_t element,
                                         Values& values, Reporter& reporter) {
  const auto origin = read_vector(document, element, ElementId::origin, ElementId::point, values);
  const auto axis = [&](ElementId holder) {
    return read_vector(document, element, holder, ElementId::direction, values);
  };
  const auto forward = axis(ElementId::forward);
  const auto up = axis(ElementId::up);
  const auto right = axis(ElementId::right);
  if (!origin || !forward || !up || !right) return std::nullopt;

  // camera axes: x right, y down, z forward
  const Mat3 written(*right, -*up, *forward);
  const double off = deviation(written);
  // note: dot products of unit vectors that are off by t are off by 2t
  std::string problem;
  const char* const names[] = {"right", "up", "forward"};
  for (int i = 0; i < 3 && problem.empty(); ++i) {
    const double length = glm::length(written[i]);
    if (!(std::abs(length - 1) <= kFrameTolerance))
      problem = fmt::format("{} has length {:.6g}, not 1", names[i], length);
    for (int j = 0; j < i && problem.empty(); ++j) {
      const double cosine = glm::dot(written[i], written[j]) / (length * glm::length(written[j]));
      if (!(std::abs(cosine) <= kFrameTolerance))
        problem = fmt::format(
            "{} and {} are not at right angles: {:.6g} degrees", names[j], names[i],
            angle_between(*(i == 1 ? &*up : &*forward), *(j == 0 ? &*right : &*up)) / kDegree);
    }
  }
  if (problem.empty() && glm::determinant(written) < 0)
    problem = "right is the opposite of forward × up";
  if (!problem.empty()) {
    reporter.report(Code("E1207"), document.tag_span(element), document, element, [&] {
      return Reporter::Text(fmt::format(
          "{}; expected perpendicular unit vectors to 1e-4, with right = forward × up", problem));
    });
    return std::nullopt;
  }
  if (off > kFrameRounding) {
    reporter.report(Code("N1208"), document.tag_span(element), document, element, [&] {
      return Reporter::Text(fmt::format(
          "the frame's axes are off by {:.2g}; the nearest exact rotation is used", off));
    });
  }
  return PartFrame{{}, *origin, glm::normalize(glm::quat_cast(nearest_rotation(written)))};
}

}  // namespace panwright::pxn
