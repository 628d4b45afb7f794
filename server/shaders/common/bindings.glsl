// Numbers that shaders share with the C++ code that runs them: texture units, image units, bindings of storage buffers,
// and sizes of work groups. The file compiles as GLSL and as C++ (shaders/bindings.h). The numbers of a single
// technique are in its own folder (e.g. half_angle/bindings.glsl). Within a program, no two textures, images or buffers
// have the same number, which tests check (gl/strict_programs.h). Programs of different techniques may use the same
// numbers.

// Transmittance below which a ray ends. With the transport kDiffusion (scene/transport.h), light_volume/march.frag uses
// a larger one.
const float kOpaqueTransmittance = 5e-3F;

// Texture units and bindings of a medium.
const int kMediumPlaneUnit = 0;  // also the next unit, for plane 1
const int kBricksUnit = 2;
const int kPhaseCurvesUnit = 3;
const int kDetailNoiseUnit = 8;  // also the following units, one for each noise
const int kDetailControlUnit = 16;
const int kBlocksBinding = 0;  // list of cell blocks that a ray may meet

// Texture units of the ground and the picture.
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

// Units for compute shaders that draw a gl::WholeTarget (common/whole_target.glsl).
const int kTargetLimitUnit = 17;
const int kTargetImages = 6;  // also the next image unit

// Size of the table of sunlight by height, which ends at 24 km. Above that height, air attenuates little.
const int kSunlightLevels = 33;
const float kSunlightStep_m = 750.0f;

// Layout of packed rays (renderers::ChosenRays): the size of a block in pixels and the number of blocks in a row.
// Software GL draws the pixels of a block together.
const int kPackedBlockWidth = 4;
const int kPackedBlockHeight = 2;
const int kPackedBlocksInRow = 128;

// Numbers of invocations in a work group. A name with Side is the number along each of two sides, a name with Size the
// total.
const int kLightGroupSide = 8;
const int kMeterGroupSize = 64;
const int kTargetGroupSide = 8;
