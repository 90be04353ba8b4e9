/* é */ // @module_start
/* 日本 */ // @module_name A
	// @Sense NotifyOnMax(1, 2)
X f();
  /* @ControlOut Trans_Z, Trans, Rotn_Y */ X g();
// @Rotn_X 1 b
// @Rotn_Y 5 1
// @Trans_Z _ _ -3
// @Trans_X 1
// @Grasp 0 80 20
// @Grasp 0 80
// @Vertex x
// @Vertex 1 (_,_,_,_,0,0,100)
// @Vertex 1 (_,_,_,_,0,0,200)
// @Vertex 2 (a,b)
// @Converts 0
X h(Y y);
// @Converts 1.5
X i(Y y);
// @Converts
X j(Y y, Z z);
// @module_end
