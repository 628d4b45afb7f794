// A ray's segment between two samples, on which extinction is linear.

// A segment's opacity (share), the place on it where half of that is reached (at), and the reciprocal of the
// extinction there. Lengths are in steps.
struct Taken {
  float share;
  float at;
  float per_extinction;
};

// From the extinction at the segment's two ends.
Taken taken_on(float segment, float start, float end) {
  float start_depth = segment * start;  // of a segment that is everywhere as at its start
  float rise = segment * (end - start);
  float depth = start_depth + 0.5 * rise;
  float share = depth < 0.01 ? depth * (1.0 - 0.5 * depth) : 1.0 - exp(-depth);
  // Half of what the segment takes is taken before the optical depth from its start reaches -log(1 - share / 2), off by
  // less than 3e-5 of itself:
  float seen_depth =
      share * (0.5 + share * (0.12417144 + share * (0.04885293 + share * (-0.00297576 + share * 0.02306943))));
  // Where that is: the root of a quadratic. There the depth grows by `slope` over the segment.
  float slope = sqrt(max(start_depth * start_depth + 2.0 * rise * seen_depth, 1e-24));
  float reciprocal = 1.0 / (slope * (start_depth + slope));
  return Taken(share, min(2.0 * seen_depth * slope * reciprocal, 1.0),
               segment * (start_depth + slope) * reciprocal);
}
