// Texture units, image units and bindings of storage buffers that the light volume uses in addition to
// common/bindings.glsl. The file compiles as GLSL and as C++ (renderers/light_volume/bindings.h).
const int kArrivedUnit = 4;
const int kCarriedUnit = 5;
const int kThicknessUnit = 6;
const int kLightMediumUnit = 7;
const int kNearRatioUnit = 13;
const int kExitsUnit = 5;
const int kNetInwardUnit = 6;
const int kCorrectionRedUnit = 13;
const int kCorrectionGreenUnit = 14;
const int kCorrectionBlueUnit = 15;
const int kCarriedImage = 0;
const int kThicknessImage = 1;
const int kShadowImage = 2;
const int kArrivedImage = 3;
const int kSampledCellsImage = 4;
const int kSampledLightImage = 5;
const int kLightMediumImage = 6;
const int kNearRatioImage = 7;

// Invocations in a work group.
const int kBlockGroupSize = 32;
