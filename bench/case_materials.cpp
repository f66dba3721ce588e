// BRDFs of reflection: time of one evaluation on the CPU and of one pixel in OpenGL, beside the
// error of directional albedos against tables and closed forms; and stable forms against naive
// ones.
#include <fmt/core.h>
#include <glad/gl.h>

#include <array>
#include <cmath>
#include <memory>

#include "bench/bench.h"
#include "materials/brdf.h"
#include "materials/energy.h"
#include "materials/formula_text.h"
#include "materials/hapke_h.h"
#include "materials/sample.h"
#include "preview/context.h"
#include "tests/support/hard_cases.h"
#include "tests/support/surface_text.h"

namespace panwright::bench::case_materials {

namespace {

using hard_cases::Inputs;
using materials::DiffuseModel;
using materials::Material;
using materials::SpecularModel;

constexpr int kSide = 1024;  // pixels
const Vec3 kNormal(0, 0, 1);
const Vec3 kTangent(1, 0, 0);

volatile double g_sink = 0;

struct Albedo {
  double mu;
  double value;
};

// A BRDF, and albedos that others computed.
struct BrdfCase {
  std::string name;
  Material material;
  std::vector<Albedo> albedos;
  std::string reference;
  double reference_error;
};

Material facets(SpecularModel brdf, double alpha) {
  Material m;
  m.weights = {0, 1, 0};
  m.specular = Vec3(1);
  m.specular_brdf = materials::with_slopes(brdf, Vec2(alpha));
  m.compensation = materials::Compensation::off;
  return m;
}

Material diffuse(DiffuseModel brdf, double albedo) {
  Material m;
  m.diffuse_brdf = materials::default_brdf(brdf);
  m.diffuse = Vec3(albedo);
  return m;
}

std::vector<BrdfCase> brdf_cases() {
  constexpr std::array kMu{0.1, 0.25, 0.5, 0.75, 1.0};
  const auto table = [&](const std::array<double, 5>& values) {
    std::vector<Albedo> all;
    for (std::size_t i = 0; i < values.size(); ++i) all.push_back({kMu[i], values[i]});
    return all;
  };
  const std::string quadrature = "table by 200x200 quadrature";
  std::vector<BrdfCase> all;
  all.push_back({"lambert", diffuse(DiffuseModel::lambert, 0.8), table({.8, .8, .8, .8, .8}),
                 "closed form", 1e-16});
  // E_FON r = 0.5, its loss scattered again: 1 at albedo 1
  BrdfCase eon{"eon", diffuse(DiffuseModel::eon, 1), table({1, 1, 1, 1, 1}), "closed form", 1e-16};
  eon.material.diffuse_brdf = materials::Eon{0.5};
  all.push_back(eon);
  BrdfCase hapke{"hapke", diffuse(DiffuseModel::hapke, 1), {}, "1 - gamma H, H exact", 1e-13};
  hapke.material.diffuse_brdf = materials::Hapke{.w = 0.9};
  for (const double mu : kMu)
    hapke.albedos.push_back({mu, 1 - std::sqrt(0.1) * materials::hapke_h(mu, 0.9)});
  all.push_back(hapke);
  // f = w/(4 pi (mu0 + mu)): w/2 (1 - mu ln((1 + mu)/mu))
  BrdfCase lommel{
      "lommel_seeliger", diffuse(DiffuseModel::lommel_seeliger, 1), {}, "closed form", 1e-16};
  lommel.material.diffuse_brdf = materials::LommelSeeliger{0.6};
  for (const double mu : kMu)
    lommel.albedos.push_back({mu, 0.3 * (1 - mu * std::log((1 + mu) / mu))});
  all.push_back(lommel);
  all.push_back({"cook_torrance .3", facets(SpecularModel::cook_torrance, 0.3),
                 table({.96612, .92873, .92477, .96381, .99558}), quadrature, 2e-5});
  all.push_back({"beckmann .5", facets(SpecularModel::beckmann, 0.5),
                 table({.95503, .90742, .86936, .88012, .94299}), quadrature, 2e-5});
  all.push_back({"ggx .5", facets(SpecularModel::ggx, 0.5),
                 table({.86010, .76520, .69825, .68208, .68789}), quadrature, 2e-5});
  BrdfCase compensated{"ggx .5 compensated", facets(SpecularModel::ggx, 0.5),
                       table({1, 1, 1, 1, 1}), "white furnace", 1e-16};
  compensated.material.compensation = materials::Compensation::on;
  all.push_back(compensated);
  BrdfCase brushed{
      "ggx .5 .1 brushed", facets(SpecularModel::ggx, 0.5), {}, "quadrature of f64", 2e-5};
  brushed.material.specular_brdf = materials::Ggx{0.5, 0.1};
  for (const double mu : kMu)
    brushed.albedos.push_back(
        {mu, materials::microfacet_albedo({SpecularModel::ggx, 0.5, 0.1},
                                          hard_cases::direction(mu, 0), 128)});
  all.push_back(brushed);
  BrdfCase coated{"lambert coated",
                  diffuse(DiffuseModel::lambert, 1),
                  {},
                  "white furnace less the coat's mirror",
                  1e-15};
  coated.material.coat = materials::Coat{};
  for (const double mu : kMu)
    coated.albedos.push_back({mu, 1 - materials::f64::fresnel_dielectric(mu, 1.5)});
  all.push_back(coated);
  for (BrdfCase& brdf : all) materials::fit(brdf.material);
  return all;
}

struct Errors {
  double worst = 0;
  double rms = 0;
};

// Albedos without mirrors: of floats by a sum over the hemisphere, whose own error, up to 4e-4
// where lobes end at the horizon, is part of the figure.
Errors errors_of(const BrdfCase& brdf, bool single, int rows) {
  Errors errors;
  const int columns = 2 * rows;
  const materials::Scattering exact(brdf.material);
  for (const auto& [mu, want] : brdf.albedos) {
    const Vec3 v = hard_cases::direction(mu, 0);
    double sum = 0;
    for (int i = 0; single && i < rows; ++i)
      for (int k = 0; k < columns; ++k) {
        const double sin2 = (i + 0.5) / rows;
        const double phi = kPi * (k + 0.5) / columns;
        const glm::vec3 l(std::sqrt(sin2) * std::cos(phi), std::sqrt(sin2) * std::sin(phi),
                          std::sqrt(1 - sin2));
        sum +=
            static_cast<double>(materials::f32::brdf(brdf.material, Vec3(l), glm::vec3(v),
                                                     glm::vec3(kNormal), glm::vec3(1), {kTangent})
                                    .x);
      }
    const double got = single ? sum * kPi / (static_cast<double>(rows) * columns)
                              : materials::directional_albedo(brdf.material, mu).x -
                                    exact.mirror_reflectance(mu).x;
    const double error = std::fabs(got - want);
    errors.worst = std::max(errors.worst, error);
    errors.rms += error * error / static_cast<double>(brdf.albedos.size());
  }
  errors.rms = std::sqrt(errors.rms);
  return errors;
}

// ---- OpenGL

// Draws every pixel of a float target with an expression of l, v, n.
class Screen {
 public:
  Screen(const GladGLContext& gl, const std::string& text, const std::string& statements,
         const std::string& expression)
      : gl_(gl) {
    const std::string vertex =
        "#version 450 core\nvoid main() { gl_Position = vec4(4.0 * (gl_VertexID & 1) - 1.0, "
        "4.0 * (gl_VertexID >> 1) - 1.0, 0.0, 1.0); }\n";
    const std::string fragment = "#version 450 core\n" + text + R"(
layout(location = 0) out vec4 color;
void main() {
  vec2 at = gl_FragCoord.xy / 1024.0;
  vec3 n = vec3(0.0, 0.0, 1.0);
  vec3 l = normalize(vec3(at - 0.5, 0.6));
  vec3 v = normalize(vec3(0.4 - at.y, at.x - 0.3, 0.5));
)" + statements + "  color = vec4(" +
                                 expression + ", 1.0);\n}\n";
    program_ = gl.CreateProgram();
    for (const auto& [kind, source] :
         {std::pair<GLenum, const std::string&>{GL_VERTEX_SHADER, vertex},
          std::pair<GLenum, const std::string&>{GL_FRAGMENT_SHADER, fragment}}) {
      const GLuint shader = gl.CreateShader(kind);
      const char* pointer = source.c_str();
      gl.ShaderSource(shader, 1, &pointer, nullptr);
      gl.CompileShader(shader);
      gl.AttachShader(program_, shader);
      gl.DeleteShader(shader);
    }
    gl.LinkProgram(program_);
    GLint linked = 0;
    gl.GetProgramiv(program_, GL_LINK_STATUS, &linked);
    good_ = linked != 0;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture_);
    gl.TextureStorage2D(texture_, 1, GL_RGBA32F, kSide, kSide);
    gl.CreateFramebuffers(1, &framebuffer_);
    gl.NamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
    gl.CreateVertexArrays(1, &array_);
  }
  ~Screen() {
    gl_.DeleteProgram(program_);
    gl_.DeleteTextures(1, &texture_);
    gl_.DeleteFramebuffers(1, &framebuffer_);
    gl_.DeleteVertexArrays(1, &array_);
  }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  bool good() const { return good_; }
  void draw() const {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    gl_.Viewport(0, 0, kSide, kSide);
    gl_.Disable(GL_DEPTH_TEST);
    gl_.UseProgram(program_);
    gl_.BindVertexArray(array_);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
    gl_.Finish();
  }

 private:
  const GladGLContext& gl_;
  GLuint program_ = 0, texture_ = 0, framebuffer_ = 0, array_ = 0;
  bool good_ = false;
};

void run_brdf(Context& context, const GladGLContext& gl, const BrdfCase& brdf) {
  const std::vector<Inputs> cases = hard_cases::random_pairs(0.01, context.quick() ? 2000 : 100000);
  const auto run_all = [&](auto evaluate) {
    double sum = 0;
    for (const Inputs& one : cases) sum += static_cast<double>(evaluate(one).x);
    g_sink = sum;
  };
  const Material& m = brdf.material;
  const Screen screen(gl, materials::glsl_formulas(materials::brdf_model_of(m)),
                      hard_cases::surface_text(materials::f32::surface_of(m, glm::vec3(kTangent))),
                      "surface_radiance(s, Incidence(l, vec3(1.0), 0.0, 0.0), v, n)");
  if (!screen.good()) return context.note(brdf.name + " was refused by the context");
  const auto timings = interleaved(
      {{"gl", [&] { screen.draw(); }},
       {"f32",
        [&] {
          run_all([&](const Inputs& i) {
            return materials::f32::radiance(m, Vec3(i.l), i.v, i.n, glm::vec3(1), {kTangent});
          });
        }},
       {"f64",
        [&] {
          run_all([&](const Inputs& i) {
            return materials::f64::radiance(m, Vec3(i.l), Vec3(i.v), Vec3(i.n), Vec3(1),
                                            {kTangent});
          });
        }}},
      context.runs());
  const int rows = context.quick() ? 128 : 512;
  const Errors single = errors_of(brdf, true, rows);
  const Errors twice = errors_of(brdf, false, rows);
  const auto add = [&](const std::string& how, const char* unit, const Timing& timing,
                       double factor, const Errors& errors, double bound) {
    Row row{.case_name = "materials",
            .setting = brdf.name + how,
            .speed_unit = unit,
            .error = errors.worst,
            .error_unit = "albedo, max",
            .reference = brdf.reference,
            .reference_error = brdf.reference_error,
            .must_is_least = false,
            .must_error = context.quick() ? 0 : bound};
    set_time(row, timing, factor);
    context.add(row);
    row.error = errors.rms;
    row.error_unit = "albedo, rms";
    row.must_error = 0;
    context.add(row);
  };
  const double per_case = 1e9 / static_cast<double>(cases.size());
  // the same bits as f32 (tests/materials_gl)
  add(" GL", "ns/pixel", timings[0], 1e9 / (kSide * kSide), single, 1e-3);
  add(" f32", "ns/evaluation", timings[1], per_case, single, 1e-3);
  add(" f64", "ns/evaluation", timings[2], per_case, twice, 2e-4);
}

// ---- stable forms against those of print, in OpenGL

constexpr const char* kNaive = R"(
vec3 half_of(vec3 l, vec3 v) { return normalize(l + v); }
float naive_cook(float m, vec3 l, vec3 v, vec3 n) {
  vec3 h = half_of(l, v);
  float nl = dot(n, l), nv = dot(n, v), nh = dot(n, h), vh = dot(v, h), c2 = nh * nh;
  float d = exp_negative((1.0 - c2) / (c2 * m * m)) / (3.14159265 * m * m * c2 * c2);
  float g = min(1.0, min(2.0 * nh * nv / vh, 2.0 * nh * nl / vh));
  return nl > 0.0 && nv > 0.0 ? d * g / (4.0 * nl * nv) : 0.0;
}
float naive_cook_exp(float m, vec3 l, vec3 v, vec3 n) {
  vec3 h = half_of(l, v);
  float nl = dot(n, l), nv = dot(n, v), nh = dot(n, h), vh = dot(v, h), c2 = nh * nh;
  float d = exp((c2 - 1.0) / (c2 * m * m)) / (3.14159265 * m * m * c2 * c2);
  float g = min(1.0, min(2.0 * nh * nv / vh, 2.0 * nh * nl / vh));
  return nl > 0.0 && nv > 0.0 ? d * g / (4.0 * nl * nv) : 0.0;
}
float naive_ggx(float a, vec3 l, vec3 v, vec3 n) {
  vec3 h = half_of(l, v);
  float nl = dot(n, l), nv = dot(n, v), nh = dot(n, h), a2 = a * a;
  float q = nh * nh * (a2 - 1.0) + 1.0;
  float s = nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2);
  return nl > 0.0 && nv > 0.0 ? 0.5 * a2 / (3.14159265 * q * q * s) : 0.0;
}
)";

void run_forms(Context& context, const GladGLContext& gl) {
  const double beckmann =
      hard_cases::worst_error(hard_cases::beckmann_near_specular(1e-3, 20000)).error;
  const double ggx =
      hard_cases::worst_error(hard_cases::facets_near_specular(1e-3, 20000)[1]).error;
  const struct {
    const char* name;
    const char* stable;
    const char* naive;
    double error;
    double must;
  } forms[] = {{"cook_torrance stable over naive", "cook_torrance(0.15, l, v, n)",
                "naive_cook(0.15, l, v, n)", beckmann, 1.05},
               {"cook_torrance stable over naive with the driver's exp",
                "cook_torrance(0.15, l, v, n)", "naive_cook_exp(0.15, l, v, n)", beckmann, 0},
               {"ggx stable over naive", "ggx_smith(0.15, 0.15, vec3(0.0), l, v, n)",
                "naive_ggx(0.15, l, v, n)", ggx, 1.05}};
  const std::string text = materials::glsl_all_brdfs() + kNaive;
  for (const auto& form : forms) {
    const Screen stable(gl, text, "", fmt::format("vec3({})", form.stable));
    const Screen naive(gl, text, "", fmt::format("vec3({})", form.naive));
    if (!stable.good() || !naive.good()) {
      context.note(fmt::format("{} was refused by the context", form.name));
      continue;
    }
    const auto timings =
        interleaved({{"stable", [&] { stable.draw(); }}, {"naive", [&] { naive.draw(); }}},
                    context.quick() ? 3 : 31);
    Row row{.case_name = "materials",
            .setting = fmt::format("{}, {:.2f} and {:.2f} ns/pixel", form.name,
                                   timings[0].median * 1e9 / (kSide * kSide),
                                   timings[1].median * 1e9 / (kSide * kSide)),
            .speed_unit = "ratio of times",
            .error = form.error,
            .error_unit = "relative, of the highlight at slope 1e-3",
            .reference = "the same text in double",
            .reference_error = 1e-12,
            .must = context.quick() ? 0 : form.must,
            .must_is_least = false,
            .must_error = 1.5e-3};
    set_time(row, timings[0], 1 / timings[1].median);
    context.add(row);
  }
}

void run(Context& context) {
  DiagnosticLog log;
  auto created = preview::Context::create(preview::ContextKind::automatic, log);
  if (!created) return context.note("no OpenGL context");
  const std::unique_ptr<preview::Context> gl = std::move(*created);
  context.set_renderer(gl->renderer());
  for (const BrdfCase& brdf : brdf_cases()) run_brdf(context, gl->gl(), brdf);
  run_forms(context, gl->gl());
}

const bool kAdded =
    add_case({"materials", "laws of reflection: time, and albedos against tables", run});

}  // namespace

}  // namespace panwright::bench::case_materials
