// Texture units, image units and bindings of storage buffers that cumulus uses in addition to common/bindings.glsl. The
// file compiles as GLSL and as C++ (renderers/cumulus/bindings.h).
const int kCoreDepthUnit = 4;
const int kSunDepthUnit = 5;
const int kResolvedDepthUnit = 6;
const int kCoresUnit = 4;
const int kLayerUnit = 5;
const int kRoughnessNoiseUnit = 8;
const int kBubblesBinding = 0;
const int kBubbleOrderBinding = 1;
