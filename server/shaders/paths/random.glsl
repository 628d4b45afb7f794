// Counter-based random numbers: Philox 4x32-10 (Salmon et al. 2011), as in reference/philox.h. A path's numbers depend
// only on its key and counter, so results do not depend on how paths are dispatched.

uvec2 random_key;
uvec4 random_counter;  // counter of the next block; x is incremented for each block
uvec4 random_words;
int random_left = 0;  // number of unused words in random_words

void philox_round(inout uvec4 counter, uvec2 key) {
  uint high_0;
  uint low_0;
  uint high_1;
  uint low_1;
  umulExtended(0xD2511F53u, counter.x, high_0, low_0);
  umulExtended(0xCD9E8D57u, counter.z, high_1, low_1);
  counter = uvec4(high_1 ^ counter.y ^ key.x, low_1, high_0 ^ counter.w ^ key.y, low_0);
}

uint random_word() {
  if (random_left == 0) {
    random_words = random_counter;
    uvec2 key = random_key;
    for (int i = 0; i < 10; ++i) {
      philox_round(random_words, key);
      key += uvec2(0x9E3779B9u, 0xBB67AE85u);
    }
    ++random_counter.x;
    random_left = 4;
  }
  uint word = random_words.x;
  random_words = random_words.yzwx;
  --random_left;
  return word;
}

// Returns a number uniform over (0, 1), in steps of 2^-23. It is never 0 or 1.
float random_uniform() { return (float(random_word() >> 9) + 0.5) / 8388608.0; }

// Returns an exponentially distributed number with mean 1. It is accurate for very small values, which optically thin
// media need.
float random_exponential() {
  float u = min((float(random_word()) + 0.5) / 4294967296.0, 0.99999994);
  return u < 0.01 ? u * (1.0 + u * (1.0 / 2.0 + u * (1.0 / 3.0 + u / 4.0))) : -log(1.0 - u);
}
