/// @module_start
/// @module_name Bare
struct Bare {
  void control(Image image);
};
/// @module_end

//! @module_start
//! @module_name Screen
//! @Rotn_Y
class Größe {
    //! @DataIn
    //! @Input Image
    void show();
    // @DataOut NotifyWhenReady
    // @Output Lines
    void lines();
    void other();
};
//! @module_end

  // @module_start
  // @module_name Camera
    Image grab();
  // @module_end

// @module_start
// @module_name Lost
// @module_end

int é = 0; // @module_start
int ö = 0; // @module_name Eye
int ü = 0; // @Sense NotifyAtFrequency 25,
  //    RequestWhenReady
Image look();
int ä = 0; // @module_end

/// @module_start
/// @module_name Hand
 Image hold(Image image);
// @module_end
