/// What the modules of Brooks' level 0 hand to each other.
#pragma once

#include <utility>
#include <vector>

namespace level0 {

/// Ranges in mm of a ring of beams; beam k looks at k * 360 / n degrees; a miss is infinite.
struct SonarData {
    std::vector<double> ranges;
};

/// Where an obstacle is: bearing in degrees from ahead, range in mm.
struct Obstacle {
    double bearing;
    double range;
};

/// Polar coordinates of what the sonar hit.
struct SonarMap {
    std::vector<Obstacle> obstacles;
};

/// Where obstacles push the robot: degrees from ahead, and how hard (1: at 1 m).
struct Force {
    double bearing;
    double strength;
};

/// What a motion function is told: degrees or mm per second.
struct MotionData {
    const char *function;
    double rate;
};

}  // namespace level0
