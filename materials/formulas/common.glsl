// Elementary functions by sums, products, divisions and square roots alone (and ldexp and frexp,
// which are exact), so that every processor gives the same bits: built-in exp, log and acos differ by up to
// 1e-4 between drivers. Each is good to a few ulp in float and in double.

FORMULA Real dot3(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

FORMULA Vec3 cross3(Vec3 a, Vec3 b) {
  return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

FORMULA Real length3(Vec3 a) { return sqrt(dot3(a, a)); }

// exp(-x), x >= 0. From 80 on (2e-35) it is 0: no lobe is seen there, and float stays normal.
FORMULA Real exp_negative(Real x) {
  if (!(x < Real(80))) return Real(0);
  // x = k ln 2 - q; the products with the first part of ln 2 are exact. Cody, Waite 1980.
  int k = int(x * Real(1.4426950408889634) + Real(0.5));
  Real q = Real(k) * Real(-2.1219444005469058e-4) - (x - Real(k) * Real(0.693359375));
  // Taylor to q^13, |q| <= ln 2 / 2, even and odd powers apart
  Real q2 = q * q;
  Real even = Real(2.08767569878681e-09);
  even = even * q2 + Real(2.755731922398589e-07);
  even = even * q2 + Real(2.48015873015873e-05);
  even = even * q2 + Real(0.001388888888888889);
  even = even * q2 + Real(0.041666666666666664);
  even = even * q2 + Real(0.5);
  even = even * q2 + Real(1);
  Real odd = Real(1.6059043836821613e-10);
  odd = odd * q2 + Real(2.505210838544172e-08);
  odd = odd * q2 + Real(2.7557319223985893e-06);
  odd = odd * q2 + Real(0.0001984126984126984);
  odd = odd * q2 + Real(0.008333333333333333);
  odd = odd * q2 + Real(0.16666666666666666);
  odd = odd * q2 + Real(1);
  return ldexp(even + q * odd, -k);
}

// 1 - exp(-x), 0 <= x < 1/2, by Taylor's series to x^15.
FORMULA Real one_minus_exp_near(Real x) {
  Real x2 = x * x;
  Real even = Real(7.647163731819816e-13);
  even = even * x2 + Real(1.6059043836821613e-10);
  even = even * x2 + Real(2.505210838544172e-08);
  even = even * x2 + Real(2.7557319223985893e-06);
  even = even * x2 + Real(0.0001984126984126984);
  even = even * x2 + Real(0.008333333333333333);
  even = even * x2 + Real(0.16666666666666666);
  even = even * x2 + Real(1);
  Real odd = Real(1.1470745597729725e-11);
  odd = odd * x2 + Real(2.08767569878681e-09);
  odd = odd * x2 + Real(2.755731922398589e-07);
  odd = odd * x2 + Real(2.48015873015873e-05);
  odd = odd * x2 + Real(0.001388888888888889);
  odd = odd * x2 + Real(0.041666666666666664);
  odd = odd * x2 + Real(0.5);
  return x * (even - x * odd);
}

// 1 - exp(-x), x >= 0, without cancellation; e: exp(-x).
FORMULA Real one_minus_exp_of(Real x, Real e) {
  if (!(x < Real(0.5))) return Real(1) - e;
  return one_minus_exp_near(x);
}

FORMULA Real one_minus_exp(Real x) {
  if (!(x < Real(0.5))) return Real(1) - exp_negative(x);
  return one_minus_exp_near(x);
}

// ln(1 + x), 0 <= x < 1e38.
FORMULA Real log_one_plus(Real x) {
  Real y = Real(1) + x;
  Real d = x;
  Real k = Real(0);
  // 1 + x = 2^k (1 + d), |d| small
  if (x > Real(0.41421356)) {
    int whole = 0;
    y = Real(2) * frexp(y, whole);
    k = Real(whole - 1);
    if (y > Real(1.41421356)) {
      y = y * Real(0.5);
      k = k + Real(1);
    }
    d = y - Real(1);
  }
  // 2 artanh z, |z| <= 0.172
  Real z = d / (Real(2) + d);
  Real s = z * z;
  Real p = Real(0.043478260869565217);
  p = p * s + Real(0.047619047619047619);
  p = p * s + Real(0.052631578947368421);
  p = p * s + Real(0.058823529411764706);
  p = p * s + Real(0.066666666666666667);
  p = p * s + Real(0.076923076923076923);
  p = p * s + Real(0.090909090909090909);
  p = p * s + Real(0.11111111111111111);
  p = p * s + Real(0.14285714285714286);
  p = p * s + Real(0.2);
  p = p * s + Real(0.33333333333333333);
  p = p * s + Real(1);
  return k * Real(0.69314718055994531) + Real(2) * z * p;
}

// The angle in [0, pi/2] whose sine and cosine are in the ratio s : c, both >= 0.
FORMULA Real angle_of(Real s, Real c) {
  // the tangent of the angle to the nearer axis, of its half, of its quarter
  Real t = min(s, c) / max(max(s, c), Real(1e-30));
  Real u = t / (Real(1) + sqrt(Real(1) + t * t));
  Real w = u / (Real(1) + sqrt(Real(1) + u * u));
  // arctan w, w <= tan(pi/16)
  Real q = w * w;
  Real p = Real(0.043478260869565217);
  p = Real(0.047619047619047619) - p * q;
  p = Real(0.052631578947368421) - p * q;
  p = Real(0.058823529411764706) - p * q;
  p = Real(0.066666666666666667) - p * q;
  p = Real(0.076923076923076923) - p * q;
  p = Real(0.090909090909090909) - p * q;
  p = Real(0.11111111111111111) - p * q;
  p = Real(0.14285714285714286) - p * q;
  p = Real(0.2) - p * q;
  p = Real(0.33333333333333333) - p * q;
  p = Real(1) - p * q;
  Real angle = Real(4) * w * p;
  return s <= c ? angle : Real(1.5707963267948966) - angle;
}

// tan x, 0 <= x; from 1.5 on tan 1.5.
FORMULA Real tangent(Real x) {
  // of the half angle by Taylor, then doubled
  Real h = Real(0.5) * min(x, Real(1.5));
  Real q = h * h;
  Real s = Real(1) - q * Real(3.6764705882352941e-3);
  s = Real(1) - s * q * Real(4.7619047619047619e-3);
  s = Real(1) - s * q * Real(6.4102564102564103e-3);
  s = Real(1) - s * q * Real(9.0909090909090909e-3);
  s = Real(1) - s * q * Real(1.3888888888888889e-2);
  s = Real(1) - s * q * Real(2.3809523809523810e-2);
  s = Real(1) - s * q * Real(0.05);
  s = Real(1) - s * q * Real(0.16666666666666667);
  Real c = Real(1) - q * Real(4.1666666666666667e-3);
  c = Real(1) - c * q * Real(5.4945054945054945e-3);
  c = Real(1) - c * q * Real(7.5757575757575758e-3);
  c = Real(1) - c * q * Real(1.1111111111111111e-2);
  c = Real(1) - c * q * Real(1.7857142857142857e-2);
  c = Real(1) - c * q * Real(3.3333333333333333e-2);
  c = Real(1) - c * q * Real(8.3333333333333333e-2);
  c = Real(1) - c * q * Real(0.5);
  Real t = h * s / c;
  return Real(2) * t / ((Real(1) - t) * (Real(1) + t));
}

// The part of a direction that lies in the surface: as long as the sine of its angle.
FORMULA Vec3 along_surface(Vec3 direction, Vec3 normal, Real cosine) {
  return direction - normal * cosine;
}

// Cosine and sine, >= 0, of the azimuth between two such parts of lengths whose product is `sines`;
// z: 1 - |cosine| without cancellation.
FORMULA Vec3 azimuth(Vec3 along_l, Vec3 along_v, Real sines) {
  Real scale = max(sines, Real(1e-30));
  Real cosine = max(min(dot3(along_l, along_v) / scale, Real(1)), Real(-1));
  Real sine = min(length3(cross3(along_l, along_v)) / scale, Real(1));
  return Vec3(cosine, sine, sine * sine / (Real(1) + abs(cosine)));
}

// tan^2 of the angle between the normal and l + v, without forming its cosine: 1 - cos^2 loses all
// digits near the highlight. cos_sum: n.l + n.v > 0.
FORMULA Real half_tan2(Vec3 to_light, Vec3 to_viewer, Vec3 normal, Real cos_sum) {
  Vec3 across = cross3(normal, to_light + to_viewer);
  return dot3(across, across) / (cos_sum * cos_sum);
}

// (v.h) of the half vector h between two directions.
FORMULA Real half_cosine(Vec3 to_light, Vec3 to_viewer) {
  Vec3 both = to_light + to_viewer;
  return Real(0.5) * length3(both);
}
