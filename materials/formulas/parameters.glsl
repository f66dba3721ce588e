// What the formulas know of a material; docs/conventions.md says what the fields mean.
struct Surface {
  Vec3 diffuse;       // linear RGB, the colour of a texture or vertex multiplied in
  Vec3 specular;      // linear RGB
  Vec3 emissive;      // linear RGB
  Vec3 weights;       // of diffuse, specular, emissive
  Vec3 indices;       // refractive index n of each channel
  Vec3 extinction;    // k of each channel
  Real shine;         // Blinn-Phong exponent
  Real lobe_scale;    // factor of the lobe: the product of cook's factors of D, F and G
  Real alpha;         // RMS slope m of mirror facets, along the tangent
  Real alpha_y;       // and across it
  Vec3 tangent;       // unit, square to the normal; where alpha = alpha_y any
  Real sun_alpha2;    // what the Sun's disc adds to the squares of alpha; 0: the law by itself
  Vec3 facing;        // F0, Fresnel's term of the facets at normal incidence, under the coat
  Vec3 reflectance;   // R, which a map gives in its place; asked only where there is one
  Vec3 many_scale;    // light scattered more than once by the facets: factor of loss(l) loss(v)
  Real loss0;         // loss(cos): a polynomial of sqrt(cos)
  Real loss1;
  Real loss2;
  Real loss3;
  Real loss4;
  Real loss5;
  Real loss6;
  Real loss7;
  Real oren;          // oren_nayar: sigma, radians; eon: roughness 0 to 1
  Real hapke_w;       // single-scattering albedo; Lommel-Seeliger's too
  Real hapke_h;       // width of the shadow-hiding opposition effect
  Real hapke_b0;      // its strength
  Real hapke_rough;   // mean roughness angle, radians
  Real hapke_b;       // Henyey-Greenstein asymmetry, 0 to 1; 0: isotropic particles
  Real hapke_c;       // which lobe is the stronger: 1 all backward, -1 all forward
  Real hapke_hc;      // width of the coherent backscatter
  Real hapke_bc0;     // its strength
  Real hapke_k;       // porosity factor K, >= 1
  Real hapke_h0;      // H of this albedo (see hapke.glsl)
  Real hapke_h1;
  Real hapke_h2;
  Real hapke_h3;
  Real hapke_h4;
  Real hapke_h5;
  Real hapke_h6;
  Real hapke_h7;
  Real coat_index;    // refractive index of the coat, >= 1
  Real coat_alpha;    // RMS slope of its surface
  Real coat_share;    // part of the surface that it covers, 0 to 1
  Vec3 coat_depth;    // optical thickness across it
  Vec3 coat_return;   // share of diffuse light from below that it sends back
  Real tilt_x;        // slope of the mirror facets' mean plane along the tangent
  Real tilt_y;        // and across it
};
