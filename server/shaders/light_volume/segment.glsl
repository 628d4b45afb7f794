// A ray's segment between two samples, on which extinction is linear.

// A segment's opacity (share), the place on it where half of that is reached (at), and the reciprocal of the extinction
// there. Lengths are in steps.
struct Taken {
  float share;
  float at;
  float per_extinction;
};

// Computes the opacity from the extinction at the segment's two ends.
Taken taken_on(float segment, float start, float end) {
  float start_depth = segment * start;  // of a segment with its start's extinction everywhere
  float rise = segment * (end - start);
  float depth = start_depth + 0.5 * rise;
  float share = depth < 0.01 ? depth * (1.0 - 0.5 * depth) : 1.0 - exp(-depth);
  // Half of the segment's opacity is reached at the optical depth -log(1 - share / 2) from its start. The polynomial's
  // relative error is below 3e-5.
  float seen_depth =
      share * (0.5 + share * (0.12417144 + share * (0.04885293 + share * (-0.00297576 + share * 0.02306943))));
  // That place is the root of a quadratic. There the depth grows by `slope` over the segment.
  float slope = sqrt(max(start_depth * start_depth + 2.0 * rise * seen_depth, 1e-24));
  float reciprocal = 1.0 / (slope * (start_depth + slope));
  return Taken(share, min(2.0 * seen_depth * slope * reciprocal, 1.0),
               segment * (start_depth + slope) * reciprocal);
}
