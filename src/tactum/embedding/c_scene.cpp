/// Scenes of the C interface: opened, stepped, and their hands.

#include <algorithm>

#include "tactum/embedding/c_handles.h"
#include "tactum/embedding/c_values.h"
#include "tactum/scene/scene_file.h"

using namespace tactum;  // the C interface stands outside the namespace
using namespace tactum::c_calls;

namespace {

tactum_status read_options(const char* call, const tactum_scene_options* given,
                           SteppedSceneOptions& options) {
  tactum_scene_options taken{};
  if (const tactum_status status = take(call, given, taken); status != TACTUM_OK) return status;
  if (taken.other_devices == nullptr && taken.other_device_count > 0)
    return bad_call(call, "a pointer is null");
  options.device = text_of(taken.device);
  for (size_t i = 0; i < taken.other_device_count; ++i)
    options.other_devices.push_back(text_of(taken.other_devices[i]));
  options.grip = text_of(taken.grip);
  options.response = text_of(taken.response);
  options.settings = text_of(taken.settings);
  options.rate_Hz = taken.rate_Hz;
  return TACTUM_OK;
}

void fill_frame(const SteppedScene& scene, const Wrench& F_D, tactum_frame* frame) noexcept {
  const FrameReport& report = scene.simulation().report();
  tactum_frame out{};
  out.index = report.index;
  out.time_s = static_cast<double>(report.index) / scene.rate_Hz();
  out.F_D = c_wrench(F_D);
  out.F_W = c_wrench(report.restoring);
  out.X_WH = c_pose(report.X_WH);
  out.X_WH_proxy = c_pose(report.X_WH_proxy);
  out.grasped_body = report.grasped_body;
  out.contacts = static_cast<int32_t>(scene.simulation().state().response.rows().size());
  out.flags = report.flags;
  out.safety = report.safety;
  out.min_distance_m = report.min_distance_m;
  out.penetrating = report.penetrating ? 1 : 0;
  give(out, frame);
}

/// Steps with the samples of all hands, which stand in the scene.
tactum_status step_checked(const char* call, tactum_simulation* scene, tactum_frame* frame) noexcept {
  if (frame != nullptr)
    if (const tactum_status status = check_room(call, frame); status != TACTUM_OK) return status;
  scene->scene->step(scene->samples, scene->F_D);
  if (frame != nullptr) fill_frame(*scene->scene, scene->F_D.front(), frame);
  return TACTUM_OK;
}

/// Of a call for a scene with one hand.
tactum_status check_one_hand(const char* call, const tactum_simulation* scene) noexcept {
  if (scene->scene->hands() == 1) return TACTUM_OK;
  return bad_call(call, "the scene has several hands, which tactum_step_hands takes");
}

tactum_status check_hand(const char* call, const tactum_simulation* scene, int32_t hand) noexcept {
  if (scene == nullptr) return bad_call(call, "the scene is null");
  const bool there = hand >= 0 && static_cast<size_t>(hand) < scene->scene->hands();
  return there ? TACTUM_OK : bad_call(call, "there is no hand of this number");
}

tactum_status take_sample(const char* call, const tactum_sample* sample, HandSample& read) noexcept {
  tactum_sample taken{};
  if (const tactum_status status = take(call, sample, taken); status != TACTUM_OK) return status;
  read = {};
  read.X_DH = pose_of(taken.X_DH);
  read.V_DH = twist_of(taken.V_DH);
  read.has_velocity = taken.has_velocity != 0;
  read.buttons = taken.buttons;
  read.motors_on = taken.motors_off == 0;
  read.valid = taken.invalid == 0;
  return TACTUM_OK;
}

tactum_contact c_contact(const StepContact& contact) {
  tactum_contact out{};
  out.body_a = contact.body_a;
  out.body_b = contact.body_b;
  out.piece_a = contact.piece_a;
  out.piece_b = contact.piece_b;
  out.kind_a = static_cast<int32_t>(contact.a.kind);
  out.kind_b = static_cast<int32_t>(contact.b.kind);
  out.feature_a = contact.a.index;
  out.feature_b = contact.b.index;
  put(contact.p_W, out.p_W);
  put(contact.n_W, out.n_BA_W);
  out.distance_m = contact.distance_m;
  out.normal_force_N = contact.force_N;
  out.friction_N = contact.friction_N;
  out.friction_coefficient = contact.friction_coefficient;
  out.cone_used = contact.cone_used;
  out.grip = static_cast<int32_t>(contact.grip);
  out.patch = contact.patch;
  out.residual_m = contact.residual_m;
  return out;
}

/// The body, or null after a bad call was noted.
const Body* body_of(const char* call, const tactum_simulation* scene, int32_t body) noexcept {
  if (scene == nullptr) {
    bad_call(call, "the scene is null");
    return nullptr;
  }
  const std::vector<Body>& bodies = scene->scene->simulation().world().bodies;
  if (body >= 0 && static_cast<std::size_t>(body) < bodies.size())
    return &bodies[static_cast<std::size_t>(body)];
  bad_call(call, "there is no body of this number");
  return nullptr;
}

}  // namespace

tactum_status tactum_open_scene(const char* name_or_file, const tactum_scene_options* options,
                                tactum_simulation** scene) {
  return guarded([&] {
    if (name_or_file == nullptr || scene == nullptr)
      return bad_call("tactum_open_scene", "a pointer is null");
    SteppedSceneOptions taken;
    if (const tactum_status status = read_options("tactum_open_scene", options, taken); status != TACTUM_OK)
      return status;
    return hand_over_scene(SteppedScene::open(std::string(name_or_file), taken), scene);
  });
}

tactum_status tactum_open_scene_text(const char* toml, const char* folder,
                                     const tactum_scene_options* options, tactum_simulation** scene) {
  return guarded([&] {
    if (toml == nullptr || scene == nullptr) return bad_call("tactum_open_scene_text", "a pointer is null");
    SteppedSceneOptions taken;
    if (const tactum_status status = read_options("tactum_open_scene_text", options, taken);
        status != TACTUM_OK)
      return status;
    std::vector<std::string> folders = data_folders();
    if (folder != nullptr) folders.insert(folders.begin(), folder);
    Result<SceneDescription> description = parse_description(toml, "scene", "the scene's text", folders);
    if (!description) return refuse(description.error());
    return hand_over_scene(SteppedScene::open(std::move(*description), taken), scene);
  });
}

void tactum_close_scene(tactum_simulation* scene) {
  tactum_close_hand(scene);
  delete scene;
}

tactum_status tactum_step_pose(tactum_simulation* scene, const tactum_pose* X_DH, tactum_frame* frame) {
  if (scene == nullptr || X_DH == nullptr) return bad_call("tactum_step_pose", "a pointer is null");
  if (const tactum_status status = check_one_hand("tactum_step_pose", scene); status != TACTUM_OK)
    return status;
  scene->samples.front() = {};
  scene->samples.front().valid = true;
  scene->samples.front().X_DH = pose_of(*X_DH);
  return step_checked("tactum_step_pose", scene, frame);
}

tactum_status tactum_step_sample(tactum_simulation* scene, const tactum_sample* sample, tactum_frame* frame) {
  if (scene == nullptr || sample == nullptr) return bad_call("tactum_step_sample", "a pointer is null");
  if (const tactum_status status = check_one_hand("tactum_step_sample", scene); status != TACTUM_OK)
    return status;
  if (const tactum_status status = take_sample("tactum_step_sample", sample, scene->samples.front());
      status != TACTUM_OK)
    return status;
  return step_checked("tactum_step_sample", scene, frame);
}

int32_t tactum_hand_count(const tactum_simulation* scene) {
  return scene == nullptr ? 0 : static_cast<int32_t>(scene->scene->hands());
}

tactum_status tactum_step_hands(tactum_simulation* scene, size_t sample_size, const tactum_sample* samples,
                                size_t hands, tactum_wrench* F_D, tactum_frame* frame) {
  if (scene == nullptr || samples == nullptr) return bad_call("tactum_step_hands", "a pointer is null");
  if (sample_size < first_size<tactum_sample>())
    return bad_call("tactum_step_hands", "sample_size is not that of the struct");
  if (hands != scene->samples.size())
    return bad_call("tactum_step_hands", "there is another number of samples than of hands");
  const auto* bytes = reinterpret_cast<const unsigned char*>(samples);
  for (size_t h = 0; h < hands; ++h) {
    const auto* sample = reinterpret_cast<const tactum_sample*>(bytes + h * sample_size);
    if (const tactum_status status = take_sample("tactum_step_hands", sample, scene->samples[h]);
        status != TACTUM_OK)
      return status;
  }
  if (const tactum_status status = step_checked("tactum_step_hands", scene, frame); status != TACTUM_OK)
    return status;
  if (F_D != nullptr) std::transform(scene->F_D.begin(), scene->F_D.end(), F_D, &c_wrench);
  return TACTUM_OK;
}

tactum_status tactum_get_hand(const tactum_simulation* scene, int32_t hand, tactum_hand* out) {
  if (const tactum_status status = check_hand("tactum_get_hand", scene, hand); status != TACTUM_OK)
    return status;
  if (const tactum_status status = check_room("tactum_get_hand", out); status != TACTUM_OK) return status;
  const Simulation& simulation = scene->scene->simulation();
  const auto h = static_cast<size_t>(hand);
  const HandReport& report = h == 0 ? simulation.report() : simulation.state().other_reports[h - 1];
  tactum_hand full{};
  full.F_D = c_wrench(scene->F_D[h]);
  full.F_W = c_wrench(report.restoring);
  full.X_WH = c_pose(report.X_WH);
  full.X_WH_proxy = c_pose(report.X_WH_proxy);
  full.grasped_body = report.grasped_body;
  full.safety = report.safety;
  give(full, out);
  return TACTUM_OK;
}

double tactum_frame_step(const tactum_simulation* scene) {
  return scene == nullptr ? 0.0 : scene->scene->simulation().settings().dt_s;
}

uint64_t tactum_run_hash(const tactum_simulation* scene) {
  return scene == nullptr ? 0 : scene->scene->record().hash();
}

tactum_status tactum_contacts(tactum_simulation* scene, size_t contact_size, tactum_contact* contacts,
                              size_t room, size_t* count) {
  return guarded([&] {
    if (scene == nullptr) return bad_call("tactum_contacts", "the scene is null");
    if (contact_size < first_size<tactum_contact>())
      return bad_call("tactum_contacts", "contact_size is not that of the struct");
    const std::vector<StepContact>& all = scene->scene->contacts();
    if (count != nullptr) *count = all.size();
    auto* out = reinterpret_cast<unsigned char*>(contacts);
    for (size_t i = 0; contacts != nullptr && i < std::min(room, all.size()); ++i) {
      auto* one = reinterpret_cast<tactum_contact*>(out + i * contact_size);
      one->struct_size = contact_size;
      give(c_contact(all[i]), one);
    }
    return TACTUM_OK;
  });
}

int32_t tactum_body_count(const tactum_simulation* scene) {
  return scene == nullptr ? 0 : static_cast<int32_t>(scene->scene->simulation().world().bodies.size());
}

const char* tactum_body_name(const tactum_simulation* scene, int32_t body) {
  const Body* found = body_of("tactum_body_name", scene, body);
  return found == nullptr ? "" : found->name.c_str();
}

tactum_status tactum_get_body(const tactum_simulation* scene, int32_t body, tactum_body* out) {
  const Body* found = body_of("tactum_get_body", scene, body);
  if (found == nullptr) return TACTUM_BAD_CALL;
  if (const tactum_status status = check_room("tactum_get_body", out); status != TACTUM_OK) return status;
  const WorldState& bodies = scene->scene->simulation().bodies();
  const Pose& X_WB = bodies.X_WB[static_cast<std::size_t>(body)];
  tactum_body full{};
  full.X_WP = c_pose(part_pose(*found, X_WB));
  full.X_WB = c_pose(X_WB);
  full.V_WB = c_twist(bodies.V_WB[static_cast<std::size_t>(body)]);
  full.mass_kg = found->mass_kg;
  full.moves = found->moves() ? 1 : 0;
  give(full, out);
  return TACTUM_OK;
}

tactum_status tactum_body_mesh(const tactum_simulation* scene, int32_t body, tactum_mesh_view* view) {
  const Body* found = body_of("tactum_body_mesh", scene, body);
  if (found == nullptr) return TACTUM_BAD_CALL;
  if (const tactum_status status = check_room("tactum_body_mesh", view); status != TACTUM_OK) return status;
  give(c_mesh(found->part->surface), view);
  return TACTUM_OK;
}

tactum_status tactum_open_hand(tactum_simulation* scene) {
  return guarded([&] {
    if (scene == nullptr) return bad_call("tactum_open_hand", "the scene is null");
    if (scene->hand_is_open) return TACTUM_OK;
    const Result<void> opened = scene->scene->devices().open();
    if (!opened) return refuse(opened.error());
    scene->hand_is_open = true;
    return TACTUM_OK;
  });
}

tactum_status tactum_read_hand(tactum_simulation* scene, tactum_sample* sample) {
  return tactum_read_hand_of(scene, 0, sample);
}

tactum_status tactum_read_hand_of(tactum_simulation* scene, int32_t hand, tactum_sample* sample) {
  if (scene == nullptr || !scene->hand_is_open) return bad_call("tactum_read_hand", "the hand is not open");
  if (const tactum_status status = check_hand("tactum_read_hand", scene, hand); status != TACTUM_OK)
    return status;
  if (const tactum_status status = check_room("tactum_read_hand", sample); status != TACTUM_OK) return status;
  DeviceSample read;
  const double now_s = scene->scene->next_time_s();
  if (!scene->scene->hand(static_cast<size_t>(hand)).read(now_s, read)) read.valid = false;
  tactum_sample out{};
  out.X_DH = c_pose(read.X_DH);
  out.V_DH = c_twist(read.V_DH);
  out.has_velocity = read.has_velocity ? 1 : 0;
  out.buttons = read.buttons;
  out.motors_off = read.motors_on ? 0 : 1;
  out.invalid = read.valid ? 0 : 1;
  give(out, sample);
  return TACTUM_OK;
}

tactum_status tactum_write_hand(tactum_simulation* scene, const tactum_wrench* F_D) {
  return tactum_write_hand_of(scene, 0, F_D);
}

tactum_status tactum_write_hand_of(tactum_simulation* scene, int32_t hand, const tactum_wrench* F_D) {
  if (scene == nullptr || F_D == nullptr || !scene->hand_is_open)
    return bad_call("tactum_write_hand", "a pointer is null or the hand is not open");
  if (const tactum_status status = check_hand("tactum_write_hand", scene, hand); status != TACTUM_OK)
    return status;
  if (scene->scene->hand(static_cast<size_t>(hand)).write(wrench_of(*F_D))) return TACTUM_OK;
  return say(TACTUM_REFUSED, "the device did not take the wrench");
}

void tactum_close_hand(tactum_simulation* scene) {
  if (scene == nullptr || !scene->hand_is_open) return;
  scene->scene->devices().write({});
  scene->scene->devices().close();
  scene->hand_is_open = false;
}

uint64_t tactum_hand_frames(const tactum_simulation* scene) {
  return scene == nullptr ? 0 : static_cast<uint64_t>(scene->scene->frames_of_hand());
}
