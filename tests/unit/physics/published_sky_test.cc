// Tests of the clear sky against published skies. They compare luminance over the sky with the
// CIE's standard, and the zenith with Preetham's formulas. Light on level ground, from noon to
// nautical twilight, is compared with the almanacs' formula. The server's sky model is none of
// these published models; docs/accuracy explains the differences.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "physics/sky.h"

namespace thunderhead::physics {
namespace {

// The illuminance of sunlight above the atmosphere, from Darula, Kittler and Gueymard 2005.
constexpr double kSun_lx = 133'334.0;

double Radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

// Returns the luminance of channels in units of the sun's channels, which are interpreted as sRGB.
double SkyLuminance(const glm::vec3& color) {
  return 0.2126 * static_cast<double>(color.r) + 0.7152 * static_cast<double>(color.g) +
         0.0722 * static_cast<double>(color.b);
}

glm::vec3 TowardsSky(double elevation_deg, double azimuth_deg) {
  const double elevation = Radians(elevation_deg);
  const double azimuth = Radians(azimuth_deg);
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

ClearSky SkyWith(float turbidity, double sun_elevation_deg) {
  return ClearSky(Atmosphere(turbidity, 0.2F), TowardsSky(sun_elevation_deg, 0.0), {});
}

// Returns the luminance over the zenith's for CIE S 011 (ISO 15469:2004), type 12, the standard
// clear sky of low turbidity. The arguments are angles from zenith and sun.
double CieClearSky(double from_zenith, double from_sun, double sun_from_zenith) {
  const auto gradation = [](double angle) { return 1.0 - std::exp(-0.32 / std::cos(angle)); };
  const auto indicatrix = [](double angle) {
    return 1.0 + 10.0 * (std::exp(-3.0 * angle) - std::exp(-1.5 * std::numbers::pi)) +
           0.45 * std::cos(angle) * std::cos(angle);
  };
  return indicatrix(from_sun) * gradation(from_zenith) /
         (indicatrix(sun_from_zenith) * gradation(0.0));
}

// Returns the root mean square of the logarithm of the model's luminance divided by the CIE
// standard's. It covers the sky down to an elevation of 10 degrees, except within 20 degrees of the
// sun.
double DistanceToCie(float turbidity, double sun_elevation_deg) {
  const ClearSky sky = SkyWith(turbidity, sun_elevation_deg);
  const glm::vec3 sun = TowardsSky(sun_elevation_deg, 0.0);
  const double zenith = SkyLuminance(sky.At({0.0F, 0.0F, 1.0F}).radiance);
  double squares = 0.0;
  double weights = 0.0;
  for (int elevation = 10; elevation <= 85; elevation += 5) {
    for (int azimuth = 0; azimuth < 360; azimuth += 15) {
      const glm::vec3 direction = TowardsSky(elevation, azimuth);
      const double from_sun =
          std::acos(std::clamp(static_cast<double>(glm::dot(direction, sun)), -1.0, 1.0));
      if (from_sun < Radians(20.0)) continue;
      const double expected =
          CieClearSky(Radians(90.0 - elevation), from_sun, Radians(90.0 - sun_elevation_deg));
      const double weight = std::cos(Radians(elevation));
      squares +=
          weight *
          std::pow(std::log(SkyLuminance(sky.At(direction).radiance) / zenith / expected), 2);
      weights += weight;
    }
  }
  return std::sqrt(squares / weights);
}

TEST(PublishedSky, LuminanceOverTheSkyIsTheCiesClearSkys) {
  for (const double elevation_deg : {60.0, 40.0, 25.0, 10.0}) {
    // The measured distances are 0.17, 0.12, 0.06, 0.06 for a turbidity of 2.5, and 0.11, 0.08,
    // 0.05, 0.10 for 3. The CIE standard has one scattering indicatrix for all wavelengths and all
    // clear skies. The model has the indicatrix of air and haze.
    EXPECT_LT(DistanceToCie(2.5F, elevation_deg), 0.2) << elevation_deg;
    EXPECT_LT(DistanceToCie(3.0F, elevation_deg), 0.13) << elevation_deg;
  }
}

// Returns the light of sun and sky on level ground: Seidelmann 1992, Explanatory Supplement to the
// Astronomical Almanac, after Janiczek and DeYoung 1987. The formula is a cubic polynomial of the
// sun's elevation, with other coefficients for each range of elevations.
double AlmanacIlluminance_lx(double elevation_deg) {
  struct Range {
    double from_deg;
    std::array<double, 4> factors;
  };
  constexpr std::array<Range, 6> kRanges = {{{20.0, {3.74, 3.97, -4.07, 1.47}},
                                             {5.0, {3.05, 13.28, -45.98, 64.33}},
                                             {-0.8, {2.88, 22.26, -207.64, 1034.30}},
                                             {-5.0, {2.88, 21.81, -258.11, -858.36}},
                                             {-12.0, {2.70, 12.17, -431.69, -1899.83}},
                                             {-18.0, {13.84, 262.72, 1447.42, 2797.93}}}};
  const double x = elevation_deg / 90.0;
  const Range* const range = std::ranges::find_if(
      kRanges, [&](const Range& each) { return elevation_deg >= each.from_deg; });
  const auto& [a, b, c, d] = range->factors;
  return std::pow(10.0, a + x * (b + x * (c + x * d)));
}

double Illuminance_lx(const ClearSky& sky, double elevation_deg) {
  const double direct =
      std::max(std::sin(Radians(elevation_deg)), 0.0) * SkyLuminance(sky.SunTransmittance());
  return kSun_lx * (direct + SkyLuminance(sky.Light().irradiance));
}

TEST(PublishedSky, LightOnTheGroundIsTheAlmanacs) {
  EXPECT_NEAR(AlmanacIlluminance_lx(-6.0), 3.4, 0.02);
  EXPECT_NEAR(AlmanacIlluminance_lx(90.0), 128'800.0, 500.0);
  for (const double elevation_deg : {80.0, 60.0, 40.0, 20.0, 10.0, 5.0, 2.0, 0.0}) {
    const double ratio = Illuminance_lx(SkyWith(3.0F, elevation_deg), elevation_deg) /
                         AlmanacIlluminance_lx(elevation_deg);
    EXPECT_GT(ratio, 0.9) << elevation_deg;  // measured ratios: 0.96 to 1.19
    EXPECT_LT(ratio, 1.25) << elevation_deg;
  }
}

TEST(PublishedSky, TwilightFadesAsTheAlmanacSays) {
  // The light falls by a factor of 100 000 from sunset to the end of nautical twilight. The model
  // treats multiply scattered light as isotropic, and its air as equally bright everywhere. Near
  // the Earth's shadow that is far from reality.
  for (const double elevation_deg : {-1.0, -2.0, -3.0, -4.0, -5.0, -6.0, -8.0, -10.0, -12.0}) {
    const double ratio = Illuminance_lx(SkyWith(2.5F, elevation_deg), elevation_deg) /
                         AlmanacIlluminance_lx(elevation_deg);
    EXPECT_GT(ratio, 0.7) << elevation_deg;  // measured ratios: 0.77 to 1.81
    EXPECT_LT(ratio, 2.0) << elevation_deg;
  }
}

struct Zenith {
  double luminance_kcd_per_m2;
  double x;  // CIE chromaticity x
  double y;
};

// Returns the zenith by Preetham, Shirley and Smits 1999, A practical analytic model for daylight,
// appendix A.2.
Zenith PreethamZenith(double turbidity, double sun_from_zenith) {
  const double t = turbidity;
  const double a = sun_from_zenith;
  const double chi = (4.0 / 9.0 - t / 120.0) * (std::numbers::pi - 2.0 * a);
  const auto cubic = [&](double c3, double c2, double c1, double c0) {
    return c0 + a * (c1 + a * (c2 + a * c3));
  };
  return {(4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192,
          t * t * cubic(0.00166, -0.00375, 0.00209, 0.0) +
              t * cubic(-0.02903, 0.06377, -0.03202, 0.00394) +
              cubic(0.11693, -0.21196, 0.06052, 0.25886),
          t * t * cubic(0.00275, -0.00610, 0.00317, 0.0) +
              t * cubic(-0.04214, 0.08970, -0.04153, 0.00516) +
              cubic(0.15346, -0.26756, 0.06670, 0.26688)};
}

// Returns our zenith. Channels are in units of the sun's and interpreted as sRGB; the sun is a
// black body of 5778 K.
Zenith OurZenith(float turbidity, double sun_elevation_deg) {
  const glm::dvec3 radiance(SkyWith(turbidity, sun_elevation_deg).At({0.0F, 0.0F, 1.0F}).radiance);
  constexpr double kSunX = 0.3263;
  constexpr double kSunY = 0.3357;
  const glm::dvec3 sun(kSunX / kSunY, 1.0, (1.0 - kSunX - kSunY) / kSunY);
  const glm::dvec3 rgb =
      radiance * glm::dvec3(glm::dot(glm::dvec3(3.2404542, -1.5371385, -0.4985314), sun),
                            glm::dot(glm::dvec3(-0.9692660, 1.8760108, 0.0415560), sun),
                            glm::dot(glm::dvec3(0.0556434, -0.2040259, 1.0572252), sun));
  const double x = glm::dot(glm::dvec3(0.4124564, 0.3575761, 0.1804375), rgb);
  const double y = glm::dot(glm::dvec3(0.2126729, 0.7151522, 0.0721750), rgb);
  const double z = glm::dot(glm::dvec3(0.0193339, 0.1191920, 0.9503041), rgb);
  return {1e-3 * kSun_lx * SkyLuminance(glm::vec3(radiance)), x / (x + y + z), y / (x + y + z)};
}

TEST(PublishedSky, TheZenithIsDarkerAndLessBlueThanPreethams) {
  for (const double elevation_deg : {60.0, 40.0, 25.0}) {
    const Zenith ours = OurZenith(2.5F, elevation_deg);
    const Zenith theirs = PreethamZenith(2.5, Radians(90.0 - elevation_deg));
    const double ratio = ours.luminance_kcd_per_m2 / theirs.luminance_kcd_per_m2;
    EXPECT_GT(ratio, 0.5) << elevation_deg;  // measured ratios: 0.75, 0.59, 0.54
    EXPECT_LT(ratio, 0.8) << elevation_deg;
    // The model's chromaticities are 0.027 to 0.038 closer to white. With three channels the model
    // has no wavelengths shorter than the blue channel's, which make the zenith bluest.
    EXPECT_NEAR(ours.x, theirs.x, 0.04) << elevation_deg;
    EXPECT_NEAR(ours.y, theirs.y, 0.04) << elevation_deg;
    EXPECT_LT(ours.x, 0.29) << elevation_deg;
  }
}

}  // namespace
}  // namespace thunderhead::physics
