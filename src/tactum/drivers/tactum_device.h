/* A haptic device, or a simulator of one, that joins Tactum from another process or machine: C99, no library
 * but POSIX sockets, everything in this file. `tactum feel SCENE --device network` waits for it.
 *
 *   tactum_device_link link;
 *   tactum_device_info info = {.name = "my device", .flags = TACTUM_SENSES_ROTATION, .max_force_N = 8, ...};
 *   if (tactum_device_connect(&link, "127.0.0.1", TACTUM_DEVICE_PORT, &info, 10000) != 0) return 1;
 *   for (;;) {                                              at the rate that the device wants, 1 kHz say
 *     read the handle into `state`;
 *     if (tactum_device_send(&link, &state) != 0) break;    Tactum has said goodbye
 *     double wrench[6];
 *     tactum_device_receive(&link, wrench);                 zero when nothing came for 20 ms
 *     exert `wrench`;
 *   }
 *   tactum_device_disconnect(&link);
 *
 * Units are SI. The device frame D is x toward the operator, y to the operator's right, z up, the origin in
 * the middle of the workspace. The wrench acts on the hand, at the handle's origin, with axes of D.
 *
 * The protocol: datagrams of UDP, numbers of little-endian machines, one of the structs tactum_wire_... each.
 * The same port takes them as binary messages of a WebSocket, one each (examples/network_device.mjs).
 *
 *   device  HELLO every 100 ms ->             WELCOME          <- Tactum
 *   device  STATE at its own rate ->          COMMAND          <- Tactum, in each of its frames
 *   device  BYE ->                            BYE              <- Tactum
 *
 * A datagram whose `sequence` is not greater than the last of its kind is too late and is dropped. STATE
 * tells which COMMAND came last, and how long ago: Tactum knows the delay of the whole way by it. */
#ifndef TACTUM_DEVICE_H
#define TACTUM_DEVICE_H
#ifdef __cplusplus
#pragma GCC system_header /* it is C: no warnings about casts */
#endif

#include <arpa/inet.h>
#include <netdb.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define TACTUM_DEVICE_PORT 47320
#define TACTUM_DEVICE_MAGIC 0x44486354u /* "TcHD" */
#define TACTUM_DEVICE_VERSION 1u
#define TACTUM_DEVICE_STALE_S 0.020 /* a wrench older than this is not exerted [s] */

/* Of tactum_device_info. */
#define TACTUM_SENSES_ROTATION 1u
#define TACTUM_ACTUATES_FORCE 2u
#define TACTUM_ACTUATES_TORQUE 4u
/* Of tactum_device_state. */
#define TACTUM_HAS_VELOCITY 1u  /* `velocity` was measured or estimated by the device */
#define TACTUM_MOTORS_OFF 2u    /* the device does not push: switch, brakes, no power */
#define TACTUM_HAS_DELIVERED 4u /* `delivered` is what it exerts */

enum {
  TACTUM_WIRE_HELLO = 1,
  TACTUM_WIRE_WELCOME = 2,
  TACTUM_WIRE_STATE = 3,
  TACTUM_WIRE_COMMAND = 4,
  TACTUM_WIRE_BYE = 5
};

typedef struct tactum_device_info {
  uint32_t flags; /* TACTUM_SENSES_ROTATION, ... */
  uint32_t reserved;
  double max_force_N, max_torque_Nm;            /* the largest it may be asked for [N], [N m] */
  double stiffest_N_per_m, stiffest_Nm_per_rad; /* wall that is stable on it at 1 kHz */
  double workspace_radius_m;                    /* radius of a sphere within its workspace [m] */
  double rate_Hz;                               /* at which it sends STATE [Hz] */
  double mass_kg, inertia_kg_m2;                /* apparent at the handle; 0: unknown */
  double damping_Ns_per_m, damping_Nms_per_rad; /* 0: unknown */
  double delay_s;                               /* from a wrench that came to the motors [s] */
  char name[64], serial[32];                    /* end with a zero */
} tactum_device_info;

typedef struct tactum_device_state {
  double position[3];         /* of the handle in D [m] */
  double orientation_wxyz[4]; /* of the handle in D, a unit quaternion */
  double velocity[6];         /* of the handle's origin, and angular, axes of D [m/s, rad/s] */
  double delivered[6];        /* force and torque that it exerts on the hand [N, N m] */
  double grip_rad;            /* opening of a gripper; 0 without one [rad] */
  uint32_t buttons;           /* bit 0 is the first */
  uint32_t flags;             /* TACTUM_HAS_VELOCITY, ... */
} tactum_device_state;

typedef struct tactum_wire_header {
  uint32_t magic;
  uint16_t version, kind;
  uint32_t session; /* chosen by the device for one HELLO; Tactum answers with it */
  uint32_t sequence;
} tactum_wire_header;

typedef struct tactum_wire_hello {
  tactum_wire_header header;
  tactum_device_info info;
} tactum_wire_hello;

typedef struct tactum_wire_state {
  tactum_wire_header header;
  double time_s;          /* of the measurement, on the device's own clock [s] */
  double since_command_s; /* since `last_command` came [s] */
  uint32_t last_command;  /* its sequence; 0: none came */
  uint32_t reserved;
  tactum_device_state state;
} tactum_wire_state;

typedef struct tactum_wire_command {
  tactum_wire_header header;
  double time_s;    /* on Tactum's clock [s] */
  double wrench[6]; /* force and torque [N, N m] */
} tactum_wire_command;

typedef struct tactum_device_link {
  int socket;
  uint32_t session, sent, last_command;
  int said_goodbye;
  double command_at_s; /* when `last_command` came [s] */
  double wrench[6];
} tactum_device_link;

static inline double tactum_clock_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + (double)now.tv_nsec / 1e9;
}

static inline tactum_wire_header tactum_wire_head(tactum_device_link* link, int kind) {
  tactum_wire_header header = {TACTUM_DEVICE_MAGIC, TACTUM_DEVICE_VERSION, (uint16_t)kind, link->session,
                               ++link->sent};
  return header;
}

/* Takes every datagram that has come. */
static inline void tactum_device_drain(tactum_device_link* link, int* welcome) {
  tactum_wire_command got;
  for (;;) {
    const ssize_t size = recv(link->socket, &got, sizeof got, MSG_DONTWAIT);
    if (size < (ssize_t)sizeof got.header) return;
    if (got.header.magic != TACTUM_DEVICE_MAGIC || got.header.version != TACTUM_DEVICE_VERSION ||
        got.header.session != link->session)
      continue;
    if (got.header.kind == TACTUM_WIRE_WELCOME && welcome != NULL) *welcome = 1;
    if (got.header.kind == TACTUM_WIRE_BYE) link->said_goodbye = 1;
    if (got.header.kind != TACTUM_WIRE_COMMAND || size != (ssize_t)sizeof got ||
        got.header.sequence <= link->last_command)
      continue;
    link->last_command = got.header.sequence;
    link->command_at_s = tactum_clock_s();
    memcpy(link->wrench, got.wrench, sizeof link->wrench);
  }
}

/* Says hello until Tactum answers: 0, or -1 when it did not within `timeout_ms` or there is no such host. */
static inline int tactum_device_connect(tactum_device_link* link, const char* host, int port,
                                        const tactum_device_info* info, int timeout_ms) {
  memset(link, 0, sizeof *link);
  struct addrinfo hints, *found = NULL;
  memset(&hints, 0, sizeof hints);
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  if (getaddrinfo(host, NULL, &hints, &found) != 0) return -1;
  struct sockaddr_in address;
  memcpy(&address, found->ai_addr, sizeof address);
  freeaddrinfo(found);
  address.sin_port = htons((uint16_t)port);
  link->socket = socket(AF_INET, SOCK_DGRAM, 0);
  if (link->socket < 0) return -1;
  link->session = (uint32_t)(uint64_t)(1e6 * tactum_clock_s()) ^ ((uint32_t)getpid() << 16);
  if (connect(link->socket, (struct sockaddr*)&address, sizeof address) != 0) return close(link->socket), -1;
  const double begin_s = tactum_clock_s();
  double hello_s = begin_s - 1.0;
  int welcome = 0;
  while (!welcome && 1e3 * (tactum_clock_s() - begin_s) < timeout_ms) {
    if (tactum_clock_s() - hello_s > 0.1) {
      tactum_wire_hello hello = {tactum_wire_head(link, TACTUM_WIRE_HELLO), *info};
      (void)send(link->socket, &hello, sizeof hello, 0); /* refused while nobody listens: said again */
      hello_s = tactum_clock_s();
    }
    const struct timespec pause = {0, 1000000};
    nanosleep(&pause, NULL);
    tactum_device_drain(link, &welcome);
  }
  return welcome ? 0 : (close(link->socket), -1);
}

/* Sends what was measured now; -1 when Tactum has said goodbye. What is lost on the way is lost. */
static inline int tactum_device_send(tactum_device_link* link, const tactum_device_state* state) {
  tactum_device_drain(link, NULL);
  if (link->said_goodbye) return -1;
  tactum_wire_state out;
  memset(&out, 0, sizeof out);
  out.header = tactum_wire_head(link, TACTUM_WIRE_STATE);
  out.time_s = tactum_clock_s();
  out.last_command = link->last_command;
  out.since_command_s = link->last_command == 0 ? 0.0 : out.time_s - link->command_at_s;
  out.state = *state;
  (void)send(link->socket, &out, sizeof out, MSG_DONTWAIT);
  return 0;
}

/* The newest wrench, and 1; zero, and 0, when none came for TACTUM_DEVICE_STALE_S. */
static inline int tactum_device_receive(tactum_device_link* link, double wrench[6]) {
  tactum_device_drain(link, NULL);
  const int fresh = link->last_command != 0 && !link->said_goodbye &&
                    tactum_clock_s() - link->command_at_s <= TACTUM_DEVICE_STALE_S;
  for (int i = 0; i < 6; ++i) wrench[i] = fresh ? link->wrench[i] : 0.0;
  return fresh;
}

static inline void tactum_device_disconnect(tactum_device_link* link) {
  const tactum_wire_header bye = tactum_wire_head(link, TACTUM_WIRE_BYE);
  (void)send(link->socket, &bye, sizeof bye, MSG_DONTWAIT);
  close(link->socket);
}

#endif
