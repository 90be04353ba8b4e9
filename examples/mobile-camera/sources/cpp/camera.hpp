/// The camera and the screen that shows what it sees.
#pragma once

#include <cstdint>
#include <vector>

struct ImageFormat {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> pixels;
};

// @module_start
// @module_name Camera
// @Sense NotifyAtFrequency 25
ImageFormat grabimage(void);
// @module_end

class OperatorScreen {
  public:
    // @module_start
    // @module_name OperatorScreen
    // @DataIn
    virtual void show(const ImageFormat &image) noexcept = 0;
    // @module_end

    virtual ~OperatorScreen() = default;
};
