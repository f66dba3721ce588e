// Solar cells: which parts of a footprint are cell, grid line and gap. Lengths are in pitches of the
// cells. Footprints are boxes along u and v, over which the pattern is averaged exactly.

// Length of what two intervals share; exact where one lies in the other.
FORMULA Real shared_length(Real low, Real length, Real from, Real extent) {
  return max(min(min(length, extent), min(from + extent - low, low + length - from)), Real(0));
}

// How much of [low, low + length] lies in the intervals [k, k + width], k whole, width <= 1.
FORMULA Real pulse_length(Real low, Real length, Real width) {
  Real whole = floor(length);
  Real rest = length - whole;
  Real at = low - floor(low);
  return whole * width + shared_length(at, rest, Real(0), width) +
         shared_length(at, rest, Real(1), width);
}

// How much of [low, low + length] is grid line: `fingers` of them on a cell that lies at
// [from, from + extent], each in the middle of its pitch.
FORMULA Real finger_length(Real low, Real length, Real from, Real extent, Real fingers,
                           Real finger_width) {
  Real on_cell = shared_length(low, length, from, extent);
  if (!(on_cell > Real(0))) return Real(0);
  Real pitch = extent / fingers;
  Real begin = max(low - from, Real(0)) / pitch - Real(0.5) * (Real(1) - finger_width);
  return pitch * pulse_length(begin, on_cell / pitch, finger_width);
}

// Shares of cell, grid lines and gap in the box of size_u by size_v about (u, v). Gaps lie half at
// each side of a pitch; fingers count along u, 0: none.
FORMULA Vec3 cell_shares(Real u, Real v, Real size_u, Real size_v, Real gap_u, Real gap_v,
                         Real fingers, Real finger_width) {
  // smaller ones would divide rounding errors
  Real length_u = max(size_u, Real(1e-5));
  Real length_v = max(size_v, Real(1e-5));
  Real extent_u = Real(1) - gap_u;
  Real extent_v = Real(1) - gap_v;
  Real low_u = u - Real(0.5) * length_u - Real(0.5) * gap_u;
  Real low_v = v - Real(0.5) * length_v - Real(0.5) * gap_v;
  Real cells = pulse_length(low_u, length_u, extent_u) / length_u *
               (pulse_length(low_v, length_v, extent_v) / length_v);
  Real lines = Real(0);
  if (fingers > Real(0) && finger_width > Real(0)) {
    Real whole = floor(length_u);
    Real rest = length_u - whole;
    Real at = low_u - floor(low_u);
    lines = whole * extent_u * finger_width +
            finger_length(at, rest, Real(0), extent_u, fingers, finger_width) +
            finger_length(at, rest, Real(1), extent_u, fingers, finger_width);
    lines = lines / length_u * (pulse_length(low_v, length_v, extent_v) / length_v);
  }
  cells = min(cells, Real(1));
  lines = min(lines, cells);
  return Vec3(cells - lines, lines, Real(1) - cells);
}
