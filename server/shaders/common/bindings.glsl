// Numbers that shaders share with the C++ that runs them: texture units, image units, bindings of storage buffers, sizes
// of work groups. Compiles as GLSL and as C++ (shaders/bindings.h). Within a program each number of a kind is used once, which
// tests check (gl/strict_programs.h); programs of different techniques share numbers.

// The transmittance below which a ray of paper or consistent transport ends.
const float kOpaqueTransmittance = 5e-3F;

// Textures of a medium.
const int kMediumPlaneUnit = 0;  // and the one after
const int kBricksUnit = 2;
const int kPhaseCurvesUnit = 3;
const int kDetailNoiseUnit = 8;  // and as many as there are noises
const int kDetailControlUnit = 16;

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
const int kEyeUnit = 4;
const int kLinearFrameUnit = 4;
const int kChosenPlacesUnit = 18;
const int kAureoleUnit = 4;

// Of whole targets that are computed.
const int kTargetLimitUnit = 17;
const int kTargetImages = 6;  // and the one after

// Of half-angle slicing.
const int kSliceLightUnit = 4;
const int kSliceThicknessUnit = 5;
const int kEyeBeforeUnit = 6;
const int kDistanceBeforeUnit = 13;
const int kLeavingLightImage = 0;
const int kRingDepthImage = 1;
const int kSliceThicknessImage = 2;

// Of the light volume.
const int kArrivedUnit = 4;
const int kCarriedUnit = 5;
const int kThicknessUnit = 6;
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
const int kBlocksBinding = 0;

// Of metaballs.
const int kBallLightImage = 0;
const int kBallsBinding = 0;
const int kBallArrivedBinding = 1;
const int kBallOrderBinding = 2;
const int kBallSourcesBinding = 3;
const int kBallTilesBinding = 4;

// Of cumulus.
const int kCoreDepthUnit = 4;
const int kSunDepthUnit = 5;
const int kResolvedDepthUnit = 6;
const int kCoresUnit = 4;
const int kLayerUnit = 5;
const int kRoughnessNoiseUnit = 8;
const int kBubblesBinding = 0;
const int kBubbleOrderBinding = 1;

// Table of sunlight by height: up to 24 km, above which air attenuates little.
const int kSunlightLevels = 33;
const float kSunlightStep_m = 750.0f;

// Invocations in a work group: along each of two sides, or in total.
const int kLightGroupSide = 8;
const int kArriveGroupSize = 32;
const int kBallGroupSize = 64;
const int kMeterGroupSize = 64;
const int kTargetGroupSide = 8;
