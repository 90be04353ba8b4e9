/*
 * @module_start
 * @module_name Bare
 */
void control(Image image);
/* @module_end */

/* @module_start */
/* @module_name Screen */
/* @Rotn_Y -- about itself */
/* @DataIn */
void show(Image image);
/* @module_end */

/** @module_start
    @module_name Camera
    @Sense NotifyWhenReady */
Image grab();
/* @module_end */

  /* @module_start */
  /* @module_name Eye
   */
  /* @Sense NotifyAtFrequency 25
   * as measured */
  Image look();
  /* @module_end */

/* @module_start */ /* @module_name Lamp */
/* @DataIn */ void shine(Light light);
/* @module_end */

/* @module_start
   @module_name Ear */
/*! @DataOut NotifyWhenReady,
 *  RequestWhenReady
 */
/* @Output Echoes */
void hear(Air air);
/* @module_end */

/* @module_start */
/* @module_name Nose */
void sniff(Air air); /* @DataIn */
void smell(Air air);
/* @module_end */

/* @module_start */
/* @module_name Tail */
int wags; /* @Trans_Z */
int unrelated = 0;
/* @Rotn_X */
int free = 0; void wag(Mood mood);
/* @module_end */

/* @module_start */
/* @module_name Hand */
int fingers; /* @Trans_X */ Mood feel(Air air);
/* @module_end */

/* @module_start */
/* @module_name Foot */
/* @DataIn
   @Input Image */
/* @DataOut NotifyWhenReady
   @Output Image */
void step(Air air);
/* @module_end */

/* @module_start */
/* @module_name Chin */
/* @Output Lines */
/* @Input Image */
/* @DataOut NotifyWhenReady */
void up(Air air);
void down(Air air);
/* @DataIn */
void scratch(Air air);
/* @module_end */

/* @module_start */
/* @module_name Knee */
int unrelated = 0;
/* @Output Lines */
/* @DataOut NotifyWhenReady */
void bend(Air air);
/* @module_end */

/* @module_start */
/* @module_name Heel */
/* @DataIn */
/* @Signature void land(Air air) */
/* @module_end */

/* @module_start */
/* @module_name Toe */
int unrelated = 0;
/* @Rotn_X */
/* as it is */ void touch(Air air);
/* @module_end */

/* @module_start
 * @module_name Hip */
Air breathe(Air air);
// @module_end

/** @module_start */
/** @module_name Neck */
/** @Rotn_X */ int turned = 0;
Air turn(Air air);
/* @module_end */
