/* Distance of two parts in C: a block that is made in memory stands over another one, and sinks into it. */

#include <math.h>
#include <stdio.h>
#include <tactum/embedding/tactum_c.h>

/* A cube with edges of 20 mm about the origin. */
static tactum_part* cube(const char* name) {
  const double h = 0.010;
  double corners[8][3];
  for (int i = 0; i < 8; ++i) {
    corners[i][0] = i & 1 ? h : -h;
    corners[i][1] = i & 2 ? h : -h;
    corners[i][2] = i & 4 ? h : -h;
  }
  static const int32_t triangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                           {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const tactum_part_options options = {
      .struct_size = sizeof options, .name = name, .density_kg_per_m3 = 7800};
  tactum_part* part = NULL;
  if (tactum_make_part(corners[0], 8, triangles[0], 12, &options, &part) != TACTUM_OK)
    fprintf(stderr, "%s\n", tactum_last_error());
  return part;
}

int main(void) {
  tactum_part *lower = cube("lower"), *upper = cube("upper");
  if (lower == NULL || upper == NULL) return 1;
  tactum_part_info info = {.struct_size = sizeof info};
  if (tactum_inspect_part(lower, &info) != TACTUM_OK) return 1;
  printf("%s: %.4f kg, %d piece(s)\n", tactum_part_name(lower), info.mass_kg, (int)info.pieces);
  if (fabs(info.mass_kg - 0.0624) > 1e-9) return 1;

  const tactum_pose at_origin = {.R = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  for (int step = 0; step < 3; ++step) {
    tactum_pose above = at_origin;
    above.p[2] = 0.030 - 0.006 * step; /* gaps of 10 mm, 4 mm, and 2 mm deep */
    tactum_distance clearance = {.struct_size = sizeof clearance},
                    distance = {.struct_size = sizeof distance};
    if (tactum_clearance(lower, &at_origin, upper, &above, &clearance) != TACTUM_OK ||
        tactum_signed_distance(lower, &at_origin, upper, &above, &distance) != TACTUM_OK) {
      fprintf(stderr, "%s\n", tactum_last_error());
      return 1;
    }
    printf("clearance %.6f m, signed distance %.6f m, normal z %+.0f\n", clearance.distance_m,
           distance.distance_m, distance.n_BA_W[2]);
    const double expected = 0.010 - 0.006 * step;
    if (fabs(distance.distance_m - expected) > 1e-9 ||
        fabs(clearance.distance_m - fmax(0.0, expected)) > 1e-9)
      return 1;
  }
  tactum_release_part(lower);
  tactum_release_part(upper);
  return 0;
}
