// The opacity of a ray's segment between two samples. Along the segment, extinction is linear.

// The opacity of a segment (`share`), and the position from 0 to 1 at which half of this opacity is reached (`at`). The
// reciprocal of the extinction at that position is `per_extinction`. Lengths are in steps.
struct Taken {
  float share;
  float at;
  float per_extinction;
};

// Computes the opacity from the extinction at the segment's two ends.
Taken taken_on(float segment, float start, float end) {
  // The depth that the segment would have with the extinction of its start everywhere.
  float start_depth = segment * start;
  float rise = segment * (end - start);
  float depth = start_depth + 0.5 * rise;
  float share = depth < 0.01 ? depth * (1.0 - 0.5 * depth) : 1.0 - exp(-depth);
  // Half of the segment's opacity is reached at the optical depth -log(1 - share / 2) from its start. The polynomial's
  // relative error is below 3e-5.
  float seen_depth =
      share * (0.5 + share * (0.12417144 + share * (0.04885293 + share * (-0.00297576 + share * 0.02306943))));
  // That place is the root of a quadratic equation. `slope` is the extinction there times the segment's length.
  float slope = sqrt(max(start_depth * start_depth + 2.0 * rise * seen_depth, 1e-24));
  float reciprocal = 1.0 / (slope * (start_depth + slope));
  return Taken(share, min(2.0 * seen_depth * slope * reciprocal, 1.0),
               segment * (start_depth + slope) * reciprocal);
}
