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
/// Stepped with the samples of its own hand it gives the frames of `tactum feel --virtual-clock` to the bit
/// (`record().hash()`), with the same device, grip and settings.

#include <memory>
#include <string>

#include "tactum/embedding/step_contacts.h"
#include "tactum/haptics/simulation.h"
#include "tactum/scene/scene.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

struct SteppedSceneOptions {
  std::string device = {};    ///< as in drivers/registry.h; empty: the scene's simulated preset
  std::string grip = {};      ///< of the simulated hand; empty: the scene's
  std::string response = {};  ///< constraint or penalty; empty: the scene's
  std::string settings = {};  ///< a table [settings] as text, put over the settings of the scene
  double rate_Hz = 0.0;       ///< 0: the scene's [Hz]
};

class SteppedScene {
 public:
  /// The scene of that name, or of a scene file. An error says what is wrong and where. The scene must have
  /// one hand; the device is made, not opened. Slow; allocates.
  static Result<std::unique_ptr<SteppedScene>> open(const std::string& name_or_path,
                                                    const SteppedSceneOptions& options);
  static Result<std::unique_ptr<SteppedScene>> open(SceneDescription description,
                                                    const SteppedSceneOptions& options);
  /// A world made in code; the settings are complete.
  static Result<std::unique_ptr<SteppedScene>> open(World world, const FrameSettings& settings,
                                                    std::unique_ptr<Device> device);

  /// When the next frame begins, to the bit as run_virtual() has it, which a simulated hand is read at [s].
  double next_time_s() const noexcept { return static_cast<double>(simulation_->next_index()) / rate_Hz(); }
  double rate_Hz() const noexcept { return 1.0 / simulation_->settings().dt_s; }
  /// One frame. The sample counts as measured now, whatever its time. Returns the wrench on the hand, axes of
  /// D, at the handle [N, N m].
  Wrench step(const DeviceSample& sample) noexcept;

  const std::string& name() const noexcept { return name_; }
  /// The device that the settings were made for: a hand that is read and written by the caller.
  Device& hand() noexcept { return *hand_; }
  const Device& hand() const noexcept { return *hand_; }
  const Simulation& simulation() const noexcept { return *simulation_; }
  /// Sums and hash of all frames so far.
  const RunRecord& record() const noexcept { return record_; }
  /// Frames that the scene's hand motion lasts; 0 without one.
  long frames_of_hand() const noexcept { return frames_of_hand_; }
  /// Of the last frame; made when they are asked for.
  const std::vector<StepContact>& contacts();

 private:
  SteppedScene(std::string name, std::unique_ptr<Simulation> simulation, std::unique_ptr<Device> hand)
      : name_(std::move(name)), simulation_(std::move(simulation)), hand_(std::move(hand)) {}

  std::string name_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<Device> hand_;
  long frames_of_hand_ = 0;
  RunRecord record_;
  StepContacts contacts_;
  bool contacts_known_ = false;
};

}  // namespace tactum::inline v0_1
