#include "app/hdf5/export_hdf5.h"

#include <algorithm>
#include <array>
#include <optional>

#include "app/hdf5/h5_file.h"
#include "tactum/recording/frame_numbers.h"
#include "tactum/recording/recording_visitor.h"

namespace tactum {
namespace {

constexpr const char* kLegend =
    "Numbers are SI. W is the world, D the frame of the device; wrenches act on the hand at the handle, "
    "those "
    "of restoring_ and field_ at the centre of mass of the held part. Columns of /frame, /input: one row a "
    "frame; of /contacts: one row a contact point, whose column frame is its row in /frame. Every column has "
    "the attributes unit, axes and meaning.";

/// A column with its attributes; `unit` "1" where it has none.
template <class T>
H5Column<T> described(H5File& file, const std::string& name, const std::string& unit, const std::string& axes,
                      const std::string& meaning, std::size_t width = 1) {
  H5Column<T> column(file, name, width);
  file.attribute(name, "unit", unit);
  file.attribute(name, "axes", axes);
  file.attribute(name, "meaning", meaning);
  return column;
}

/// What came in from a device, of every frame, as columns of a group.
class SampleColumns {
 public:
  SampleColumns(H5File& file, const std::string& group)
      : measured_(described<double>(file, group + "/sample_time_s", "s", "none",
                                    "when the device's sample was measured, the loop's clock")),
        p_(described<double>(file, group + "/p_DH_m", "m", "D", "the handle", 3)),
        R_(described<double>(file, group + "/R_DH", "1", "D", "its axes as columns of a matrix, row by row",
                             9)),
        v_(described<double>(file, group + "/v_DH_m_per_s", "m/s", "D", "velocity of the handle", 3)),
        w_(described<double>(file, group + "/w_DH_rad_per_s", "rad/s", "D", "its angular velocity", 3)),
        buttons_(
            described<std::uint64_t>(file, group + "/buttons", "1", "none", "bit 0 is the primary button")),
        valid_(described<std::uint8_t>(file, group + "/valid", "1", "none", "1 where the read succeeded")) {}

  void add(const DeviceSample& sample) {
    measured_.add(sample.time_s);
    for (int i = 0; i < 3; ++i) {
      p_.add(sample.X_DH.p[i]);
      v_.add(sample.V_DH.v[i]);
      w_.add(sample.V_DH.w[i]);
      for (int j = 0; j < 3; ++j) R_.add(sample.X_DH.R(i, j));
    }
    buttons_.add(sample.buttons);
    valid_.add(sample.valid ? 1 : 0);
  }

 private:
  H5Column<double> measured_, p_, R_, v_, w_;
  H5Column<std::uint64_t> buttons_;
  H5Column<std::uint8_t> valid_;
};

/// The same of the first hand's device, and what the loop adds.
class InputColumns {
 public:
  explicit InputColumns(H5File& file)
      : index_(described<std::uint64_t>(file, "input/index", "1", "none", "frames since the start")),
        hash_(described<std::uint64_t>(file, "input/state_hash", "1", "none",
                                       "hash of the state that the frame left")),
        now_(described<double>(file, "input/now_s", "s", "none", "the loop's clock at the frame")),
        late_(described<std::uint8_t>(file, "input/late", "1", "none", "1 where the frame came too late")),
        sample_(file, "input") {}

  void add(const RecordedInput& input) {
    index_.add(input.tick.index);
    hash_.add(input.hash);
    now_.add(input.tick.now_s);
    late_.add(input.tick.late ? 1 : 0);
    sample_.add(input.sample);
  }

 private:
  H5Column<std::uint64_t> index_, hash_;
  H5Column<double> now_;
  H5Column<std::uint8_t> late_;
  SampleColumns sample_;
};

class ContactColumns {
 public:
  explicit ContactColumns(H5File& file)
      : frame_(described<std::uint64_t>(file, "contacts/frame", "1", "none", "row of the frame in /frame")),
        a_(described<std::int32_t>(file, "contacts/body_a", "1", "none",
                                   "the body on which the force acts, a place in the attribute bodies")),
        b_(described<std::int32_t>(file, "contacts/body_b", "1", "none", "the body that pushes it")),
        grip_(
            described<std::int32_t>(file, "contacts/grip", "1", "none", "0 no friction, 1 sticks, 2 slips")),
        p_(described<double>(file, "contacts/p_W_m", "m", "W", "the contact point", 3)),
        n_(described<double>(file, "contacts/n_BA_W", "1", "W", "unit normal from B to A", 3)),
        distance_(described<double>(file, "contacts/distance_m", "m", "none",
                                    "signed distance of the surfaces; negative is overlap")),
        force_(described<double>(file, "contacts/force_N", "N", "none", "force on A along the normal")),
        cone_(described<double>(file, "contacts/cone_used", "1", "none",
                                "the part of the friction cone in use")) {}

  void add(std::uint64_t row, const ShownContact& contact) {
    frame_.add(row);
    a_.add(contact.body_a);
    b_.add(contact.body_b);
    grip_.add(static_cast<std::int32_t>(contact.grip));
    for (int i = 0; i < 3; ++i) {
      p_.add(contact.p_W[i]);
      n_.add(contact.n_W[i]);
    }
    distance_.add(contact.distance_m);
    force_.add(contact.force_N);
    cone_.add(contact.cone_used);
  }

 private:
  H5Column<std::uint64_t> frame_;
  H5Column<std::int32_t> a_, b_, grip_;
  H5Column<double> p_, n_, distance_, force_, cone_;
};

void describe_run(H5File& file, const RunHead& head) {
  for (const char* group : {"frame", "input", "contacts", "settings", "files"}) file.group(group);
  file.attribute("/", "format", std::string("tactum recording"));
  file.attribute("/", "format_version", 1.0);
  file.attribute("/", "legend", std::string(kLegend));
  file.attribute("/", "tactum_version", head.version);
  file.attribute("/", "compiler", head.compiler);
  file.attribute("/", "date", head.date);
  file.attribute("/", "scene", head.scene);
  file.attribute("/", "device", head.device.name);
  file.attribute("/", "rate_Hz", 1.0 / head.dt_s);
  file.attribute("/", "bodies", head.bodies);
  for (const auto& [key, value] : head.settings) file.attribute("settings", key, value);
}

/// The name of a column of a further hand as that of the first: without "h2_".
std::string without_hand(const std::string& name) {
  const std::size_t digits = name.starts_with('h') ? name.find_first_not_of("0123456789", 1) : 0;
  return digits > 1 && digits < name.size() && name[digits] == '_' ? name.substr(digits + 1) : name;
}

class Hdf5Writing final : public RecordingVisitor {
 public:
  Hdf5Writing(const std::string& name, H5File& file) : RecordingVisitor(name), file_(file) {}
  std::uint64_t rows = 0;

  /// Writes what is gathered; the columns are then no more.
  void finish() {
    columns_.clear();
    inputs_.reset();
    others_.clear();
    contacts_.reset();
  }

 private:
  Result<void> begin(Files files) override {
    describe_run(file_, head());
    for (const char* name : {kSceneAttachment, kChangesAttachment})
      if (const auto found = files.find(name); found != files.end())
        file_.text(std::string("files/") + name, found->second);
    std::vector<std::string> order;
    columns_.reserve(head().columns.size());
    for (const TraceColumn& column : head().columns) {
      std::string name = column.name;
      std::replace(name.begin(), name.end(), '/', '_');  // a body's name may not open a group
      columns_.push_back(described<double>(file_, "frame/" + name, unit_of_column(column.name),
                                           frame_of_column(column.name), column.meaning));
      order.push_back(name);
    }
    file_.attribute("frame", "columns", order);
    inputs_.emplace(file_);
    for (std::size_t i = 0; i < head().other_devices.size(); ++i) {
      const std::string group = "hand_" + std::to_string(i + 2);
      file_.group(group);
      file_.attribute(group, "device", head().other_devices[i].name);
      others_.emplace_back(file_, group);
    }
    contacts_.emplace(file_);
    return {};
  }
  Result<void> input(const RecordedInput& input) override {
    inputs_->add(input);
    return {};
  }
  Result<void> hand(const RecordedHand& hand) override {
    others_[hand.hand - 1].add(hand.sample);
    return {};
  }
  Result<void> row(const std::vector<double>& row) override {
    for (std::size_t i = 0; i < row.size(); ++i)
      columns_[i].add(row[i] + 0.0);  // as the table: no negative zero
    ++rows;
    if (!file_.good()) return Error{"the file is not whole", "", "", ""};  // which its close() says in full
    return {};
  }
  Result<void> contacts(const RecordedContacts& recorded) override {
    if (rows == 0) return {};
    for (const ShownContact& contact : recorded.contacts) contacts_->add(rows - 1, contact);
    return {};
  }

  H5File& file_;
  std::vector<H5Column<double>> columns_;
  std::optional<InputColumns> inputs_;
  std::vector<SampleColumns> others_;  // of the second hand and all after it
  std::optional<ContactColumns> contacts_;
};

}  // namespace

std::string unit_of_column(const std::string& column) {
  const std::string name = without_hand(column);
  for (const ReportNumber& number : report_numbers())
    if (number.name == name && number.field->unit[0] != '\0' && number.field->unit[1] == '\0')
      return number.field->unit;
  static constexpr std::array<std::pair<const char*, const char*>, 8> kEnds = {{{"_rad_per_s", "rad/s"},
                                                                                {"_m_per_s", "m/s"},
                                                                                {"_Nm", "N m"},
                                                                                {"_Ns", "N s"},
                                                                                {"_N", "N"},
                                                                                {"_J", "J"},
                                                                                {"_m", "m"},
                                                                                {"_s", "s"}}};
  for (const auto& [end, unit] : kEnds)
    if (name.ends_with(end)) return unit;
  return "1";
}

std::string frame_of_column(const std::string& column) {
  const std::string name = without_hand(column);
  static constexpr std::array kParts = {
      "_px_m",       "_py_m",       "_pz_m",       "_qw",           "_qx",           "_qy",           "_qz",
      "_vx_m_per_s", "_vy_m_per_s", "_vz_m_per_s", "_wx_rad_per_s", "_wy_rad_per_s", "_wz_rad_per_s", "_fx_N",
      "_fy_N",       "_fz_N",       "_tx_Nm",      "_ty_Nm",        "_tz_Nm"};
  const bool directed =
      std::any_of(kParts.begin(), kParts.end(), [&](const char* part) { return name.ends_with(part); });
  if (!directed) return "none";
  return name.starts_with("device_p") || name.starts_with("device_q") ? "D" : "W";
}

Result<Hdf5Export> export_hdf5(const McapSource& source, const std::string& name, const std::string& out) {
  Result<H5File> file = H5File::create(out);
  if (!file) return file.error();
  Hdf5Writing writing(name, *file);
  McapEnd end = read_recording(source, writing);
  writing.finish();
  if (!writing.begun()) return *end.wrong;
  if (Result<void> closed = file->close(); !closed) return closed.error();
  return Hdf5Export{writing.rows, std::move(end)};
}

}  // namespace tactum
