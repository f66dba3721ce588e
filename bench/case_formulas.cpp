// Reflectance formulas: time of one evaluation in float and double, and the error of float.
#include <fmt/core.h>

#include <array>

#include "bench/bench.h"

#include "materials/brdf.h"
#include "materials/sample.h"
#include "tests/support/hard_cases.h"

namespace panwright::bench::case_formulas {

namespace {

using hard_cases::Formula;
using hard_cases::Inputs;
using materials::DiffuseModel;
using materials::Material;
using materials::SpecularModel;

// keeps results alive without costing more than an addition
volatile double g_sink = 0;

template <class Evaluate>
void evaluate_all(const std::vector<Inputs>& cases, Evaluate evaluate) {
  double sum = 0;
  for (const Inputs& one : cases) sum += static_cast<double>(evaluate(one).x);
  g_sink = sum;
}

void add_rows(Context& context, const std::string& name, const std::vector<Inputs>& cases,
              const hard_cases::Worst& worst, double bound, const std::function<void()>& single,
              const std::function<void()>& twice) {
  const auto timings = interleaved({{"f32", single}, {"f64", twice}}, context.runs());
  const double factor = 1e9 / static_cast<double>(cases.size());
  Row row{.case_name = "formulas",
          .setting = name + " f32",
          .speed_unit = "ns/evaluation",
          .error = worst.error,
          .error_unit = "relative",
          .reference = "the same text in double",
          .reference_error = 1e-14,
          .must_is_least = false,
          .must_error = bound};
  set_time(row, timings[0], factor);
  context.add(row);
  row.setting = name + " f64";
  row.error = 0;
  row.must_error = 0;
  row.reference = "itself; closed forms and tables in tests/materials";
  set_time(row, timings[1], factor);
  context.add(row);
}

// Single formulas: error over the hard cases, time where lobes and angles are ordinary.
void run_formulas(Context& context) {
  const std::size_t count = context.quick() ? 2000 : 100000;
  std::vector<Formula> all = hard_cases::formulas();
  for (const double slope : {1e-4, 1e-3, 1e-2, 0.15}) {
    all.push_back(hard_cases::beckmann_near_specular(slope, context.quick() ? 2000 : 200000));
    all.back().name += fmt::format(" m={}", slope);
  }
  for (const Formula& formula : all) {
    const auto worst = hard_cases::worst_error(formula);
    if (worst.bad != 0) context.note(formula.name + " has values that are no numbers");
    std::vector<Inputs> cases =
        formula.of_directions ? hard_cases::random_pairs(0.05, count) : formula.cases;
    for (std::size_t i = 0; i < cases.size(); ++i)
      cases[i].p = formula.cases[i % formula.cases.size()].p;
    const bool distribution = formula.name.starts_with("beckmann");
    const double slope = static_cast<double>(formula.cases.front().p[0]);
    const double bound = !distribution ? 0 : slope < 0.1 ? 1.5e-3 * (1e-3 / slope) : 2e-5;
    if (distribution) cases = formula.cases;
    add_rows(
        context, formula.name, cases, worst, bound, [&] { evaluate_all(cases, formula.f32); },
        [&] { evaluate_all(cases, formula.f64); });
  }
}

Material material(DiffuseModel diffuse, SpecularModel specular) {
  Material m;
  if (diffuse == DiffuseModel::oren_nayar) m.diffuse_brdf = materials::OrenNayar{0.3};
  if (diffuse == DiffuseModel::hapke)
    m.diffuse_brdf = materials::Hapke{.w = 0.21, .h = 0.07, .b0 = 1, .roughness = 20 * kDegree};
  if (specular == SpecularModel::blinn_phong) m.specular_brdf = materials::BlinnPhong{24};
  if (specular == SpecularModel::cook_torrance)
    m.specular_brdf = materials::CookTorrance{.alpha = 0.15};
  m.diffuse = {0.7038, 0.27048, 0.0828};
  m.specular = Vec3(1);
  m.weights = {0.9, 0.1, 0};
  m.refract = Vec3(1.5);
  return m;
}

// Whole materials, as the CPU renderer calls them.
void run_pairs(Context& context) {
  const std::vector<Inputs> cases = hard_cases::random_pairs(0.01, context.quick() ? 2000 : 100000);
  const char* const diffuse_names[] = {"lambert", "oren_nayar", "hapke"};
  const char* const specular_names[] = {"none", "blinn_phong", "cook_torrance"};
  for (std::uint32_t d = 0; d < 3; ++d)
    for (std::uint32_t s = 0; s < 3; ++s) {
      const Material m = material(static_cast<DiffuseModel>(d), static_cast<SpecularModel>(s));
      const auto single = [&](const Inputs& i) {
        return materials::f32::radiance(m, Vec3(i.l), i.v, i.n);
      };
      const auto twice = [&](const Inputs& i) {
        return materials::f64::radiance(m, glm::dvec3(i.l), glm::dvec3(i.v), glm::dvec3(i.n));
      };
      hard_cases::Worst worst;
      for (const Inputs& i : cases) {
        const glm::vec3 got = single(i);
        const glm::dvec3 want = twice(i);
        for (int k = 0; k < 3; ++k)
          worst.error =
              std::max(worst.error, std::fabs(static_cast<double>(got[k]) - want[k]) / want[k]);
      }
      add_rows(
          context, fmt::format("{}+{}", diffuse_names[d], specular_names[s]), cases, worst, 0,
          [&] { evaluate_all(cases, single); }, [&] { evaluate_all(cases, twice); });
    }
}

// Hapke's BRDF as the CPU renderer has it, one direction after the other and many together.
void run_many(Context& context) {
  const std::vector<Inputs> cases = hard_cases::random_pairs(0.01, context.quick() ? 2000 : 100000);
  Material m = material(DiffuseModel::hapke, SpecularModel::blinn_phong);
  m.weights = {1, 0, 0};
  m.specular_brdf = {};
  materials::fit(m);
  const materials::Scattering scattering(m);
  std::vector<materials::Scattering::Directions> at;
  for (const Inputs& i : cases)
    at.push_back({Vec3(i.l), glm::normalize(Vec3(i.v)), Vec3(i.n), Vec3(1)});
  std::vector<Vec3> alone(at.size()), together(at.size());
  const auto one_by_one = [&] {
    for (std::size_t i = 0; i < at.size(); ++i)
      alone[i] =
          scattering.brdf(at[i].to_light, at[i].to_viewer, at[i].normal, Vec3(0), at[i].tint);
  };
  const auto timings =
      interleaved({{"alone", one_by_one}, {"together", [&] { scattering.brdf(at, together); }}},
                  context.runs());
  Row row{.case_name = "formulas",
          .setting = "hapke, H exact, one by one",
          .speed_unit = "ns/evaluation",
          .error_unit = "evaluations of other bits",
          .reference = "one by one",
          .must_is_least = false,
          .must_error = 0};
  const double factor = 1e9 / static_cast<double>(at.size());
  set_time(row, timings[0], factor);
  context.add(row);
  row.setting = "hapke, H exact, many together";
  for (std::size_t i = 0; i < at.size(); ++i) row.error += alone[i] != together[i];
  set_time(row, timings[1], factor);
  context.add(row);
}

void run(Context& context) {
  run_formulas(context);
  run_pairs(context);
  run_many(context);
}

const bool kAdded = add_case({"formulas", "reflectance formulas, float against double", run});

}  // namespace

}  // namespace panwright::bench::case_formulas
