// Narrow lobes on curved surfaces, where normals turn by more than a lobe is wide from sample to sample: such
// samples find a highlight or miss it. Between them normals are taken to spread as a Gaussian of half the step, so that
// the sum over samples of any lobe stays within 1.4 % (2 exp(-2 pi^2/4): Poisson's sum). The step is taken as it is where the
// surface mirrors the Sun: then one width holds for all samples of a highlight, and the sum has no bias. No
// lobe is touched that is as wide by itself.
// Others filter by such derivatives too: Y. Tokuyoshi and A. Kaplanyan, "Improved geometric specular
// antialiasing", 2019.

const float kTurningSlopes = 2.0 * 0.25;  // slopes of lobes are sqrt(2) times as wide as a Gaussian
const float kMostTurning = 4.0;           // of the step as mirrors have it, squared
// What spreads beyond the limb or the terminator would be lost: the Gaussian is a third as wide at most as the
// surface that mirrors the Sun is away from either.
const float kFromLimb = 2.0 / 9.0;

// What is added to squared slopes xx, xy, yy of which a lobe has some by itself.
// foreshortening: squared ratio of the steps along the larger axis, where the surface mirrors the Sun and here;
// mirroring: cosine to the viewer there
vec3 turning_slopes(vec3 squares, float foreshortening, float mirroring, float lobe) {
  float middle = 0.5 * (squares.x + squares.z);
  float apart = 0.5 * (squares.x - squares.z);
  float radius = sqrt(apart * apart + squares.y * squares.y);
  float most = kFromLimb * mirroring * mirroring;
  float wide = max(min((middle + radius) * foreshortening, most) - lobe, 0.0);
  float narrow = max(min(middle - radius, most) - lobe, 0.0);
  float share = radius > 0.0 ? 0.5 * (wide - narrow) / radius : 0.0;
  return vec3(0.5 * (wide + narrow) + share * apart, share * squares.y, 0.5 * (wide + narrow) - share * apart);
}
