#include "app/hdf5/h5_file.h"

#include <cstdio>

namespace tactum {
namespace {

/// Texts of any length, which readers get as their own kind of text.
H5Handle text_type() {
  H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), H5T_VARIABLE);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

/// Of the format of HDF5 1.8, whose groups take as many attributes as there are.
hid_t made_file(H5Disk& disk, const std::string& name) {
  if (!disk.wrong().empty()) return H5I_INVALID_HID;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // what fails is told by us
  const H5Handle options(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  const H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_obj_track_times(options.id(), false);
  H5Pset_attr_phase_change(options.id(), 0, 0);
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18);
  return disk.make_hdf5(name, options.id(), access.id());
}

}  // namespace

H5File::H5File(std::string path, std::string unfinished)
    : path_(std::move(path)),
      unfinished_(std::move(unfinished)),
      disk_(std::make_unique<H5Disk>(unfinished_)),
      file_(made_file(*disk_, unfinished_), H5Fclose),
      good_(std::make_unique<bool>(true)) {}

Result<H5File> H5File::create(const std::string& path) {
  H5File file(path, path + ".unfinished");
  if (file.file_.good()) return file;
  if (file.disk_->wrong().empty()) std::remove(file.unfinished_.c_str());
  return Error{"cannot write the file", file.disk_->wrong(), "a place that can be written", path};
}

H5File::~H5File() {
  if (file_.reset()) std::remove(unfinished_.c_str());
}

void H5File::group(const std::string& name) {
  const H5Handle options(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  // So that an attribute may have more than 64 KB, such as a long list of names.
  check(H5Pset_obj_track_times(options.id(), false) >= 0 &&
        H5Pset_attr_phase_change(options.id(), 0, 0) >= 0);
  const H5Handle made(H5Gcreate2(id(), name.c_str(), H5P_DEFAULT, options.id(), H5P_DEFAULT), H5Gclose);
  check(made.good());
}

void H5File::attribute(const std::string& object, const std::string& name, const std::string& text) {
  const char* characters = text.c_str();
  const H5Handle type = text_type();
  const H5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const H5Handle made(H5Acreate_by_name(id(), object.c_str(), name.c_str(), type.id(), space.id(),
                                        H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
  check(made.good() && H5Awrite(made.id(), type.id(), &characters) >= 0);
}

void H5File::attribute(const std::string& object, const std::string& name, double number) {
  const H5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const H5Handle made(H5Acreate_by_name(id(), object.c_str(), name.c_str(), H5T_NATIVE_DOUBLE, space.id(),
                                        H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
  check(made.good() && H5Awrite(made.id(), H5T_NATIVE_DOUBLE, &number) >= 0);
}

void H5File::attribute(const std::string& object, const std::string& name,
                       const std::vector<std::string>& texts) {
  std::vector<const char*> all;
  for (const std::string& text : texts) all.push_back(text.c_str());
  const H5Handle type = text_type();
  const hsize_t count = texts.size();
  const H5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const H5Handle made(H5Acreate_by_name(id(), object.c_str(), name.c_str(), type.id(), space.id(),
                                        H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
  check(made.good() && (texts.empty() || H5Awrite(made.id(), type.id(), all.data()) >= 0));
}

void H5File::text(const std::string& name, const std::string& text) {
  const char* characters = text.c_str();
  const H5Handle type = text_type();
  const H5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const H5Handle options(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  check(H5Pset_obj_track_times(options.id(), false) >= 0);
  const H5Handle data(
      H5Dcreate2(id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, options.id(), H5P_DEFAULT),
      H5Dclose);
  check(data.good() && H5Dwrite(data.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &characters) >= 0);
}

Result<void> H5File::close() {
  check(file_.reset());
  disk_->close();
  if (good() && std::rename(unfinished_.c_str(), path_.c_str()) == 0) return {};
  std::remove(unfinished_.c_str());
  return Error{"cannot write the whole file", disk_->wrong(), "room on the disk, and names that HDF5 takes",
               path_};
}

}  // namespace tactum
