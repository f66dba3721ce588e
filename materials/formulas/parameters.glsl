// What the formulas know of a material; docs/conventions.md says what the fields mean.
struct Surface {
  Vec3 diffuse;      // linear RGB, the colour of a texture or vertex multiplied in
  Vec3 specular;     // linear RGB
  Vec3 emissive;     // linear RGB
  Vec3 weights;      // of diffuse, specular, emissive
  Vec3 indices;      // real refractive index of each channel; 0: F = 1
  Real shine;        // Blinn-Phong exponent
  Real cook_d;       // factor of D
  Real cook_m;       // RMS slope
  Real cook_f;       // factor of F
  Real cook_g;       // factor of G
  Real oren;         // sigma, radians
  Real hapke_w;      // single-scattering albedo
  Real hapke_h;      // width of the opposition effect
  Real hapke_b0;     // strength of the opposition effect
  Real hapke_rough;  // mean roughness angle, radians
  Real hapke_b;      // Henyey-Greenstein asymmetry, 0 to 1; 0: isotropic particles
  Real hapke_c;      // which lobe is the stronger: 1 all backward, -1 all forward
};
