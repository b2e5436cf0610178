/* A device of one's own that joins from another process, with the one header that it needs: a ball on a
 * spring, pulled to and fro by an unseen hand, and pushed by what Tactum computes.
 *
 *   ./network_device 5 & tactum feel block-on-plate --device network --duration 4 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <tactum/drivers/tactum_device.h>

int main(int argc, char** argv) {
  const double duration_s = argc > 1 ? atof(argv[1]) : 5.0;
  const int port = argc > 2 ? atoi(argv[2]) : TACTUM_DEVICE_PORT;
  tactum_device_info info = {.flags = TACTUM_SENSES_ROTATION | TACTUM_ACTUATES_FORCE,
                             .max_force_N = 8.0,
                             .stiffest_N_per_m = 1500.0,
                             .workspace_radius_m = 0.08,
                             .rate_Hz = 1000.0,
                             .mass_kg = 0.1,
                             .damping_Ns_per_m = 2.0,
                             .name = "example",
                             .serial = "1"};
  tactum_device_link link;
  if (tactum_device_connect(&link, "127.0.0.1", port, &info, 20000) != 0) {
    fprintf(stderr, "no program waits for a device at port %d\n", port);
    return 1;
  }
  tactum_device_state state = {.orientation_wxyz = {1.0, 0.0, 0.0, 0.0}, .flags = TACTUM_HAS_VELOCITY};
  const double dt_s = 1e-3, hand_N_per_m = 200.0, begin_s = tactum_clock_s();
  double largest_N = 0.0;
  while (tactum_clock_s() - begin_s < duration_s && tactum_device_send(&link, &state) == 0) {
    double wrench[6];
    tactum_device_receive(&link, wrench);
    const double time_s = tactum_clock_s() - begin_s;
    for (int i = 0; i < 3; ++i) { /* the hand's place goes 20 mm down and up */
      const double hand_m = i == 2 ? -0.02 * sin(3.0 * time_s) : 0.0;
      const double force_N = wrench[i] + hand_N_per_m * (hand_m - state.position[i]) -
                             (2.0 + info.damping_Ns_per_m) * state.velocity[i];
      state.velocity[i] += dt_s * force_N / info.mass_kg;
      state.position[i] += dt_s * state.velocity[i];
    }
    const double size_N = sqrt(wrench[0] * wrench[0] + wrench[1] * wrench[1] + wrench[2] * wrench[2]);
    if (size_N > largest_N) largest_N = size_N;
    const struct timespec pause = {0, 1000000};
    nanosleep(&pause, NULL);
  }
  tactum_device_disconnect(&link);
  printf("largest force %.3f N\n", largest_N);
  return 0;
}
