/* A host that was not linked with Tactum: it loads the library by its file, steps a scene, and lets go of it. */
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <tactum/embedding/tactum_c.h>

/* The address of a function, put into a pointer to one, as POSIX has it. */
static int find(void* library, const char* name, void* function) {
  void* found = dlsym(library, name);
  if (found == NULL) fprintf(stderr, "%s\n", dlerror());
  memcpy(function, &found, sizeof found);
  return found != NULL;
}

int main(int count, char** words) {
  if (count != 2) return 1;
  for (int round = 0; round < 2; ++round) {
    void* library = dlopen(words[1], RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
      fprintf(stderr, "%s\n", dlerror());
      return 1;
    }
    tactum_status (*open_scene)(const char*, const tactum_scene_options*, tactum_simulation**);
    tactum_status (*step)(tactum_simulation*, const tactum_pose*, tactum_frame*);
    void (*close_scene)(tactum_simulation*);
    const char* (*last_error)(void);
    if (!find(library, "tactum_open_scene", &open_scene) || !find(library, "tactum_step_pose", &step) ||
        !find(library, "tactum_close_scene", &close_scene) ||
        !find(library, "tactum_last_error", &last_error))
      return 1;
    tactum_simulation* scene = NULL;
    if (open_scene("nothing-of-this-name", NULL, &scene) == TACTUM_OK || strlen(last_error()) < 10) return 1;
    if (open_scene("block-on-plate", NULL, &scene) != TACTUM_OK) {
      fprintf(stderr, "%s\n", last_error());
      return 1;
    }
    tactum_pose X_DH = {.R = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    tactum_frame frame = {.struct_size = sizeof frame};
    for (int i = 0; i < 1500; ++i) { /* 15 mm down, onto the plate */
      X_DH.p[2] = -1e-5 * i;
      if (step(scene, &X_DH, &frame) != TACTUM_OK) return 1;
    }
    printf("force %.3f N, %d contacts\n", frame.F_D.f[2], (int)frame.contacts);
    if (!(frame.F_D.f[2] > 0.1) || frame.contacts == 0) return 1;
    close_scene(scene);
    if (dlclose(library) != 0) return 1;
  }
  return 0;
}
