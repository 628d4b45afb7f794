// Numbers that shaders share with the C++ that runs them: texture units, image units, bindings of storage buffers, and
// sizes of work groups. The file compiles as GLSL and as C++ (shaders/bindings.h). A technique's own numbers are in its
// folder (e.g. half_angle/bindings.glsl). Within a program, each number of a kind is used once, which tests check
// (gl/strict_programs.h). Programs of different techniques may use the same numbers.

// A ray of paper or consistent transport ends below this transmittance.
const float kOpaqueTransmittance = 5e-3F;

// Units of a medium.
const int kMediumPlaneUnit = 0;  // also the next one
const int kBricksUnit = 2;
const int kPhaseCurvesUnit = 3;
const int kDetailNoiseUnit = 8;  // also the next ones, one for each noise
const int kDetailControlUnit = 16;
const int kBlocksBinding = 0;  // cells that a ray may meet

// Units of the ground and the picture.
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

// Units of whole targets that are computed.
const int kTargetLimitUnit = 17;
const int kTargetImages = 6;  // also the next one

// Table of sunlight by height, up to 24 km. Above that height, air attenuates little.
const int kSunlightLevels = 33;
const float kSunlightStep_m = 750.0f;

// Layout of packed rays (renderers::ChosenRays): the pixels of a block, which software GL draws together, and the
// number of blocks in a row.
const int kPackedBlockWidth = 4;
const int kPackedBlockHeight = 2;
const int kPackedBlocksInRow = 128;

// Invocations in a work group, along each of two sides or in total.
const int kLightGroupSide = 8;
const int kMeterGroupSize = 64;
const int kTargetGroupSide = 8;
