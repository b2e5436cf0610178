#include "tactum/drivers/vendor_library.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace tactum::inline v0_1 {
namespace {

namespace fs = std::filesystem;

/// NAME and NAME.* in a folder, the newest version first.
std::vector<std::string> versions_of(const std::string& folder, const std::string& name) {
  std::vector<std::string> versions;
  std::error_code unreadable;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, unreadable)) {
    const std::string file = entry.path().filename().string();
    if (file == name || file.starts_with(name + ".")) versions.push_back(entry.path().string());
  }
  std::sort(versions.rbegin(), versions.rend());
  return versions;
}

/// The files that a folder offers, the best first.
void add_offers(const std::string& folder, const LibrarySearch& search, std::vector<std::string>& offers) {
  for (const std::string& name : search.names)
    for (const std::string& file : versions_of(folder, name)) offers.push_back(file);
}

std::string joined_names(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

/// What is tried, in this order, and the places in words.
struct Offers {
  std::vector<std::string> files;
  std::string places;
};

Offers offers_of(const LibrarySearch& search) {
  Offers offers;
  if (const std::string named = environment(search.variable.c_str()); !named.empty()) {
    offers.places = named + " (" + search.variable + ")";
    std::error_code absent;
    if (fs::is_directory(named, absent))
      add_offers(named, search, offers.files);
    else
      offers.files.push_back(named);
    return offers;
  }
  std::vector<std::string> folders;
  for (const std::string& folder : search.folders)
    if (!folder.empty()) folders.push_back(folder);
  for (const std::string& folder : folders) add_offers(folder, search, offers.files);
  offers.files.insert(offers.files.end(), search.names.begin(), search.names.end());
  folders.emplace_back("the loader's path");
  offers.places = joined_names(folders, ", ");
  return offers;
}

/// Whether the loader says no more than that there is no such file; a library that misses another one, or is
/// for another processor, is told otherwise.
bool merely_absent(const std::string& file, const std::string& complaint) {
  return complaint.starts_with(file + ": cannot open shared object file: No such file");
}

}  // namespace

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

VendorLibrary& VendorLibrary::operator=(VendorLibrary&& other) noexcept {
  unload();
  std::swap(handle_, other.handle_);
  std::swap(companions_, other.companions_);
  path_ = std::move(other.path_);
  cure_ = std::move(other.cure_);
  missing_ = std::move(other.missing_);
  return *this;
}

Result<VendorLibrary> VendorLibrary::load(const LibrarySearch& search) {
  const Offers offers = offers_of(search);
  std::string complaints;
  VendorLibrary library;
  for (const std::string& companion : search.companions)
    if (void* handle = dlopen(companion.c_str(), RTLD_NOW | RTLD_GLOBAL); handle != nullptr)
      library.companions_.push_back(handle);
  for (const std::string& file : offers.files) {
    if (void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL); handle != nullptr) {
      library.handle_ = handle;
      library.path_ = file;
      library.cure_ = search.cure;
      return library;
    }
    const char* said = dlerror();
    const std::string complaint = said == nullptr ? file : said;
    if (!merely_absent(file, complaint)) complaints += (complaints.empty() ? "" : "; ") + complaint;
  }
  const std::string cure = search.cure + ", or name the library in " + search.variable;
  if (!complaints.empty())
    return Error{"the library of " + search.maker + " does not load", complaints, "one that does: " + cure,
                 ""};
  return Error{"the library of " + search.maker + " is not there",
               "no " + joined_names(search.names, " or ") + " in " + offers.places, "one: " + cure, ""};
}

void VendorLibrary::unload() noexcept {
  if (handle_ != nullptr) dlclose(handle_);
  handle_ = nullptr;
  for (void* companion : companions_) dlclose(companion);
  companions_.clear();
}

void* VendorLibrary::address(const char* name) const noexcept {
  return handle_ == nullptr ? nullptr : dlsym(handle_, name);
}

Result<void> VendorLibrary::check() const {
  if (missing_.empty()) return {};
  return Error{"the library lacks functions", "no " + joined_names(missing_, ", "),
               "a newer version: " + cure_, path_};
}

}  // namespace tactum::inline v0_1
