#include "flirt/io/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace flirt {
namespace {

tl::unexpected<Error> system_failure(const std::filesystem::path& path, const char* expected) {
  return fail(path.string() + ": expected " + expected + ", found: " + std::generic_category().message(errno));
}

}  // namespace

Result<std::shared_ptr<const MappedFile>> MappedFile::open(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) { return system_failure(path, "a readable file"); }
  struct stat status{};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    return fail(path.string() + ": expected a regular file, found something else");
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  void* const memory = size == 0 ? nullptr : mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  const tl::unexpected<Error> failure = system_failure(path, "a file that can be mapped into memory");
  ::close(descriptor);
  if (memory == MAP_FAILED) { return failure; }
  return std::shared_ptr<const MappedFile>(new MappedFile({static_cast<const std::byte*>(memory), size}));
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) { munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size()); }
}

}  // namespace flirt
