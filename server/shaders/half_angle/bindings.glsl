// Texture units, image units and bindings of storage buffers that half-angle slicing uses in addition to
// common/bindings.glsl. The file compiles as GLSL and as C++ (renderers/half_angle/bindings.h).
const int kSliceLightUnit = 4;
const int kSliceThicknessUnit = 5;
const int kEyeBeforeUnit = 6;
const int kDistanceBeforeUnit = 13;
const int kLeavingLightImage = 0;
const int kRingDepthImage = 1;
const int kSliceThicknessImage = 2;
