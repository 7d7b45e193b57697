// Angles, one per lane. Included inside the namespace of the lanes F, after base/portable_math.h.

THRONG_LANES F inverse_of(F a) { return 1.0f / a; }

/// float_sin_cos() for |angle| up to a quarter turn.
THRONG_LANES void sin_cos_of(F angle, F& sin, F& cos) {
  using K = FloatSinCosConstants;
  const F z = angle * angle;
  const F s = ((K::kSin[3] * z + K::kSin[2]) * z + K::kSin[1]) * z + K::kSin[0];
  const F c = (((K::kCos[4] * z + K::kCos[3]) * z + K::kCos[2]) * z + K::kCos[1]) * z + K::kCos[0];
  sin = angle + (angle * z) * s;
  cos = 1.0f + z * c;
}

/// Sine of an angle in turns.
THRONG_LANES F sin_of_turns(F turns) {
  constexpr float kTurn_rad = 6.28318531f;
  const F u = turns - floor_of(turns + 0.5f), size = abs_of(u);
  F sine, cosine;
  sin_cos_of(kTurn_rad * min_of(size, 0.5f - size), sine, cosine);
  return select(u < 0.0f, 0.0f - sine, sine);
}

/// A direction, for angles_of().
struct Direction {
  F y, x;
};

/// float_arc_tan2() of several (x, y), of length at most 1 and not much shorter: one division
/// serves all.
template <size_t kCount>
THRONG_LANES void angles_of(const Direction (&directions)[kCount], F (&angles)[kCount]) {
  using K = FloatArcTanConstants;
  F longer[kCount], product[kCount];
  for (size_t i = 0; i < kCount; ++i) {
    longer[i] = max_of(max_of(abs_of(directions[i].x), abs_of(directions[i].y)), 1e-5f);
    product[i] = i == 0 ? longer[0] : product[i - 1] * longer[i];
  }
  F rest = inverse_of(product[kCount - 1]);  // inverse product of the remaining ones
  for (size_t i = kCount; i-- > 0;) {
    const F inverse = i == 0 ? rest : rest * product[i - 1];
    rest = rest * longer[i];
    const F ax = abs_of(directions[i].x), ay = abs_of(directions[i].y);
    const F t = min_of(ax, ay) * inverse;
    const F s = t * t;
    F angle = K::kP[5];
    for (int power = 4; power >= 0; --power) angle = angle * s + K::kP[power];
    angle = angle * t;
    angle = select(ay > ax, K::kHalfPi - angle, angle);
    angle = select(directions[i].x < 0.0f, K::kPi - angle, angle);
    angles[i] = select(directions[i].y < 0.0f, 0.0f - angle, angle);
  }
}
