// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/file_bytes.hpp"

#include <zlib.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>

namespace modslam {
namespace {

constexpr std::size_t kPiece = 1 << 20;
constexpr std::size_t kMaxBytes = std::size_t{2} << 30;  // what unpacks to more is no robot log

void append(FileBytes& file, const char* piece, std::size_t size, const std::string& path) {
  if (file.bytes.size() + size > kMaxBytes)
    throw std::runtime_error(path + ": unpacks to more than 2 GiB");
  file.bytes.append(piece, size);
}

/// zlib reads plain files as they are and gzip files unpacked.
FileBytes read_plain_or_gzip(const std::string& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzopen(path.c_str(), "rb"), gzclose);
  if (!in) throw std::runtime_error(path + ": cannot be opened");
  FileBytes file;
  std::string piece(kPiece, '\0');
  for (;;) {
    const int got = gzread(in.get(), piece.data(), static_cast<unsigned>(piece.size()));
    if (got > 0) append(file, piece.data(), static_cast<std::size_t>(got), path);
    if (got > 0 && static_cast<std::size_t>(got) == piece.size()) continue;
    int status = Z_OK;
    const char* words = gzerror(in.get(), &status);
    if (status != Z_OK && status != Z_STREAM_END)
      file.damage = status == Z_BUF_ERROR ? "the compressed file ends early" : words;
    if (got <= 0 || !file.damage.empty()) return file;
  }
}

FileBytes read_xz(const std::string& path) {
  std::string quoted = "'";
  for (const char c : path) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  std::FILE* in = popen(("xz -dc -- " + quoted + "' 2>/dev/null").c_str(), "r");
  if (!in) throw std::runtime_error(path + ": cannot start xz");
  FileBytes file;
  std::string piece(kPiece, '\0');
  try {
    while (const std::size_t got = std::fread(piece.data(), 1, piece.size(), in))
      append(file, piece.data(), got, path);
  } catch (...) {
    pclose(in);
    throw;
  }
  if (pclose(in) != 0) file.damage = "xz could not unpack all of it";
  return file;
}

bool starts_with_xz_magic(const std::string& path) {
  char head[6] = {};
  std::FILE* in = std::fopen(path.c_str(), "rb");
  if (!in) return false;
  const std::size_t got = std::fread(head, 1, sizeof head, in);
  std::fclose(in);
  return got == sizeof head && std::memcmp(head,
                                           "\xFD"
                                           "7zXZ\0",
                                           6) == 0;
}

}  // namespace

FileBytes read_file_bytes(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw std::runtime_error(path + ": there is no such file");
  FileBytes file = starts_with_xz_magic(path) ? read_xz(path) : read_plain_or_gzip(path);
  if (file.bytes.empty())
    throw std::runtime_error(path + ": " + (file.damage.empty() ? "is empty" : file.damage));
  return file;
}

}  // namespace modslam
