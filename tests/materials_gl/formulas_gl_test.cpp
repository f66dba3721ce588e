// The formulas as GLSL runs them against f32 in C++, over the hard cases.
#include <glad/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <memory>

#include <fmt/core.h>

#include "materials/brdf.h"
#include "materials/formula_text.h"
#include "preview/context.h"
#include "tests/support/hard_cases.h"
#include "tests/support/surface_text.h"

namespace panwright::hard_cases::formulas_gl_test {
namespace {

using materials::DiffuseModel;
using materials::Material;
using materials::SpecularModel;

// Runs `expression` over the cases in a compute shader. text: what it calls.
class Shader {
 public:
  Shader(const GladGLContext& gl, const std::string& text, const std::string& statements,
         const std::string& expression, const std::string& helpers = "")
      : gl_(gl) {
    const std::string source = "#version 450 core\n" + text + R"(
#define Real float
#define Vec3 vec3
)" + helpers + R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Inputs { float inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { float outputs[]; };
layout(location = 0) uniform uint count;
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  uint k = 16 * i;
  vec3 l = vec3(inputs[k], inputs[k + 1], inputs[k + 2]);
  vec3 v = vec3(inputs[k + 3], inputs[k + 4], inputs[k + 5]);
  vec3 n = vec3(inputs[k + 6], inputs[k + 7], inputs[k + 8]);
  float p[7];
  for (uint j = 0; j < 7; ++j) p[j] = inputs[k + 9 + j];
)" + statements +
                               "  precise vec3 result = " + expression + R"(;
  for (uint j = 0; j < 3; ++j) outputs[3 * i + j] = result[j];
}
)";
    program_ = gl.CreateProgram();
    const GLuint shader = gl.CreateShader(GL_COMPUTE_SHADER);
    const char* pointer = source.c_str();
    gl.ShaderSource(shader, 1, &pointer, nullptr);
    gl.CompileShader(shader);
    gl.AttachShader(program_, shader);
    gl.LinkProgram(program_);
    GLint linked = 0;
    gl.GetProgramiv(program_, GL_LINK_STATUS, &linked);
    char message[4000] = "";
    if (!linked) gl.GetShaderInfoLog(shader, sizeof message, nullptr, message);
    gl.DeleteShader(shader);
    linked_ = linked != 0;
    EXPECT_TRUE(linked_) << message << source;
  }
  ~Shader() { gl_.DeleteProgram(program_); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;

  std::vector<glm::vec3> run(const std::vector<Inputs>& cases) const {
    std::vector<glm::vec3> results(cases.size());
    if (!linked_) return results;
    GLuint buffers[2];
    gl_.CreateBuffers(2, buffers);
    const auto bytes = [](const auto& list) {
      return static_cast<GLsizeiptr>(list.size() * sizeof list[0]);
    };
    gl_.NamedBufferStorage(buffers[0], bytes(cases), cases.data(), 0);
    gl_.NamedBufferStorage(buffers[1], bytes(results), nullptr, GL_DYNAMIC_STORAGE_BIT);
    gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers[0]);
    gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers[1]);
    gl_.UseProgram(program_);
    gl_.Uniform1ui(0, static_cast<GLuint>(cases.size()));
    gl_.DispatchCompute(static_cast<GLuint>((cases.size() + 63) / 64), 1, 1);
    gl_.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl_.GetNamedBufferSubData(buffers[1], 0, bytes(results), results.data());
    EXPECT_EQ(gl_.GetError(), static_cast<GLenum>(GL_NO_ERROR));
    gl_.DeleteBuffers(2, buffers);
    return results;
  }

 private:
  const GladGLContext& gl_;
  GLuint program_ = 0;
  bool linked_ = false;
};

// Steps between two floats >= 0; those below the smallest normal number are one with 0, as a GPU
// may flush them.
std::uint32_t ulps(float a, float b) {
  if (!(a >= 0) || !(b >= 0) || !std::isfinite(a) || !std::isfinite(b)) return 0xffffffffu;
  const auto rank = [](float x) {
    return x < 0x1p-126f ? 0x007fffffu : std::bit_cast<std::uint32_t>(x);
  };
  const std::uint32_t x = rank(a), y = rank(b);
  return x < y ? y - x : x - y;
}

struct Difference {
  double worst = 0;  // ulp, times how well the half vector is known
  std::size_t at = 0;
  std::size_t different = 0;  // values whose bits differ
};

template <class Cpu>
Difference compare(const std::vector<Inputs>& cases, const std::vector<glm::vec3>& results,
                   Cpu cpu) {
  Difference difference;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const glm::vec3 want = cpu(cases[i]);
    // seen against the light it is a difference of two rounded vectors, a few ulp long
    const double known =
        std::clamp(static_cast<double>(glm::length(cases[i].l + cases[i].v)), 1e-9, 1.0);
    for (int k = 0; k < 3; ++k) {
      const double apart = known * ulps(results[i][k], want[k]);
      if (apart > 0) ++difference.different;
      if (apart > difference.worst) {
        difference.worst = apart;
        difference.at = i;
      }
    }
  }
  return difference;
}

class FormulasGl : public testing::TestWithParam<preview::ContextKind> {
 protected:
  void SetUp() override {
    DiagnosticLog log;
    auto made = preview::Context::create(GetParam(), log);
    ASSERT_TRUE(made) << to_text(log);
    context_ = std::move(*made);
    std::printf("%s\n", context_->renderer().c_str());
  }

  // Software rounds every operation as IEEE 754 says: the same bits. Hardware may be 2.5 ulp off in
  // a division (GLSL 4.60, 4.7.1) and as much in a root; the exponent of a lobe, at most 80, has
  // two divisions and a root or less, which makes 80·6 ulp of the lobe's tail. An H100: 194 and
  // 66.
  std::uint32_t bound(const std::string& name) const {
    if (!context_->is_hardware()) return 0;
    const bool lobe = name.find("blinn") != std::string::npos ||
                      name.find("cook") != std::string::npos ||
                      name.find("beckmann") != std::string::npos;
    const bool coated = name.find("coated") == 0;
    const auto retroreflector = static_cast<int>(SpecularModel::retroreflector);
    // its angle is that between refracted directions, 3e-4 rad at worst: 1.44e4 of an H100
    if (coated && name.find(fmt::format(" {} ", retroreflector)) != std::string::npos) return 30000;
    return lobe || coated ? 96 + 480 : 96;
  }

  void check(const std::string& name, const std::vector<Inputs>& cases, const Difference& found) {
    const Inputs& c = cases[found.at];
    std::printf("%-24s %6zu cases, %zu values differ, worst %.3g ulp", name.c_str(), cases.size(),
                found.different, found.worst);
    if (found.worst != 0)
      std::printf(
          " at l=(%.9g %.9g %.9g) v=(%.9g %.9g %.9g) p=%g %g %g", static_cast<double>(c.l.x),
          static_cast<double>(c.l.y), static_cast<double>(c.l.z), static_cast<double>(c.v.x),
          static_cast<double>(c.v.y), static_cast<double>(c.v.z), static_cast<double>(c.p[0]),
          static_cast<double>(c.p[1]), static_cast<double>(c.p[2]));
    std::printf("\n");
    EXPECT_LE(found.worst, bound(name)) << name;
  }

  std::unique_ptr<preview::Context> context_;
};

TEST_P(FormulasGl, EveryFormulaOverTheHardCases) {
  std::vector<Formula> all = formulas();
  for (const double slope : {1e-4, 1e-3, 1e-2, 0.15}) {
    all.push_back(beckmann_near_specular(slope, 20000));
    all.back().name += " m = " + std::to_string(slope);
  }
  const std::string text = materials::glsl_all_brdfs();
  for (const Formula& formula : all) {
    const Shader shader(context_->gl(), text, "", formula.expression, kHelpers);
    check(formula.name, formula.cases,
          compare(formula.cases, shader.run(formula.cases), formula.f32));
  }
}

// One last bit is enough to be seen, as is a built-in function in the place of ours.
TEST_P(FormulasGl, TheComparisonSeesTheLastBit) {
  const std::vector<Inputs> cases = numbers(1);
  const auto same = [](const Inputs& c) { return glm::vec3(c.p[0], 0, 0); };
  const Shader plain(context_->gl(), "", "", "vec3(p[0], 0.0, 0.0)");
  EXPECT_EQ(compare(cases, plain.run(cases), same).different, 0u);
  const Shader next(context_->gl(), "", "",
                    "vec3(uintBitsToFloat(floatBitsToUint(p[0]) + 1u), 0.0, 0.0)");
  const Difference one = compare(cases, next.run(cases), same);
  EXPECT_EQ(one.worst, 1u);
  EXPECT_EQ(one.different, cases.size() - 1);  // beside 0 is no normal number
  const Shader exponential(context_->gl(), "", "", "vec3(exp(-p[0]))");
  EXPECT_GT(compare(cases, exponential.run(cases),
                    [](const Inputs& c) { return glm::vec3(materials::f32::exp_negative(c.p[0])); })
                .different,
            0u);
}

// The assembled texts, with the parameters of a material written into the shader.
TEST_P(FormulasGl, EveryFamily) {
  Material m;
  m.diffuse = {0.75, 0.25, 0.0625};
  m.specular = {1, 0.5, 0.25};
  m.emissive = {0.5, 0.25, 0};
  m.weights = {0.625, 0.25, 0.125};
  std::vector<Inputs> cases = grid();
  for (const auto& more : {tilted_grid(), random_pairs(-0.2, 5000), near_specular(0.25, 5000)})
    cases.insert(cases.end(), more.begin(), more.end());
  const Vec3 irradiance(1.5, 1, 0.5);
  // numbers that a float holds, one per parameter of a model; scales and counts apart
  const auto dyadic = [](const materials::Parameter& parameter, std::span<double> values) {
    static constexpr std::pair<std::string_view, double> kNumbers[] = {
        {"shine", 24},      {"g_scale", 0.5}, {"alpha", 0.25},     {"alpha_x", 0.25},
        {"alpha_y", 0.375}, {"sigma", 0.375}, {"roughness", 0.25}, {"w", 0.375},
        {"h", 0.0625},      {"b0", 1},        {"b", 0.25},         {"c", 0.5},
        {"h_c", 0.125},     {"b_c0", 0.5},    {"porosity", 0.25}};
    for (const auto& [name, number] : kNumbers)
      if (parameter.name == name) values[0] = number;
  };
  const auto compare_brdfs = [&](const char* name) {
    materials::fit(m);
    const glm::vec3 reflectance(0.75f, 0.03125f, 0.5f);  // asked under a map only
    auto surface = materials::f32::surface_of(m, glm::vec3(1, 0, 0));
    surface.reflectance = reflectance;
    const std::string statements = surface_text(surface);
    const materials::ShadingContext local{Vec3(1, 0, 0), Vec3(reflectance)};
    const Shader shader(
        context_->gl(), materials::glsl_formulas(materials::brdf_model_of(m)), statements,
        "surface_radiance(s, Incidence(l, vec3(1.5, 1.0, 0.5), 2.7e-6, 0.0), v, n) + "
        "surface_emission(s, vec3(0.75, 2.0, 1.0))");
    check(
        fmt::format("{} {} {} {}", name, static_cast<int>(m.diffuse_model()),
                    static_cast<int>(m.specular_model()), static_cast<int>(m.refract.has_value())),
        cases, compare(cases, shader.run(cases), [&](const Inputs& c) {
          return materials::f32::radiance(m, {Vec3(c.l), irradiance, 2.7e-6}, c.v, c.n,
                                          glm::vec3(1), local) +
                 materials::f32::emission(m, glm::vec3(0.75f, 2, 1));
        }));
  };
  for (std::uint32_t d = 0; d < std::variant_size_v<materials::DiffuseBrdf>; ++d) {
    m.diffuse_brdf = materials::default_brdf(static_cast<DiffuseModel>(d));
    edit_parameters(m.diffuse_brdf, dyadic);
    compare_brdfs("diffuse");
  }
  for (std::uint32_t s = 0; s < std::variant_size_v<materials::SpecularBrdf>; ++s) {
    m.specular_brdf = materials::default_brdf(static_cast<SpecularModel>(s));
    edit_parameters(m.specular_brdf, dyadic);
    m.refract = {};
    compare_brdfs("specular");
    m.refract = Vec3(1.5, 2.5, 1);
    compare_brdfs("dielectric");
    m.extinction = {7, 3, 0.5};
    compare_brdfs("conductor");
    m.coat = materials::Coat{1.5, 0.0625, Vec3(0.125, 0.25, 0.5)};
    compare_brdfs("coated");
    m.maps.reflectance = 0;
    compare_brdfs("coated, mapped");
    m.coat = {};
    compare_brdfs("conductor, mapped");
    m.extinction = Vec3(0);
    compare_brdfs("dielectric, mapped");
    m.refract = {};
    compare_brdfs("specular, mapped");
    m.maps.reflectance = -1;
  }
}

INSTANTIATE_TEST_SUITE_P(Contexts, FormulasGl,
                         testing::Values(preview::ContextKind::osmesa,
                                         preview::ContextKind::automatic),
                         [](const auto& parameter) {
                           return parameter.param == preview::ContextKind::osmesa ? "osmesa"
                                                                                  : "automatic";
                         });

}  // namespace
}  // namespace panwright::hard_cases::formulas_gl_test
