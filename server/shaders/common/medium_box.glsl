// The box of a medium, and the transformation from local metres to the texture coordinates of its cells.
uniform vec3 texture_from_local_scale;
uniform vec3 texture_from_local_offset;
uniform vec3 medium_low_m;  // the box in local metres
uniform vec3 medium_high_m;
