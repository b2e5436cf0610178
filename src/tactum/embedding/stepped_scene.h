#pragma once
/// A scene that its caller steps, frame by frame: what `tactum feel` runs, without a loop of its own.
///
///   auto scene = SteppedScene::open("gears", {});
///   Device& hand = (*scene)->hand();                         the one the command would run it on
///   hand.open();
///   for (...) {
///     hand.read((*scene)->next_time_s(), sample);    or a pose of the caller's own
///     hand.write((*scene)->step(sample));
///   }
///
/// Stepped with the samples of its own hands it gives the frames of `tactum feel --virtual-clock` to the bit
/// (`record().hash()`), with the same devices, grip and settings. Where the scene has several hands, a step
/// takes a sample and gives a wrench for each of them, in the order of the scene's tools.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tactum/embedding/step_contacts.h"
#include "tactum/haptics/simulation.h"
#include "tactum/scene/scene.h"
#include "tactum/scene/scene_description.h"
#include "tactum/session/hand_devices.h"

namespace tactum::inline v0_1 {

struct SteppedSceneOptions {
  std::string device = {};  ///< as in drivers/registry.h; empty: the scene's simulated preset
  /// The same of the second hand and all after it; those that are missing count as empty.
  std::vector<std::string> other_devices = {};
  std::string grip = {};      ///< of the simulated hand; empty: the scene's
  std::string response = {};  ///< constraint or penalty; empty: the scene's
  std::string settings = {};  ///< a table [settings] as text, put over the settings of the scene
  double rate_Hz = 0.0;       ///< 0: the scene's [Hz]
};

class SteppedScene {
 public:
  /// The scene of that name, or of a scene file. An error says what is wrong and where. The devices of its
  /// hands are made, not opened. Slow; allocates.
  static Result<std::unique_ptr<SteppedScene>> open(const std::string& name_or_path,
                                                    const SteppedSceneOptions& options);
  static Result<std::unique_ptr<SteppedScene>> open(SceneDescription description,
                                                    const SteppedSceneOptions& options);
  /// A world made in code; the settings are complete, and there is a device for each of their hands.
  static Result<std::unique_ptr<SteppedScene>> open(World world, const FrameSettings& settings,
                                                    std::vector<std::unique_ptr<Device>> devices);

  /// When the next frame begins, to the bit as run_virtual() has it, which a simulated hand is read at [s].
  double next_time_s() const noexcept { return static_cast<double>(simulation_->next_index()) / rate_Hz(); }
  double rate_Hz() const noexcept { return 1.0 / simulation_->settings().dt_s; }
  std::size_t hands() const noexcept { return hands_.hands(); }
  /// One frame of a scene with one hand. The sample counts as measured now, whatever its time. Returns the
  /// wrench on the hand, axes of D, at the handle [N, N m].
  Wrench step(const DeviceSample& sample) noexcept;
  /// The same of any number of hands: a sample and a wrench for each of them.
  void step(std::span<const HandSample> samples, std::span<Wrench> F_D) noexcept;

  const std::string& name() const noexcept { return name_; }
  /// The device that the settings of a hand, counted from 0, were made for. The caller reads and writes it.
  Device& hand(std::size_t number = 0) noexcept { return hands_.device(number); }
  const Device& hand(std::size_t number = 0) const noexcept { return hands_.device(number); }
  /// All of them as one device, which keeps the samples and takes the wrenches of each hand.
  HandDevices& devices() noexcept { return hands_; }
  const Simulation& simulation() const noexcept { return *simulation_; }
  /// Sums and hash of all frames so far.
  const RunRecord& record() const noexcept { return record_; }
  /// Frames that the motion of the scene's first hand lasts; 0 without one.
  long frames_of_hand() const noexcept { return frames_of_hand_; }
  /// Of the last frame; made when they are asked for.
  const std::vector<StepContact>& contacts();

 private:
  SteppedScene(std::unique_ptr<Simulation> simulation, std::vector<std::unique_ptr<Device>> devices)
      : simulation_(std::move(simulation)),
        hands_(std::move(devices)),
        now_(hands_.hands()),
        record_(hands_.hands()) {}

  std::string name_ = "world";
  std::unique_ptr<Simulation> simulation_;
  HandDevices hands_;
  std::vector<HandSample> now_;  // of the frame that is stepped, by hand
  long frames_of_hand_ = 0;
  RunRecord record_;
  StepContacts contacts_;
  bool contacts_known_ = false;
};

}  // namespace tactum::inline v0_1
