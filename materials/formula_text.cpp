#include "materials/formula_text.h"

#include "materials/internal/formula_texts.h"

namespace panwright::materials {
namespace {

constexpr const char* kGlue = "#define Real float\n#define Vec3 vec3\n#define FORMULA\n";
constexpr const char* kUnglue = "#undef Real\n#undef Vec3\n#undef FORMULA\n";

struct Law {
  const char* function;
  const char* text;
};

Law law(DiffuseLaw diffuse) {
  switch (diffuse) {
    case DiffuseLaw::lambert:
      break;
    case DiffuseLaw::oren_nayar:
      return {"oren_nayar_law", oren_nayar_text};
    case DiffuseLaw::hapke:
      return {"hapke_law", hapke_text};
  }
  return {"lambert_law", lambert_text};
}

Law law(SpecularLaw specular) {
  switch (specular) {
    case SpecularLaw::none:
      break;
    case SpecularLaw::blinn_phong:
      return {"blinn_phong_law", blinn_phong_text};
    case SpecularLaw::cook_torrance:
      return {"cook_torrance_law", cook_torrance_text};
  }
  return {"no_specular_law", no_specular_text};
}

}  // namespace

std::string glsl_formulas(DiffuseLaw diffuse, SpecularLaw specular) {
  const Law first = law(diffuse);
  const Law second = law(specular);
  std::string text = kGlue;
  text += std::string("#define PANWRIGHT_DIFFUSE_LAW ") + first.function + '\n';
  text += std::string("#define PANWRIGHT_SPECULAR_LAW ") + second.function + '\n';
  text += parameters_text;
  text += common_text;
  if (specular == SpecularLaw::cook_torrance) text += fresnel_text;
  text += first.text;
  text += second.text;
  text += surface_text;
  text += kUnglue;
  return text + "#undef PANWRIGHT_DIFFUSE_LAW\n#undef PANWRIGHT_SPECULAR_LAW\n";
}

std::string glsl_all_laws() {
  std::string text = kGlue;
  for (const char* part :
       {parameters_text, common_text, fresnel_text, lambert_text, oren_nayar_text, hapke_text,
        no_specular_text, blinn_phong_text, cook_torrance_text})
    text += part;
  return text + kUnglue;
}

}  // namespace panwright::materials
