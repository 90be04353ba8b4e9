// @module_start
// @module_name A
X before();
// @Sense RequestWhenReady
// @module_end
X after();
// @module_start
// @module_name B
// @Sense RequestWhenReady
class Camera {
public:
  X grab();
};
// @DataOut RequestWhenReady
typedef int X;
// @DataOut RequestWhenReady
X x = grab(3);
// @DataOut RequestWhenReady
Camera camera(3);
// @DataOut RequestWhenReady
#define GRAB(x) x
return grab(x);
// @DataOut RequestWhenReady
}
// @DataOut RequestWhenReady
std::vector<int> (*pointer)(int);
// @module_end
