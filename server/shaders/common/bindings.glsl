// Numbers that shaders share with the C++ that runs them: texture units, image units, bindings of storage buffers, sizes
// of work groups. Compiles as GLSL and as C++ (shaders/bindings.h). A technique's own are in its folder (e.g.
// half_angle/bindings.glsl). Within a program each number of a kind is used once, which tests check
// (gl/strict_programs.h); programs of different techniques share numbers.

// The transmittance below which a ray of paper or consistent transport ends.
const float kOpaqueTransmittance = 5e-3F;

// Of a medium.
const int kMediumPlaneUnit = 0;  // and the one after
const int kBricksUnit = 2;
const int kPhaseCurvesUnit = 3;
const int kDetailNoiseUnit = 8;  // and as many as there are noises
const int kDetailControlUnit = 16;
const int kBlocksBinding = 0;  // of cells that a ray may meet

// Of the ground and the picture.
const int kGroundDistanceUnit = 7;
const int kTerrainUnit = 8;
const int kGroundShadowUnit = 9;
const int kSkylightFactorUnit = 10;
const int kEyeDistanceUnit = 5;
const int kAirShadeUnit = 11;
const int kAirLightUnit = 4;
const int kSkyHiddenUnit = 12;
const int kStormFacesUnit = 3;
const int kAirShadeImage = 0;
const int kSkyHiddenImage = 0;
const int kStormFacesImage = 1;
const int kGroundLightImage = 0;
const int kMeterImage = 0;
const int kSkyTableUnit = 6;
const int kGroundCoverUnit = 13;
const int kGroundGrainUnit = 14;
const int kGroundSkyUnit = 15;
const int kGroundBordersUnit = 19;
const int kEyeUnit = 4;
const int kLinearFrameUnit = 4;
const int kChosenPlacesUnit = 18;
const int kAureoleUnit = 4;
const int kPackedUnit = 4;

// Of whole targets that are computed.
const int kTargetLimitUnit = 17;
const int kTargetImages = 6;  // and the one after

// Table of sunlight by height: up to 24 km, above which air attenuates little.
const int kSunlightLevels = 33;
const float kSunlightStep_m = 750.0f;

// Of packed rays (renderers::ChosenRays): pixels of a block, which software GL draws together, and blocks beside one another.
const int kPackedBlockWidth = 4;
const int kPackedBlockHeight = 2;
const int kPackedBlocksInRow = 128;

// Invocations in a work group: along each of two sides, or in total.
const int kLightGroupSide = 8;
const int kMeterGroupSize = 64;
const int kTargetGroupSide = 8;
