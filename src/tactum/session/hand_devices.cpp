#include "tactum/session/hand_devices.h"

#include <algorithm>
#include <utility>

namespace tactum::inline v0_1 {

HandDevices::HandDevices(std::vector<std::unique_ptr<Device>> devices)
    : devices_(std::move(devices)), samples_(devices_.size()), wrenches_(devices_.size()) {}

Result<void> HandDevices::open() {
  for (std::size_t h = 0; h < devices_.size(); ++h) {
    Result<void> opened = devices_[h]->open();
    if (opened) continue;
    while (h > 0) devices_[--h]->close();
    return opened;
  }
  return {};
}

void HandDevices::close() noexcept {
  for (const std::unique_ptr<Device>& device : devices_) device->close();
}

bool HandDevices::read(double now_s, DeviceSample& sample) noexcept {
  bool some = false;
  for (std::size_t h = 0; h < devices_.size(); ++h) some |= devices_[h]->read(now_s, samples_[h]);
  sample = samples_.front();
  return some;
}

bool HandDevices::write(const Wrench& F_D) noexcept {
  if (is_zero(F_D)) std::fill(wrenches_.begin(), wrenches_.end(), Wrench{});
  bool some = false;
  for (std::size_t h = 0; h < devices_.size(); ++h) {
    samples_[h].refused = !devices_[h]->write(wrenches_[h]);
    some |= !samples_[h].refused;
  }
  return some;
}

std::string HandDevices::trouble() const {
  std::string all;
  for (const std::unique_ptr<Device>& device : devices_) {
    const std::string one = device->trouble();
    if (!one.empty()) all += (all.empty() ? "" : "; ") + one;
  }
  return all;
}

Wrench HandDevices::largest() const noexcept {
  const auto size = [](const Wrench& F) { return std::pair(F.f.squaredNorm(), F.t.squaredNorm()); };
  return *std::max_element(wrenches_.begin(), wrenches_.end(),
                           [&](const Wrench& a, const Wrench& b) { return size(a) < size(b); });
}

}  // namespace tactum::inline v0_1
