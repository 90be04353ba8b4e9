/// Brooks' level 0, "avoid obstacles", as the modules of the paper's figure 18.

#include "level0.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace level0 {

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kNowhere = std::numeric_limits<double>::infinity();

}  // namespace

/* @module_start
 * @module_name Sonar
 *
 * @Sense NotifyWhenReady -- a ring of 24 beams
 */
SonarData scan();
// @module_end

// @module_start
// @module_name SonarMap
// @DataOut NotifyWhenReady
SonarMap mapgenerator(const SonarData &sonar) {
    SonarMap map;
    const auto count = sonar.ranges.size();
    for (std::size_t k = 0; k < count; ++k) {
        if (sonar.ranges[k] < kNowhere) {
            const double bearing = std::fmod(k * 360.0 / count + 180, 360) - 180;
            map.obstacles.push_back({bearing, sonar.ranges[k]});
        }
    }
    return map;
}
// @module_end

// @module_start
// @module_name FeelForce
// @DataOut NotifyWhenReady
Force feelForce(const SonarMap &map) {
    // Repulsions grow with the square of nearness.
    double ahead = 0, aside = 0;
    for (const auto &[bearing, range] : map.obstacles) {
        const double push = std::pow(1000 / std::max(range, 50.0), 2);
        ahead -= push * std::cos(bearing * kDegree);
        aside -= push * std::sin(bearing * kDegree);
    }
    return {std::atan2(aside, ahead) / kDegree, std::hypot(ahead, aside)};
}
// @module_end

/// A threshold: a weak force is not worth running from.
class Runaway {
  public:
    // @module_start
    // @module_name Runaway
    // @DataOut NotifyWhenReady
    [[nodiscard]] std::optional<Force> runAway(const Force &force) const {
        return force.strength > threshold_ ? std::optional(force) : std::nullopt;
    }
    // @module_end

  private:
    double threshold_ = 1.5;
};

// @module_start
// @module_name Turn
// @ControlOut Rotn_Y
std::optional<MotionData> turn(const Force &heading) {
    if (std::abs(heading.bearing) < 15) {
        return std::nullopt;
    }
    return MotionData{"Rotn_Y", std::clamp(3 * heading.bearing, -60.0, 60.0)};
}
// @module_end

// @module_start
// @module_name Forward
// @ControlOut Trans_Z
MotionData forward(const Force &heading) {
    return {"Trans_Z", std::max(0.0, 250 * std::cos(heading.bearing * kDegree))};
}
// @module_end

/// Halts while something immediately ahead comes nearer; then lets the robot turn away.
class Collide {
  public:
    // @module_start
    // @module_name Collide
    // @ControlOut Trans_Z
    std::optional<MotionData> collide(const SonarMap &map) {
        double ahead = kNowhere;
        for (const auto &[bearing, range] : map.obstacles) {
            if (std::abs(bearing) <= 40) {
                ahead = std::min(ahead, range);
            }
        }
        const double closing = std::exchange(before_, ahead) - ahead;
        return ahead < 450 && closing > 12 ? std::optional(MotionData{"Trans_Z", 0}) : std::nullopt;
    }
    // @module_end

  private:
    double before_ = kNowhere;
};

// @module_start
// @module_name MobilePlatform
// @Rotn_Y _ _ 60
// @Trans_Z _ _ 250
void drive(const MotionData &motion);
// @module_end

}  // namespace level0
