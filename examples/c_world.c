/* A world that a program in C puts together call by call: a finger presses a sprung button into its housing. */

#include <math.h>
#include <stdio.h>
#include <tactum/embedding/tactum_c.h>

/* A box about the origin. */
static tactum_part* box(double x_m, double y_m, double z_m) {
  double corners[8][3];
  for (int i = 0; i < 8; ++i) {
    corners[i][0] = (i & 1 ? 0.5 : -0.5) * x_m;
    corners[i][1] = (i & 2 ? 0.5 : -0.5) * y_m;
    corners[i][2] = (i & 4 ? 0.5 : -0.5) * z_m;
  }
  static const int32_t triangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                           {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  tactum_part* part = NULL;
  if (tactum_make_part(corners[0], 8, triangles[0], 12, NULL, &part) != TACTUM_OK) return NULL;
  return part;
}

static int refused(void) {
  fprintf(stderr, "%s\n", tactum_last_error());
  return 1;
}

int main(void) {
  tactum_part *button = box(0.02, 0.02, 0.006), *finger = box(0.01, 0.01, 0.03);
  tactum_world* world = NULL;
  if (button == NULL || finger == NULL || tactum_make_world(NULL, &world) != TACTUM_OK) return refused();

  /* The button slides along z by 5 mm at most, against a spring and a little dry friction. */
  const tactum_joint spring = {.struct_size = sizeof spring,
                               .kind = TACTUM_JOINT_SLIDER,
                               .axis_W = {0, 0, 1},
                               .stiffness = 100.0,
                               .damping = 1.0,
                               .friction = 0.05,
                               .has_limits = 1,
                               .lower = -0.005,
                               .upper = 0.0};
  const tactum_body_options sprung = {.struct_size = sizeof sprung,
                                      .name = "button",
                                      .material = "plastic",
                                      .joint = &spring,
                                      .mass_kg = 0.01};
  const tactum_body_options held = {.struct_size = sizeof held, .name = "finger", .material = "rubber"};
  const tactum_pose below = {.R = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  tactum_pose above = below;
  above.p[2] = 0.020; /* 2 mm between them */
  if (tactum_add_body(world, button, &below, &sprung, NULL) != TACTUM_OK ||
      tactum_add_body(world, finger, &above, &held, NULL) != TACTUM_OK ||
      tactum_set_friction(world, "rubber", "plastic", 0.6) != TACTUM_OK)
    return refused();

  const tactum_tool hand = {.struct_size = sizeof hand, .body = "finger"};
  tactum_simulation* scene = NULL;
  if (tactum_open_world(world, sizeof hand, &hand, 1, 1000.0, &scene) != TACTUM_OK) return refused();
  tactum_release_world(world); /* the scene has its own copy, of the parts as well */
  tactum_release_part(button);
  tactum_release_part(finger);

  tactum_frame frame = {.struct_size = sizeof frame};
  tactum_body pressed = {.struct_size = sizeof pressed};
  for (int i = 0; i < 2000; ++i) { /* 5 mm down in a second: 3 mm of them press the button */
    tactum_pose X_DH = below;
    X_DH.p[2] = -0.005 * fmin(1.0, i * 1e-3);
    if (tactum_step_pose(scene, &X_DH, &frame) != TACTUM_OK) return refused();
  }
  if (tactum_get_body(scene, 0, &pressed) != TACTUM_OK) return refused();
  printf("the button is %.2f mm deep, its spring pushes with %.3f N, the hand feels %.3f N\n",
         -1e3 * pressed.X_WB.p[2], -100.0 * pressed.X_WB.p[2], frame.F_D.f[2]);
  tactum_close_scene(scene);
  /* The spring and, as the button stands still, at most the dry friction of its guide. */
  const double off_N = frame.F_D.f[2] + 100.0 * pressed.X_WB.p[2];
  return pressed.X_WB.p[2] < -0.002 && fabs(off_N) < 0.05 + 1e-6 ? 0 : 1;
}
