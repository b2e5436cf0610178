#ifndef TACTUM_C_H
#define TACTUM_C_H
/**
 * Tactum for programs in C, and for all that can call C: parts, distance and clearance, scenes that are
 * stepped. docs/c-api.md shows it; examples/c_*.c are programs. Link libtactum_c, or load it when the program
 * runs.
 *
 *   tactum_simulation* scene = NULL;
 *   if (tactum_open_scene("gears", NULL, &scene) != TACTUM_OK) puts(tactum_last_error());
 *   tactum_frame frame = {.struct_size = sizeof frame};
 *   tactum_step_pose(scene, &X_DH, &frame);                    frame.F_D: the wrench on the hand
 *   tactum_close_scene(scene);
 *
 * A world that is no scene file is made call by call: tactum_make_world, tactum_add_body, tactum_open_world.
 *
 * Units are SI: m, kg, s, rad, N, N m. Frames stand in the names: X_WB is the pose of B in W. W is the world,
 * right-handed, z up; D the device, x towards the operator, y to the operator's right, z up; H its handle; P
 * the frame of a part's mesh, as its file has it; B a body, at its centre of mass, with the axes of P.
 *
 * Calls return a status. Of one that is not TACTUM_OK, tactum_last_error() tells what was found, what was
 * expected and where; what it would have filled is then unchanged. No exception leaves a call.
 *
 * Structs that may grow begin with struct_size, which the caller sets to sizeof of the struct: a program that
 * was compiled with an older header works with a newer library. Options that are zero have their defaults.
 *
 * Threads: calls on different handles may come from different threads at once. A handle that is not const in
 * a call is that of one thread at a time; a part is const in all calls but its release, so that many may
 * query it.
 */
/* NOLINTBEGIN(modernize-*, readability-identifier-naming): the headers and names of C. */
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define TACTUM_C_API __attribute__((visibility("default")))
#else
#define TACTUM_C_API
#endif

typedef enum tactum_status {
  TACTUM_OK = 0,
  TACTUM_REFUSED = 1,  /* a file, a mesh, a scene or a setting is not as expected */
  TACTUM_BAD_CALL = 2, /* the call itself is wrong: a null pointer, a struct_size, an index */
  TACTUM_NO_MEMORY = 3,
  TACTUM_INTERNAL = 4 /* a mistake of the library's own: please tell it */
} tactum_status;

/* ---- Plain values, which never grow. ---- */

typedef struct tactum_pose {
  double R[9]; /* rotation, row by row: R[3 * i + j] is row i, column j [-] */
  double p[3]; /* origin [m] */
} tactum_pose;

typedef struct tactum_twist {
  double v[3]; /* of the reference point [m/s] */
  double w[3]; /* angular [rad/s] */
} tactum_twist;

typedef struct tactum_wrench {
  double f[3]; /* force [N] */
  double t[3]; /* torque about the reference point [N m] */
} tactum_wrench;

/* ---- Version and errors. Any thread, at any time. ---- */

/** 10000 major + 100 minor + patch of the library that is loaded. */
TACTUM_C_API int32_t tactum_version(void);
/** The sentence of this thread's last call that was not TACTUM_OK; "" before one. It stays until the next
 * such. */
TACTUM_C_API const char* tactum_last_error(void);
/** What a status means, in a few words. */
TACTUM_C_API const char* tactum_status_text(tactum_status status);

/* ---- Parts. ---- */

typedef struct tactum_part tactum_part;

typedef struct tactum_part_options {
  size_t struct_size;
  const char* name;         /* NULL: that of the file */
  const char* unit;         /* of a mesh's numbers: auto, m, cm, mm, inch; NULL: auto */
  double scale;             /* metres per unit of a mesh's numbers; 0: as `unit` says [m] */
  const char* pieces;       /* auto, given, solid, ...: as `tactum prepare --pieces`; NULL: auto */
  int32_t close_holes;      /* holes of at most so many edges are closed; 0: none */
  int32_t threads;          /* the part does not depend on it; 0: one */
  double density_kg_per_m3; /* 0: 1000 [kg/m^3] */
} tactum_part_options;

typedef struct tactum_part_info {
  size_t struct_size;
  int32_t vertices;         /* of the surface */
  int32_t triangles;        /* of the surface */
  int32_t pieces;           /* convex and solid; 0: the part is felt by its surface */
  int32_t reserved;         /* 0 */
  double size_m;            /* diagonal of the bounding box [m] */
  double volume_m3;         /* [m^3] */
  double mass_kg;           /* [kg] */
  double density_kg_per_m3; /* that mass and inertia are for [kg/m^3] */
  double center_P[3];       /* of mass [m] */
  double inertia_B[9];      /* about the centre of mass, axes of P, row by row [kg m^2] */
  double box_min_P[3];      /* [m] */
  double box_max_P[3];      /* [m] */
} tactum_part_info;

/** A view of triangles, which belongs to what it was asked of and lives as long. */
typedef struct tactum_mesh_view {
  size_t struct_size;
  const double* vertices; /* x, y, z of each [m] */
  size_t vertex_count;
  const int32_t* triangles; /* three vertices of each, counter-clockwise seen from outside */
  size_t triangle_count;
} tactum_mesh_view;

/** Loads a prepared part, or a mesh file (OBJ, STL, PLY, OFF, glTF, GLB, COLLADA), which is then prepared:
 * repaired, cut into pieces, verified. Options may be NULL; a prepared part needs none. Slow. Release it with
 * tactum_release_part. */
TACTUM_C_API tactum_status tactum_load_part(const char* path, const tactum_part_options* options,
                                            tactum_part** part);
/** The same of a mesh in memory, in metres unless the options say otherwise; it is copied. */
TACTUM_C_API tactum_status tactum_make_part(const double* vertices, size_t vertex_count,
                                            const int32_t* triangles, size_t triangle_count,
                                            const tactum_part_options* options, tactum_part** part);
/** Writes it as a file that tactum_load_part and scenes load; whole or not at all. */
TACTUM_C_API tactum_status tactum_save_part(const tactum_part* part, const char* path);
/** NULL is allowed. No other thread may be using it. */
TACTUM_C_API void tactum_release_part(tactum_part* part);

TACTUM_C_API tactum_status tactum_inspect_part(const tactum_part* part, tactum_part_info* info);
/** Name, and the report of its preparation as JSON; both live as long as the part. "" for a null part. */
TACTUM_C_API const char* tactum_part_name(const tactum_part* part);
TACTUM_C_API const char* tactum_part_report(const tactum_part* part);
/** The surface, in P. */
TACTUM_C_API tactum_status tactum_part_mesh(const tactum_part* part, tactum_mesh_view* view);

/* ---- Distance and clearance. ---- */

typedef struct tactum_distance {
  size_t struct_size;
  double distance_m;      /* [m] */
  double p_a_W[3];        /* closest point on A [m] */
  double p_b_W[3];        /* closest point on B [m] */
  double n_BA_W[3];       /* unit, from B to A; zero where a clearance is zero [-] */
  int32_t touching_pairs; /* of triangles with a common point; only of a clearance */
  int32_t inside;         /* one lies wholly in a solid of the other; only of a clearance */
  int32_t certified;      /* the distance is proved to 1e-9 of the size */
  int32_t reserved;       /* 0 */
} tactum_distance;

/** Exact clearance of two surfaces of any shape with P of A at X_WA and P of B at X_WB; zero where they touch
 * or cross, and where one lies in a solid of the other. */
TACTUM_C_API tactum_status tactum_clearance(const tactum_part* a, const tactum_pose* X_WA,
                                            const tactum_part* b, const tactum_pose* X_WB,
                                            tactum_distance* distance);
/** Signed distance of two parts of solid pieces; negative by the depth of the deepest pair of pieces. Refused
 * where a part is felt by its surface. */
TACTUM_C_API tactum_status tactum_signed_distance(const tactum_part* a, const tactum_pose* X_WA,
                                                  const tactum_part* b, const tactum_pose* X_WB,
                                                  tactum_distance* distance);

/* ---- Scenes. ---- */

typedef struct tactum_simulation tactum_simulation;

typedef struct tactum_scene_options {
  size_t struct_size;
  const char* device; /* whose limits hold, by name as in `tactum devices`; NULL: the scene's simulated one */
  const char* grip;   /* of a simulated hand: loose, medium, firm; NULL: the scene's */
  const char* response;             /* constraint or penalty; NULL: the scene's */
  const char* settings;             /* a table [settings] as text, put over those of the scene; NULL: none */
  double rate_Hz;                   /* frames a second; 0: the scene's [Hz] */
  const char* const* other_devices; /* of the second hand and all after it; NULL: the scene's */
  size_t other_device_count;
} tactum_scene_options;

/** What a device measures in a frame. */
typedef struct tactum_sample {
  size_t struct_size;
  tactum_pose X_DH;     /* the handle in the device's frame [m] */
  tactum_twist V_DH;    /* of the handle, axes of D [m/s, rad/s] */
  int32_t has_velocity; /* V_DH was measured; else the frame estimates it */
  uint32_t buttons;     /* bit 0 is the primary button */
  int32_t motors_off;   /* the device does not push */
  int32_t invalid;      /* the read has failed: no force is sent */
} tactum_sample;

/** What has come out of a frame; what belongs to a hand is that of the first. */
typedef struct tactum_frame {
  size_t struct_size;
  uint64_t index;    /* of the frame, from 0 */
  double time_s;     /* at which it began [s] */
  tactum_wrench F_D; /* on the hand, at the handle, axes of D: what a device is sent [N, N m] */
  tactum_wrench F_W; /* the contact forces on the grasped part, at its centre of mass, axes of W [N, N m] */
  tactum_pose X_WH;  /* the hand in the world [m] */
  tactum_pose X_WH_proxy; /* the handle of the grasped part, which penetrates nothing [m] */
  int32_t grasped_body;   /* -1: none */
  int32_t contacts;       /* how many tactum_contacts gives */
  uint32_t flags;         /* limits that the frame ran into; 0: none (docs/report-fields.md) */
  uint32_t safety;        /* why the wrench was changed or withheld; 0: it was not (docs/safety.md) */
  double min_distance_m;  /* of the pairs in contact; 0 without contact [m] */
  int32_t penetrating;    /* some pair overlaps: never in the constraint response */
  int32_t reserved;       /* 0 */
} tactum_frame;

/** A contact point, whether it pushes or not. A and B are bodies; the normal points from B to A. */
typedef struct tactum_contact {
  size_t struct_size;
  int32_t body_a, body_b;
  int32_t piece_a, piece_b;     /* of the bodies' parts */
  int32_t kind_a, kind_b;       /* 0 vertex, 1 edge, 2 face */
  int32_t feature_a, feature_b; /* number of it in its piece; -1: none */
  double p_W[3];                /* [m] */
  double n_BA_W[3];             /* unit [-] */
  double distance_m;            /* signed, at the start of the frame [m] */
  double normal_force_N;        /* along n on A, its opposite on B [N] */
  double friction_N;            /* along the surfaces, of all points on them together [N] */
  double friction_coefficient;  /* [-] */
  double cone_used;             /* of the surfaces' friction cone; 1: slips [-] */
  int32_t grip;                 /* 0 no friction, 1 sticks, 2 slips */
  int32_t patch;                /* points of one patch have one number */
  double residual_m;            /* by how much the frame has missed what the contact asks; NaN: penalty [m] */
} tactum_contact;

typedef struct tactum_body {
  size_t struct_size;
  tactum_pose X_WP;  /* of the part's file: where to draw its mesh [m] */
  tactum_pose X_WB;  /* of the centre of mass [m] */
  tactum_twist V_WB; /* of the centre of mass, axes of W [m/s, rad/s] */
  double mass_kg;    /* [kg] */
  int32_t moves;     /* 0: it is fixed */
  int32_t reserved;  /* 0 */
} tactum_body;

/** What a frame has given one hand. */
typedef struct tactum_hand {
  size_t struct_size;
  tactum_wrench F_D;      /* as tactum_frame has it [N, N m] */
  tactum_wrench F_W;      /* [N, N m] */
  tactum_pose X_WH;       /* [m] */
  tactum_pose X_WH_proxy; /* [m] */
  int32_t grasped_body;   /* -1: none */
  uint32_t safety;
} tactum_hand;

/** Opens a scene by its name (`tactum scenes`) or from a scene file. Options may be NULL. Slow. Close it with
 * tactum_close_scene. */
TACTUM_C_API tactum_status tactum_open_scene(const char* name_or_file, const tactum_scene_options* options,
                                             tactum_simulation** scene);
/** The same from the text of a scene file; meshes are searched in `folder`, which may be NULL. */
TACTUM_C_API tactum_status tactum_open_scene_text(const char* toml, const char* folder,
                                                  const tactum_scene_options* options,
                                                  tactum_simulation** scene);
/** NULL is allowed. */
TACTUM_C_API void tactum_close_scene(tactum_simulation* scene);

/** One frame with the hand at X_DH, 1 / rate_Hz after the last; `frame` may be NULL. The first pose is where
 * the hand takes hold: the scene's part stays where it is. Allocates nothing, locks nothing and reads no
 * clock; the same poses give the same bits. Of a pose that is none, no force comes, and the frame's `safety`
 * says so. */
TACTUM_C_API tactum_status tactum_step_pose(tactum_simulation* scene, const tactum_pose* X_DH,
                                            tactum_frame* frame);
/** The same with all that a device measures. */
TACTUM_C_API tactum_status tactum_step_sample(tactum_simulation* scene, const tactum_sample* sample,
                                              tactum_frame* frame);
/** How many hands the scene has; 0 for a null scene. */
TACTUM_C_API int32_t tactum_hand_count(const tactum_simulation* scene);
/** The same of a scene with any number of hands: a sample for each of them, in the order of the scene's tools,
 * each of `sample_size` = sizeof(tactum_sample) bytes. F_D takes the wrench on each hand, and may be NULL. */
TACTUM_C_API tactum_status tactum_step_hands(tactum_simulation* scene, size_t sample_size,
                                             const tactum_sample* samples, size_t hands, tactum_wrench* F_D,
                                             tactum_frame* frame);
/** Of the last frame, of one hand, counted from 0. */
TACTUM_C_API tactum_status tactum_get_hand(const tactum_simulation* scene, int32_t hand, tactum_hand* out);
/** Frame after frame, [s]. */
TACTUM_C_API double tactum_frame_step(const tactum_simulation* scene);
/** The hash of all frames so far: the same run has the same, on every machine, and so does `tactum feel
 * --json`. */
TACTUM_C_API uint64_t tactum_run_hash(const tactum_simulation* scene);

/** Writes the first `room` contacts of the last frame, each of `contact_size` = sizeof(tactum_contact) bytes,
 * and how many there are to `count`; either pointer may be NULL. */
TACTUM_C_API tactum_status tactum_contacts(tactum_simulation* scene, size_t contact_size,
                                           tactum_contact* contacts, size_t room, size_t* count);
TACTUM_C_API int32_t tactum_body_count(const tactum_simulation* scene);
/** "" where there is no such body. Lives as long as the scene. */
TACTUM_C_API const char* tactum_body_name(const tactum_simulation* scene, int32_t body);
TACTUM_C_API tactum_status tactum_get_body(const tactum_simulation* scene, int32_t body, tactum_body* out);
/** Its mesh in B, to be drawn at X_WB. Lives as long as the scene. */
TACTUM_C_API tactum_status tactum_body_mesh(const tactum_simulation* scene, int32_t body,
                                            tactum_mesh_view* view);

/* ---- The hands of a scene: the devices of its options, simulated or real. ---- */

/** Opens the device, or those of all hands: switches the motors of a real one on. Where it is simulated, its
 * hand moves as the scene says. */
TACTUM_C_API tactum_status tactum_open_hand(tactum_simulation* scene);
/** What it measures now, for tactum_step_sample. A simulated one goes on to the time of the next frame. */
TACTUM_C_API tactum_status tactum_read_hand(tactum_simulation* scene, tactum_sample* sample);
/** Sets the wrench on the hand, of tactum_frame::F_D. */
TACTUM_C_API tactum_status tactum_write_hand(tactum_simulation* scene, const tactum_wrench* F_D);
/** The same of one of several hands, counted from 0: all of them are read before each step. */
TACTUM_C_API tactum_status tactum_read_hand_of(tactum_simulation* scene, int32_t hand, tactum_sample* sample);
TACTUM_C_API tactum_status tactum_write_hand_of(tactum_simulation* scene, int32_t hand,
                                                const tactum_wrench* F_D);
/** Zero wrench, then releases the device of each hand; tactum_close_scene does it too. */
TACTUM_C_API void tactum_close_hand(tactum_simulation* scene);
/** How many frames the motion of its first simulated hand lasts; 0: the scene has none. */
TACTUM_C_API uint64_t tactum_hand_frames(const tactum_simulation* scene);

/* ---- Worlds, put together call by call. ---- */

typedef struct tactum_world tactum_world;

typedef enum tactum_joint_kind {
  TACTUM_JOINT_FREE = 0,
  TACTUM_JOINT_FIXED = 1,  /* never moves, or rides on the body it is joined to */
  TACTUM_JOINT_HINGE = 2,  /* turns about an axis through a point */
  TACTUM_JOINT_SLIDER = 3, /* slides along an axis, without turning */
  TACTUM_JOINT_BALL = 4    /* turns about a point */
} tactum_joint_kind;

/** Its position is how far the body has come from its pose at the start. Numbers are torques for a hinge or
 * ball, forces for a slider. */
typedef struct tactum_joint {
  size_t struct_size;
  int32_t kind;       /* tactum_joint_kind */
  int32_t has_limits; /* `lower` and `upper` hold; -INFINITY and INFINITY are none */
  double axis_W[3];   /* of a hinge or slider, of any length, as it stands at the start; zero: z [-] */
  double anchor_W[3]; /* a point of a hinge's axis, a ball's centre, at the start [m] */
  double damping;     /* viscous [N m s/rad or N s/m] */
  double friction;    /* largest dry friction of a hinge or slider [N m or N] */
  double stiffness;   /* of the spring of a hinge or slider [N m/rad or N/m] */
  double rest;        /* the position at which its spring is at rest [rad or m] */
  double lower;       /* least position of a hinge or slider [rad or m] */
  double upper;       /* largest position [rad or m] */
} tactum_joint;

typedef struct tactum_body_options {
  size_t struct_size;
  const char* name;          /* one that no other body of the world has; NULL: none */
  const char* material;      /* by which bodies get friction and restitution; NULL: none */
  const tactum_joint* joint; /* to the world; NULL: the body is free */
  double mass_kg;            /* 0: by the density [kg] */
  double density_kg_per_m3;  /* 0: that of the part; not beside a mass [kg/m^3] */
  tactum_twist V_WB;         /* at the start, of the centre of mass, axes of W [m/s, rad/s] */
} tactum_body_options;

/** What a hand holds, and the device whose limits hold for it. */
typedef struct tactum_tool {
  size_t struct_size;
  const char* body;   /* by its name; NULL: the hand is empty */
  const char* device; /* by name as in `tactum devices`; NULL: premium-1.5-6dof, simulated */
  double p_BH[3];     /* where the hand holds it, from its centre of mass, axes of P [m] */
} tactum_tool;

/** An empty world. `gravity_W` may be NULL: none [m/s^2]. Release it with tactum_release_world. */
TACTUM_C_API tactum_status tactum_make_world(const double gravity_W[3], tactum_world** world);
/** Adds a body with the mesh of its part at X_WP. The part is copied and may be released. Options may be NULL,
 * and `body` too, which takes its number. What is refused leaves the world as it was. */
TACTUM_C_API tactum_status tactum_add_body(tactum_world* world, const tactum_part* part,
                                           const tactum_pose* X_WP, const tactum_body_options* options,
                                           int32_t* body);
/** Joins a free body to another one, both by name. The two never touch each other unless `contact` is not 0. */
TACTUM_C_API tactum_status tactum_join_bodies(tactum_world* world, const char* body, const char* parent,
                                              const tactum_joint* joint, int32_t contact);
/** Coulomb's coefficient, or that of impacts, of all bodies of two materials with each other; 0 where none is
 * given. Of one pair the last call counts. A material that no body has is refused by tactum_open_world. */
TACTUM_C_API tactum_status tactum_set_friction(tactum_world* world, const char* material_a,
                                               const char* material_b, double coefficient);
TACTUM_C_API tactum_status tactum_set_restitution(tactum_world* world, const char* material_a,
                                                  const char* material_b, double coefficient);
/** A scene of the world as it is now, with a hand for each tool, each of `tool_size` = sizeof(tactum_tool)
 * bytes; with no tools, one hand that is empty. `rate_Hz` 0: 1000 [Hz]. The world may be used again, changed
 * and released. Slow. Close the scene with tactum_close_scene. */
TACTUM_C_API tactum_status tactum_open_world(const tactum_world* world, size_t tool_size,
                                             const tactum_tool* tools, size_t tool_count, double rate_Hz,
                                             tactum_simulation** scene);
/** NULL is allowed. */
TACTUM_C_API void tactum_release_world(tactum_world* world);

/* ---- The axes of engines. Any thread. ----
 *
 *   Unity    left-handed, metres, y up:        x, y, z of the engine are x, z, y of W
 *   Unreal   left-handed, centimetres, z up:   x, y, z of the engine are x, -y, z of W
 *
 * Quaternions are x, y, z, w, as both engines have them. Torques and angular velocities turn about as
 * mirrored axes do. Unreal's forces are kg cm/s^2, its torques kg cm^2/s^2. Any pointer to an output may be
 * NULL. */

typedef enum tactum_axes { TACTUM_AXES_W = 0, TACTUM_AXES_UNITY = 1, TACTUM_AXES_UNREAL = 2 } tactum_axes;

TACTUM_C_API void tactum_point_to_engine(tactum_axes axes, const double p_W[3], double point[3]);
TACTUM_C_API void tactum_point_from_engine(tactum_axes axes, const double point[3], double p_W[3]);
TACTUM_C_API void tactum_direction_to_engine(tactum_axes axes, const double n_W[3], double direction[3]);
TACTUM_C_API void tactum_direction_from_engine(tactum_axes axes, const double direction[3], double n_W[3]);
TACTUM_C_API void tactum_pose_to_engine(tactum_axes axes, const tactum_pose* X, double position[3],
                                        double quaternion_xyzw[4]);
TACTUM_C_API void tactum_pose_from_engine(tactum_axes axes, const double position[3],
                                          const double quaternion_xyzw[4], tactum_pose* X);
TACTUM_C_API void tactum_wrench_to_engine(tactum_axes axes, const tactum_wrench* F, double force[3],
                                          double torque[3]);
TACTUM_C_API void tactum_wrench_from_engine(tactum_axes axes, const double force[3], const double torque[3],
                                            tactum_wrench* F);
/* NOLINTEND(modernize-*, readability-identifier-naming) */

#ifdef __cplusplus
}
#endif

#endif
