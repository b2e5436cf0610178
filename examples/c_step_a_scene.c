/* A scene that a program in C steps: the gears, led by the hand that the scene comes with, as `tactum feel
 * gears` has them, and where things are for an engine to draw. */

#include <math.h>
#include <stdio.h>
#include <tactum/embedding/tactum_c.h>

int main(void) {
  tactum_simulation* scene = NULL;
  if (tactum_open_scene("gears", NULL, &scene) != TACTUM_OK || tactum_open_hand(scene) != TACTUM_OK) {
    fprintf(stderr, "%s\n", tactum_last_error());
    return 1;
  }
  double largest_Nm = 0.0, worst_residual_m = 0.0;
  tactum_frame frame = {.struct_size = sizeof frame};
  for (int i = 0; i < 3000; ++i) {
    tactum_sample sample = {.struct_size = sizeof sample};
    if (tactum_read_hand(scene, &sample) != TACTUM_OK) return 1; /* or a sample of the program's own */
    if (tactum_step_sample(scene, &sample, &frame) != TACTUM_OK) return 1;
    if (tactum_write_hand(scene, &frame.F_D) != TACTUM_OK) return 1;
    const double* t = frame.F_D.t; /* the wheel is grasped at its axle: it is felt by its torque */
    largest_Nm = fmax(largest_Nm, sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
    tactum_contact contacts[64];
    size_t count = 0;
    tactum_contacts(scene, sizeof contacts[0], contacts, 64, &count);
    for (size_t c = 0; c < count && c < 64; ++c)
      if (contacts[c].normal_force_N > 0.0) worst_residual_m = fmax(worst_residual_m, contacts[c].residual_m);
  }
  for (int32_t i = 0; i < tactum_body_count(scene); ++i) {
    tactum_body body = {.struct_size = sizeof body};
    double position[3], quaternion[4];
    if (tactum_get_body(scene, i, &body) != TACTUM_OK) return 1;
    tactum_pose_to_engine(TACTUM_AXES_UNITY, &body.X_WP, position, quaternion);
    printf("%s: in Unity at %.4f %.4f %.4f, turned %.4f %.4f %.4f %.4f\n", tactum_body_name(scene, i),
           position[0], position[1], position[2], quaternion[0], quaternion[1], quaternion[2], quaternion[3]);
  }
  printf("largest torque %.4f N m, largest residual of a contact that pushes %.1e m\n", largest_Nm,
         worst_residual_m);
  tactum_close_scene(scene);

  if (tactum_open_scene("no-such-scene", NULL, &scene) == TACTUM_OK) return 1;
  printf("%s\n", tactum_last_error());
  return largest_Nm > 0.001 && worst_residual_m < 1e-5 ? 0 : 1;
}
