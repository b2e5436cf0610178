#include "app/hdf5/h5_disk.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace tactum {
namespace {

constexpr std::size_t kPage = 4096;

/// Calls `visit(number, first, from, count)` for each page that a range of bytes touches: `count` bytes from
/// the page's byte `first` on are those of the range from `from` on.
template <class Visit>
void for_each_page(std::uint64_t at, std::size_t size, Visit visit) {
  for (std::size_t from = 0; from < size;) {
    const std::size_t first = (at + from) % kPage;
    const std::size_t count = std::min(size - from, kPage - first);
    visit((at + from) / kPage, first, from, count);
    from += count;
  }
}

/// What the library's driver knows of an open file: first what all drivers have, then where it is written.
struct DriverFile {
  H5FD_t common;
  H5Disk* disk;
  haddr_t end_of_addresses;
};

DriverFile& ours(H5FD_t* file) { return *reinterpret_cast<DriverFile*>(file); }
const DriverFile& ours(const H5FD_t* file) { return *reinterpret_cast<const DriverFile*>(file); }

/// The properties of the access hold the address of the disk. The library opens a file twice to create it.
H5FD_t* open_driver(const char*, unsigned, hid_t access, haddr_t) {
  const void* info = H5Pget_driver_info(access);
  if (info == nullptr) return nullptr;
  H5Disk* disk = nullptr;
  std::memcpy(&disk, info, sizeof disk);
  return &(new DriverFile{{}, disk, 0})->common;
}

/// As the library's own driver for files asks for, so that the bytes are those that it would write.
constexpr unsigned long kFeatures = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA |
                                    H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA |
                                    H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;

H5FD_class_t driver_class() {
  constexpr H5FD_mem_t kPools[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
  H5FD_class_t driver = {};
  driver.name = "tactum";
  driver.maxaddr = (haddr_t{1} << 62) - 1;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.fapl_size = sizeof(H5Disk*);
  driver.open = open_driver;
  driver.close = [](H5FD_t* file) -> herr_t {
    delete &ours(file);
    return 0;
  };
  driver.query = [](const H5FD_t*, unsigned long* flags) -> herr_t {
    *flags = kFeatures;
    return 0;
  };
  driver.get_eoa = [](const H5FD_t* file, H5FD_mem_t) { return ours(file).end_of_addresses; };
  driver.set_eoa = [](H5FD_t* file, H5FD_mem_t, haddr_t end) -> herr_t {
    ours(file).end_of_addresses = end;
    return 0;
  };
  driver.get_eof = [](const H5FD_t* file, H5FD_mem_t) -> haddr_t { return ours(file).disk->size(); };
  driver.read = [](H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, void* bytes) -> herr_t {
    ours(file).disk->read(at, static_cast<char*>(bytes), size);
    return 0;
  };
  driver.write = [](H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, const void* bytes) -> herr_t {
    ours(file).disk->write(at, static_cast<const char*>(bytes), size);
    return 0;
  };
  driver.truncate = [](H5FD_t* file, hid_t, hbool_t) -> herr_t {
    ours(file).disk->set_size(ours(file).end_of_addresses);
    return 0;
  };
  std::copy(std::begin(kPools), std::end(kPools), driver.fl_map);
  return driver;
}

}  // namespace

H5Disk::H5Disk(const std::string& path) : file_(::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0666)) {
  check(file_ >= 0);
}

H5Disk::~H5Disk() { close(); }

void H5Disk::check(bool good) {
  if (!good && wrong_.empty()) wrong_ = std::strerror(errno);
}

void H5Disk::write(std::uint64_t at, const char* bytes, std::size_t size) {
  size_ = std::max(size_, at + size);
  while (size > 0 && wrong_.empty()) {
    const ssize_t written = ::pwrite(file_, bytes, size, static_cast<off_t>(at));
    if (written < 0 && errno == EINTR) continue;
    check(written >= 0);
    const std::size_t done = written > 0 ? static_cast<std::size_t>(written) : 0;
    at += done;
    bytes += done;
    size -= done;
  }
  keep(at, bytes, size);
}

void H5Disk::keep(std::uint64_t at, const char* bytes, std::size_t size) {
  for_each_page(at, size, [&](std::uint64_t number, std::size_t first, std::size_t from, std::size_t count) {
    auto page = kept_.find(number);
    if (page == kept_.end()) {
      std::vector<char> whole(kPage);
      read(number * kPage, whole.data(), kPage);
      page = kept_.emplace(number, std::move(whole)).first;
    }
    std::copy_n(bytes + from, count, page->second.data() + first);
  });
}

void H5Disk::read(std::uint64_t at, char* bytes, std::size_t size) const {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::pread(file_, bytes + done, size - done, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  std::fill(bytes + done, bytes + size, '\0');  // as the library expects beyond the end
  for_each_page(at, size, [&](std::uint64_t number, std::size_t first, std::size_t from, std::size_t count) {
    if (const auto page = kept_.find(number); page != kept_.end())
      std::copy_n(page->second.data() + first, count, bytes + from);
  });
}

void H5Disk::set_size(std::uint64_t size) {
  size_ = size;
  if (wrong_.empty()) check(::ftruncate(file_, static_cast<off_t>(size)) == 0);
}

void H5Disk::close() {
  if (file_ >= 0) check(::close(file_) == 0);
  file_ = -1;
}

hid_t H5Disk::make_hdf5(const std::string& name, hid_t creation, hid_t access) {
  const H5FD_class_t driver = driver_class();
  const hid_t id = H5FDregister(&driver);
  if (id < 0) return id;
  const H5Disk* const disk = this;
  const hid_t made = H5Pset_driver(access, id, &disk) < 0
                         ? H5I_INVALID_HID
                         : H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation, access);
  H5FDunregister(id);  // the file keeps it as long as it is open
  return made;
}

}  // namespace tactum
