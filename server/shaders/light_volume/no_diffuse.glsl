// Replaces light_volume/diffuse_seen.glsl if no diffusion equation is solved. Its functions have the same names and add
// no light.
struct DiffuseSample {
  float transport;
};

struct DiffuseSeen {
  float transmittance;
};

void begin_diffuse(float step_m) {}
DiffuseSample diffuse_at(vec3 place, Medium medium) { return DiffuseSample(0.0); }
DiffuseSample no_diffuse_sample() { return DiffuseSample(0.0); }
DiffuseSample mixed(DiffuseSample a, DiffuseSample b, float at) { return a; }
DiffuseSeen no_diffuse_seen() { return DiffuseSeen(1.0); }
float see_diffuse(inout DiffuseSeen seen, Taken taken, DiffuseSample there, float sun_depth_root, float extinction) { return 0.0; }
void close_diffuse(inout DiffuseSeen seen) {}
vec3 diffuse_radiance(DiffuseSeen seen, vec3 sunlight) { return vec3(0.0); }
