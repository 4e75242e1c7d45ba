// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace modslam {
namespace {

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// The new name survives a power cut only when the folder is synced too; not every file system can.
void sync_folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace

void write_atomically(const std::string& path, std::string_view bytes) {
  const std::string temporary = path + "." + std::to_string(::getpid()) + ".part";
  const auto fail = [&](int reason) {
    ::unlink(temporary.c_str());
    throw std::runtime_error(path + ": cannot be written: " + std::strerror(reason));
  };
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail(errno);
  const bool written = write_all(file, bytes) && ::fsync(file) == 0;
  const int reason = errno;
  if (::close(file) != 0 && written) fail(errno);
  if (!written) fail(reason);
  if (std::rename(temporary.c_str(), path.c_str()) != 0) fail(errno);
  sync_folder_of(path);
}

}  // namespace modslam
